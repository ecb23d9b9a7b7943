/* evaluate.h: strands from the finest nodes (AWT §2.2: each strand is attached to one of the finest GCs).
 *
 * Along each finest GC stand as many stations as a strand has points, evenly from root to tip: a point of the smooth
 * curve through the section centres and a frame blended between the sections' frames. Point i of a strand is station
 * i's point plus a constant offset in its frame, so at rest the strands are the groom's own, exactly, and they move
 * rigidly with the wisp around them (§3.3). Whoever receives sections alone (geom/receive.h) evaluates with this same
 * code, which therefore knows no groom. */
#ifndef SIM_EVALUATE_H
#define SIM_EVALUATE_H

#include "base/arena.h"
#include "base/lanes.h"

#include <stdint.h>

/* What a station is made of: the same for all GCs of a groom. */
typedef struct evaluate_tap {
    float weight[32]; /* [4][8]: of four sections from `first` on, four times for the curve and four for the frame */
    uint32_t first;   /* 0 .. sections - 4, or 0 */
} evaluate_tap;

enum { EVALUATE_COLUMNS = 12 }; /* of a station: the frame's x, y and z axis in the head frame, y along; the point */

/* Working memory of one evaluation, and in it the stations of one GC, side by side: column c of station i is
 * column[c * stride + i]. */
typedef struct evaluate_table {
    uint32_t points, sections, stride;
    evaluate_tap *taps; /* [points] */
    float *records;     /* [sections, at least 4][8]: centre, 0, frame */
    float *mixed;       /* [points][8]: the curve's point and the blended quaternion */
    float *column;      /* [EVALUATE_COLUMNS * stride] */
} evaluate_table;

/* Arrays for strands of `points` points (2 .. AWT_MAX_POINTS_PER_STRAND) on GCs of `sections` sections, from a real
 * arena or a counting one; a real one's taps are set. */
void evaluate_lay_out(evaluate_table *table, arena *memory, uint32_t sections, uint32_t points);

/* Fills the stations of one GC from its section centres and frames, [sections] each. */
void evaluate_stations(evaluate_table *table, const vec3 *centres, const quat *frames);

/* out [strands][points][3] from offsets [strands][3][points] in the frames of the table's stations. */
void evaluate_strands(const evaluate_table *table, const float *restrict offsets, uint32_t strands,
                      float *restrict out);

/* How the strands of a groom hang on its finest GCs. */
typedef struct evaluate_binding {
    uint32_t wisps, sections;     /* finest GCs, and cross-sections of each */
    uint32_t points;              /* of a strand */
    const uint32_t *strand_first; /* [wisps + 1]; the last is how many strands there are */
    const float *offsets;         /* [strands][3][points] */
    const uint32_t *tree;         /* [wisps]; with `trees` only */
    const bool *trees;            /* wisps of these trees are evaluated, the others' points stay; NULL: all */
} evaluate_binding;

/* All strands, points [strands][points][3], from section centres [wisps * sections][3] and frames [..][4]. `scratch`
 * holds evaluate_scratch floats. */
void evaluate_hair(const evaluate_binding *binding, const float *centres, const float *frames, float *scratch,
                   float *points);
size_t evaluate_scratch(uint32_t sections, uint32_t points);

static inline vec3 evaluate_centre(const evaluate_table *table, uint32_t station)
{
    const float *c = table->column + station;
    return vec3_make(c[9 * table->stride], c[10 * table->stride], c[11 * table->stride]);
}

static inline mat3 evaluate_frame(const evaluate_table *table, uint32_t station)
{
    const float *c = table->column + station;
    const uint32_t s = table->stride;
    return (mat3){{c[0], c[s], c[2 * s]}, {c[3 * s], c[4 * s], c[5 * s]}, {c[6 * s], c[7 * s], c[8 * s]}};
}

#endif
