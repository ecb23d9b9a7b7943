/* layout.h: what of a groom decides the shape of its frames (geom_layout's insides, for core/geom alone). */
#ifndef GEOM_LAYOUT_H
#define GEOM_LAYOUT_H

#include "geom/binding.h"
#include "geom/box.h"
#include "geom/draco_write.h"
#include "geom/encode.h"
#include "geom/glb_template.h"
#include "geom/level.h"
#include "geom/ribbon.h"

/* Top-level wisps that a patch is of: first .. last. */
typedef struct layout_trees {
    uint32_t first, last;
} layout_trees;

struct geom_layout {
    geom_kind kind;
    bool stock;
    level_strands level;                 /* of ribbons and strands: which strands those are */
    draco_attributes attributes;         /* of its meshes */
    uint32_t strands, points_per_strand; /* of guides: finest wisps, and sections of each */
    geom_binding *binding;               /* of guides; else NULL */
    ribbon_shape shape;
    uint32_t extra; /* attributes (geom_attribute) of its vertices */
    float colour[3];
    float *half_width;      /* [points_per_strand]; the shape's; of guides NULL */
    draco_box box;          /* one for all patches and all frames */
    quantise_bounds bounds; /* vertices are set onto them */
    geom_patch *patches;
    layout_trees *patch_trees; /* [patch_count] */
    uint32_t patch_count;
    uint32_t largest_patch; /* strands */
    uint16_t *indices;      /* triangles of the largest patch; a smaller one uses the front of them */
    draco_mesh *meshes;     /* [patch_count]; of the own encoder */
    glb_template frame;
};

static inline uint32_t layout_patch_vertices(const geom_layout *layout, const geom_patch *patch)
{
    return patch->strands * layout->points_per_strand * (layout->kind == GEOM_RIBBON ? 2 : 1);
}

#endif
