/* forest_work.h: what a worker does with a forest: make it (CREATE) or bring it to a time (QUERY), and publish the
 * frame.
 *
 * A forest_work is wholly the worker's from worker_pool_submit until the I/O thread takes the job back, and wholly the
 * I/O thread's otherwise; `note` alone is both's. What comes out depends only on the recipe and on the inputs in their
 * order, never on which worker runs it or when. */
#ifndef FOREST_WORK_H
#define FOREST_WORK_H

#include "geom/encode.h"
#include "published.h"
#include "recipe.h"
#include "worker.h"

#include <stdatomic.h>

/* Whom to answer: the session may be gone by then. */
typedef struct origin {
    uint64_t session; /* its handle */
    uint64_t request; /* the message's id */
} origin;

typedef enum forest_input_kind { FOREST_MOTION, FOREST_PARAMS, FOREST_QUERY } forest_input_kind;

/* One message that acts on a forest, waiting for its turn. */
typedef struct forest_input {
    struct forest_input *next;
    forest_input_kind kind;
    origin from;
    int64_t arrived_us; /* monotonic clock */
    awt_error error;    /* written by the worker; status AWT_OK: it was taken */
    union {
        awt_motion motion;
        awt_params params;
        int64_t query_us; /* simulated time */
    } as;
} forest_input;

/* Frees a whole list. */
void forest_inputs_free(forest_input *first);

/* What a worker that makes a forest is at: PROGRESS's `stage`. */
typedef enum forest_stage { FOREST_WAITS, FOREST_STRANDS, FOREST_WISPS, FOREST_DRAWS } forest_stage;

typedef struct forest_work {
    job job;
    atomic_uint note; /* while it is made: how far it has come, see forest_work_stage; written by the worker */

    /* the task; the I/O thread fills it in before submitting */
    recipe *making;       /* CREATE; NULL: QUERY */
    forest_input *inputs; /* motions and parameters, and at the end the query that wants them; owned */
    uint64_t handle;      /* for FRAME */
    uint64_t sequence;    /* for FRAME */
    int64_t submitted_us; /* monotonic clock: when the request came */

    /* the result; the I/O thread takes it */
    published *frame; /* a reference; NULL: failed */
    awt_error error;  /* why, where `frame` is NULL */
    uint32_t build_us, skipped_strands;
    awt_rebuilt rebuilt;
    uint64_t steps, step_us, encode_us;

    /* the hair, NULL until made */
    awt_groom *groom;
    geom_layout *layout;
    geom_scratch *scratch;
    awt_forest *forest;
    awt_groom_info info;
    float *centres, *frames; /* [finest_nodes][3], [finest_nodes][4] */
    float *strand_scratch;
    float *points; /* [strand_count][points_per_strand][3] */
} forest_work;

/* The job's function: what `making` or `inputs` say. */
void forest_work_run(job *work);

/* What the worker is at, and the share of that which is done. Any thread. */
forest_stage forest_work_stage(forest_work *work, float *share);

/* Frees task, result and hair; accepts a zeroed one. Not while a worker has it. */
void forest_work_fini(forest_work *work);

/* Bytes that the hair holds. */
uint64_t forest_work_bytes(const forest_work *work);

#endif
