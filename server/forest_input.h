/* forest_input.h: one message about a forest, waiting for its turn. */
#ifndef FOREST_INPUT_H
#define FOREST_INPUT_H

#include "awt.h"

/* Whom to answer: the session may be gone by then. */
typedef struct origin {
    uint64_t session; /* its handle */
    uint64_t request; /* the message's id */
} origin;

/* The first three act on the forest, in their order. The others look at it as it stands, whenever that is. */
typedef enum forest_input_kind {
    FOREST_MOTION,
    FOREST_PARAMS,
    FOREST_QUERY,
    FOREST_LATEST, /* QUERY of the latest frame */
    FOREST_BINDING,
    FOREST_STATE
} forest_input_kind;

typedef struct forest_input {
    struct forest_input *next;
    forest_input_kind kind;
    origin from;
    int64_t arrived_us; /* monotonic clock */
    awt_error error;    /* written by the worker; status AWT_OK: it was taken */
    union {
        awt_motion motion;
        awt_params params;
        struct {
            int64_t time_us; /* simulated; of FOREST_QUERY */
            int form;
            int64_t deadline_us; /* monotonic; of FOREST_QUERY, 0: as usual */
            uint64_t promised;   /* the forest, where the asker was promised an answer (promises.h) */
        } query;                 /* of FOREST_LATEST too */
    } as;
} forest_input;

/* The type of the message that such an input came in. */
uint16_t forest_input_message(forest_input_kind kind);

/* Frees a whole list. */
void forest_inputs_free(forest_input *first);

/* A motion takes over what must not be lost of the one before it, which is left out: its jump, and the poses of
 * obstacles that it does not name itself. */
void forest_motion_absorb(awt_motion *motion, const awt_motion *before);

#endif
