/* ribbon.h: one strand of points becomes a ribbon of triangles.
 *
 * Point i of a strand gives vertices 2i (left edge) and 2i + 1 (right edge), half a width to either side of it along
 * the ribbon's width direction. That direction lies along the scalp at the root and is carried along the strand
 * without twist (rotation-minimising), so ribbons lie flat on the head and curls do not spin them. */
#ifndef GEOM_RIBBON_H
#define GEOM_RIBBON_H

#include <stdbool.h>
#include <stdint.h>

typedef struct ribbon_shape {
    uint32_t points_per_strand;
    float point_min[3], point_max[3]; /* strand points outside are set onto it */
    const float *half_width;          /* [points_per_strand], metres */
} ribbon_shape;

/* Fills `vertices` [strands][points][2][3] from `points` [strands][points][3] (head frame) and adds to `clamped` how
 * many points lay outside the shape's box. False: a point is not finite; `vertices` is half written then. */
bool ribbon_vertices(const ribbon_shape *shape, const float *points, uint32_t strands, float *vertices,
                     uint32_t *clamped);

#endif
