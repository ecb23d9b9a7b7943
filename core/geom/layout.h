/* layout.h: what of a groom decides the shape of its frames (geom_layout's insides, for core/geom alone). */
#ifndef GEOM_LAYOUT_H
#define GEOM_LAYOUT_H

#include "geom/draco_shim.h"
#include "geom/encode.h"
#include "geom/ribbon.h"

typedef struct geom_patch {
    uint32_t first_strand, strands;
} geom_patch;

struct geom_layout {
    uint32_t strands, points_per_strand;
    ribbon_shape shape;
    float *half_width; /* [points_per_strand]; the shape's */
    draco_box box;     /* one for all patches and all frames */
    geom_patch *patches;
    uint32_t patch_count;
    uint32_t largest_patch; /* strands */
    uint16_t *indices;      /* triangles of the largest patch; a smaller one uses the front of them */
};

#endif
