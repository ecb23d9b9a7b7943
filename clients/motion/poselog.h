/* poselog.h: the rows of a head-pose CSV (DATA.md), before anything is made of them. Private to motion. */
#ifndef MOTION_POSELOG_H
#define MOTION_POSELOG_H

#include "base/vec.h"
#include "motion/motion.h"
#include "motion/text.h"

enum {
    POSELOG_MAX_COLUMNS = 64,
    POSELOG_FRACTION = 1000000 /* timestamps with a decimal point are counted in millionths of their unit */
};

enum { COLUMN_TIME, COLUMN_X, COLUMN_QX = 4, COLUMN_VIEW = 8, COLUMN_KINDS };

typedef struct poselog_reading {
    int64_t ticks;
    int64_t view; /* 0 left eye, 1 right eye; of a plain log 0 */
    dvec3 position;
    dquat orientation; /* of unit length */
} poselog_reading;

typedef struct poselog {
    int columns[COLUMN_KINDS]; /* where each stands in a row; -1: nowhere */
    int column_count;
    bool has_views;            /* a row for each eye */
    bool has_fractions;        /* ticks are millionths */
    poselog_reading *readings; /* [count], heap, in the file's order */
    size_t count, capacity;
} poselog;

/* `out` is zeroed on entry and may be half filled on failure: poselog_fini. */
awt_status poselog_read(text_cursor text, poselog *out, awt_error *error);
void poselog_fini(poselog *log);

#endif
