/* quantised.h: a frame as whole numbers (geom_quantised's insides, for core/geom alone). */
#ifndef GEOM_QUANTISED_H
#define GEOM_QUANTISED_H

#include "geom/delta.h"
#include "geom/encode.h"
#include "geom/layout.h"
#include "geom/patch_numbers.h"

struct geom_quantised {
    const geom_layout *layout; /* of the frame that is here; NULL: none */
    size_t count, held;
    uint32_t patch_count;
    patch_numbers **patches; /* [patch_count]: [strands][points_per_strand][3], of guides [wisps][sections]
                                [GUIDES_COMPONENTS]; of a frame made from another one its own, where nothing moved */
    uint32_t checksum;       /* of the frame */
    int16_t *turns;          /* of guides: [sections of the largest patch][3], working memory; else NULL */
    vec3 *rebuilt; /* of guides: [sections of the largest patch], likewise: centres as a reader will have them */
};

/* What numbers of `strands` strands, or wisps, of the layout are. */
delta_shape quantised_shape(const geom_layout *layout, uint32_t strands);
/* The box of the numbers; of guides there is none, but for the bits. */
draco_box quantised_box(const geom_layout *layout);
/* The id of the binding of guides; else 0. */
uint64_t quantised_binding(const geom_layout *layout);

/* Whether a frame of that layout is here. */
bool quantised_fits(const geom_quantised *quantised, const geom_layout *layout);

/* The numbers of one patch. */
const uint16_t *quantised_patch(const geom_quantised *quantised, uint32_t index);
/* Whether a patch has the same numbers in both frames, of one layout. */
bool quantised_same(const geom_quantised *one, const geom_quantised *other, uint32_t index);

#endif
