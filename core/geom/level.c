/* level.c: see level.h. */
#include "geom/level.h"

#include "base/error.h"
#include "groom/groom.h"
#include "sim/evaluate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FIFTH = 5 };

static uint32_t finest_wisps(const awt_groom *groom)
{
    return groom->info.wisp_count[groom->info.levels - 1];
}

/* How far a strand lies from the centre line of its wisp: the sum of its offsets' squares. */
static float distance_from_centre(const awt_groom *groom, uint32_t strand)
{
    const size_t floats = 3 * (size_t)groom->info.points_per_strand;
    const float *offset = groom->strand_offset + strand * floats;
    float sum = 0;
    for (size_t i = 0; i < floats; i++) {
        sum += offset[i] * offset[i];
    }
    return sum;
}

/* Of strands first .. after-1, which are one at least, the one nearest to the centre line; of equals the first. */
static uint32_t guide_of(const awt_groom *groom, uint32_t first, uint32_t after)
{
    uint32_t nearest = first;
    float least = distance_from_centre(groom, first);
    for (uint32_t s = first + 1; s < after; s++) {
        const float distance = distance_from_centre(groom, s);
        if (distance < least) {
            least = distance;
            nearest = s;
        }
    }
    return nearest;
}

/* Every fifth of first .. after-1, but `guide` for the one just before it, or else for the one just after it. */
static uint32_t put_fifth(uint32_t first, uint32_t after, uint32_t guide, uint32_t *out)
{
    const uint32_t begin = (first + FIFTH - 1) / FIFTH * FIFTH, under = guide / FIFTH * FIFTH;
    const uint32_t gives_way = under >= first ? under : begin;
    uint32_t count = 0;
    for (uint32_t s = begin; s < after; s += FIFTH) {
        out[count++] = s == gives_way ? guide : s;
    }
    return count;
}

static void choose(const awt_groom *groom, level_strands *level)
{
    for (uint32_t g = 0; g < finest_wisps(groom); g++) {
        const uint32_t first = groom->gc_strand_first[g], after = groom->gc_strand_first[g + 1];
        level->strand_first[g] = level->strands;
        if (first == after) {
            continue;
        }
        const uint32_t guide = guide_of(groom, first, after);
        if (level->level == GEOM_LEVEL_GUIDES) {
            level->number[level->strands++] = guide;
        } else {
            level->strands += put_fifth(first, after, guide, level->number + level->strands);
        }
    }
    level->strand_first[finest_wisps(groom)] = level->strands;
}

awt_status level_strands_make(const awt_groom *groom, geom_level level, level_strands *out, awt_error *error)
{
    const uint32_t full = groom->info.strand_count, wisps = finest_wisps(groom);
    const size_t a_strand = 3 * (size_t)groom->info.points_per_strand;
    *out = (level_strands){.level = level, .full_strands = full};
    if (level == GEOM_LEVEL_FULL) {
        out->strands = full;
        return AWT_OK;
    }
    const size_t most = level == GEOM_LEVEL_GUIDES ? wisps : (full + FIFTH - 1) / FIFTH;
    out->number = malloc(most * sizeof *out->number);
    out->strand_first = malloc(((size_t)wisps + 1) * sizeof *out->strand_first);
    out->offsets = malloc(most * a_strand * sizeof *out->offsets);
    if (!out->number || !out->strand_first || !out->offsets) {
        level_strands_fini(out);
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    choose(groom, out);
    for (uint32_t s = 0; s < out->strands; s++) {
        memcpy(out->offsets + s * a_strand, groom->strand_offset + out->number[s] * a_strand,
               a_strand * sizeof *out->offsets);
    }
    return AWT_OK;
}

void level_strands_fini(level_strands *level)
{
    free(level->number);
    free(level->strand_first);
    free(level->offsets);
    *level = (level_strands){0};
}

uint32_t level_first_strand(const level_strands *level, const awt_groom *groom, uint32_t wisp)
{
    return (level->strand_first ? level->strand_first : groom->gc_strand_first)[wisp];
}

void level_evaluate(const level_strands *level, const awt_groom *groom, const bool *wisps, const float *centres,
                    const float *frames, float *scratch, float *points)
{
    if (level->level == GEOM_LEVEL_FULL) {
        awt_groom_strands_of(groom, wisps, centres, frames, scratch, points);
        return;
    }
    const evaluate_binding binding = {.wisps = finest_wisps(groom),
                                      .sections = groom->info.sections,
                                      .points = groom->info.points_per_strand,
                                      .strand_first = level->strand_first,
                                      .offsets = level->offsets,
                                      .tree = groom->gc_tree + groom_finest_first(groom),
                                      .trees = wisps};
    evaluate_hair(&binding, centres, frames, scratch, points);
}

float level_growth(const level_strands *level)
{
    return sqrtf((float)level->full_strands / (float)level->strands);
}
