/* strandcheck.h: measures frames as a client sees them: decoded, against the first one decoded. Everything is in the
 * head frame, so what rides the head does not move at all. */
#ifndef CLIENTS_STRANDCHECK_H
#define CLIENTS_STRANDCHECK_H

#include "geom/read.h"

enum { STRANDCHECK_BINS = 10001 }; /* 0 to 100 %, 0.01 % each; the last holds what is beyond */

typedef struct strandcheck {
    size_t frames; /* compared with the first */
    uint32_t strand_count, points_per_strand;
    float *first_roots;   /* [strand_count][3], heap */
    float *first_lengths; /* [strand_count], heap */
    uint64_t *bins;       /* [STRANDCHECK_BINS] of strands by change of arc length, heap */
    uint64_t measured;    /* strands in all bins */
    double greatest_percent;
    double greatest_root_m; /* distance of a strand's root from where the first frame has it */
} strandcheck;

/* Adds a decoded frame to the figures. Zeroed is how a strandcheck begins; strandcheck_fini is how it ends.
 * AWT_BAD_VALUE where a point is not finite or the strands are not the first frame's, AWT_NO_MEMORY. */
awt_status strandcheck_add(strandcheck *check, const geom_strands *strands, awt_error *error);

/* Change of arc length in percent that `share` of the strands (0 to 1) do not exceed; beyond
 * 100 it only says 100.01. */
double strandcheck_percent(const strandcheck *check, double share);

void strandcheck_fini(strandcheck *check);

#endif
