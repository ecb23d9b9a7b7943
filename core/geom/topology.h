/* topology.h: the triangles of each kind of frame, which follow from the counts alone.
 *
 * `ribbon`: see ribbon.h. `strands`: the vertices are the strands' points (`guides`: the sections of wisps), and a mesh
 * has to have triangles: the fewest that touch every point, three points in a row each, none across two strands; what
 * is left over of a strand makes one triangle more that repeats its last point. Each index is the one before it, or one
 * more: connectivity costs nothing.
 */
#ifndef GEOM_TOPOLOGY_H
#define GEOM_TOPOLOGY_H

#include "geom/read.h"

/* Vertices that stand for one strand point. */
static inline uint32_t topology_vertices_a_point(geom_kind kind)
{
    return kind == GEOM_RIBBON ? 2 : 1;
}

static inline uint32_t topology_triangles(geom_kind kind, uint32_t strands, uint32_t points_per_strand)
{
    return kind == GEOM_RIBBON ? strands * (points_per_strand - 1) * 2 : strands * ((points_per_strand + 2) / 3);
}

/* Fills `out` [topology_triangles][3]; the vertices number at most 65535. Fewer strands have the front of it. */
void topology_indices(geom_kind kind, uint32_t strands, uint32_t points_per_strand, uint16_t *out);

#endif
