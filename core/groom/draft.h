/* draft.h: what the stages of awt_groom_build share. Each stage fills its part of the groom, in this order:
 * hierarchy (which strands make which wisp), fit (curves, radii and frames of the wisps), bind (strands to wisps), and
 * rebuilt (what comes out compared with what went in). */
#ifndef GROOM_DRAFT_H
#define GROOM_DRAFT_H

#include "groom/cluster.h"
#include "groom/groom.h"
#include "groom/modelled.h"
#include "groom/polyline.h"

typedef struct groom_draft {
    awt_groom *groom; /* sizes stand in its info */
    const awt_strands *strands;
    modelled_strand *modelled; /* [strands], from the heap; NULL: the hierarchy is built from the strands */

    /* scratch of the build */
    arena memory;
    cluster_set clusters;  /* clusters.order[k]: the input's number of the groom's strand k */
    float *features;       /* [strands][CLUSTER_FEATURES] */
    uint32_t *gc_first;    /* [gc_count]; first strand, in the groom's order */
    double *length_m;      /* [strands], in the groom's order */
    double reach_m;        /* farthest that a stretched wisp takes a strand point from the wisp's root */
    float *strand_scratch; /* [awt_groom_strand_scratch] */
    float *rebuilt;        /* [strands][points][3], in the groom's order */

    void (*progress)(void *context, double share);
    void *context;
} groom_draft;

/* How far the stages have come, in their own numbers: below. Whoever listens hears the share of the time. */
void draft_report(const groom_draft *build, double stage);

/* Measures strand k of the groom's order. */
static inline void draft_measure(const groom_draft *build, uint32_t k, polyline *line)
{
    const awt_strands *strands = build->strands;
    uint32_t s = build->clusters.order[k], first = strands->first_point[s];
    polyline_measure(line, strands->positions + 3 * (size_t)first, strands->first_point[s + 1] - first);
}

#define DRAFT_STRAIN 1.25 /* what a moving strand may be longer than at rest (CONTRACT.md, Geometry) */

/* Fills gc_super .. gc_strand_count, gc_strand_first and the order of the strands. Reports 0 .. 0.4. */
void hierarchy_build(groom_draft *build);
/* Fills rest_position, rest_radius and rest_frame. Reports 0.4 .. 0.7. */
void fit_wisps(groom_draft *build);
/* Fills strand_offset, length_m and reach_m. Reports 0.7 .. 1. */
void bind_strands(groom_draft *build);
/* Fills rebuilt. Reports 1. */
void measure_rebuilt(groom_draft *build);

#endif
