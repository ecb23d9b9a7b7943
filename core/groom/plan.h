/* plan.h: the sizes of a groom, decided before anything is built: strands and definition checked, what the definition
 * leaves open chosen from the strands. */
#ifndef GROOM_PLAN_H
#define GROOM_PLAN_H

#include "awt.h"

typedef struct groom_plan {
    uint32_t strand_count, points_per_strand;
    uint32_t levels, sections;
    uint32_t wisp_count[AWT_MAX_LEVELS]; /* coarsest first, never falling, the last at most strand_count */
    double head_radius_m;
} groom_plan;

/* Everything but levels and wisp_count, which stay 0. AWT_NO_STRANDS, AWT_BAD_VALUE, AWT_LIMIT; `out` is written on
 * success only. */
awt_status plan_make(const awt_strands *strands, const awt_groom_def *def, groom_plan *out, awt_error *error);

/* Levels and wisp_count for a hierarchy that is built from the strands. */
void plan_choose_wisps(const awt_groom_def *def, groom_plan *plan);

/* Points and nodes within the limits of awt.h? AWT_LIMIT. */
awt_status plan_check_sizes(const groom_plan *plan, awt_error *error);

#endif
