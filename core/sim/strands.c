/* strands.c: the strands of a groom, evaluated (awt.h). */
#include "sim/evaluate.h"

#include "groom/groom.h"

size_t awt_groom_strand_scratch(const awt_groom *groom)
{
    return evaluate_scratch(groom->info.sections, groom->info.points_per_strand);
}

void awt_groom_strands(const awt_groom *groom, const float *centres, const float *frames, float *scratch, float *points)
{
    awt_groom_strands_of(groom, NULL, centres, frames, scratch, points);
}

void awt_groom_strands_of(const awt_groom *groom, const bool *wisps, const float *centres, const float *frames,
                          float *scratch, float *points)
{
    const evaluate_binding binding = {.wisps = groom->info.wisp_count[groom->info.levels - 1],
                                      .sections = groom->info.sections,
                                      .points = groom->info.points_per_strand,
                                      .strand_first = groom->gc_strand_first,
                                      .offsets = groom->strand_offset,
                                      .tree = groom->gc_tree + groom_finest_first(groom),
                                      .trees = wisps};
    evaluate_hair(&binding, centres, frames, scratch, points);
}
