/* strandcheck.h: measures frames as a client sees them: decoded, against the first one decoded of
 * its level. Everything is in the
 * head frame, so what rides the head does not move at all. */
#ifndef CLIENTS_STRANDCHECK_H
#define CLIENTS_STRANDCHECK_H

#include "geom/read.h"

enum { STRANDCHECK_BINS = 10001 }; /* 0 to 100 %, 0.01 % each; the last holds what is beyond */

enum { STRANDCHECK_LEVELS = GEOM_LEVEL_GUIDES + 1 };

/* The first frame of a level. Zeroed: none has come. */
typedef struct strandcheck_first {
    uint32_t strand_count, points_per_strand;
    float *roots;   /* [strand_count][3], heap */
    float *lengths; /* [strand_count], heap */
} strandcheck_first;

typedef struct strandcheck {
    size_t frames; /* compared with the first of their level */
    strandcheck_first first[STRANDCHECK_LEVELS];
    uint64_t *bins;    /* [STRANDCHECK_BINS] of strands by change of arc length, heap */
    uint64_t measured; /* strands in all bins */
    double greatest_percent;
    double greatest_root_m; /* distance of a strand's root from where that frame has it */
} strandcheck;

/* Adds a decoded frame to the figures. Zeroed is how a strandcheck begins; strandcheck_fini is how it ends.
 * AWT_BAD_VALUE where a point is not finite or the strands are not those of the first frame of the level,
 * AWT_NO_MEMORY. */
awt_status strandcheck_add(strandcheck *check, const geom_strands *strands, awt_error *error);

/* Change of arc length in percent that `share` of the strands (0 to 1) do not exceed; beyond
 * 100 it only says 100.01. */
double strandcheck_percent(const strandcheck *check, double share);

void strandcheck_fini(strandcheck *check);

#endif
