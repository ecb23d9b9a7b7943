/* draco_extra.h: attributes of a mesh that are the same in every frame: encoded once, copied behind the positions.
 *
 * Each has an attributes decoder of its own in Draco's bitstream, so that its data stand apart from those of the
 * positions: | its description, beside that of the positions | ... positions ... | difference prediction, wrapped | u8
 * 1: compressed | differences as symbols | i32 0, i32 2^bits - 1 | and of quantised floats f32 0 a component, f32
 * range, u8 bits. */
#ifndef GEOM_DRACO_EXTRA_H
#define GEOM_DRACO_EXTRA_H

#include "geom/draco_write.h"
#include "geom/read.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The attributes that there are, in the order of their bits (geom_attribute). */
enum { DRACO_EXTRAS = 3, DRACO_EXTRA_BITS = 14, DRACO_EXTRA_DESCRIPTION_BYTES = 7 };

/* What one is called in glTF, and how Draco describes it. */
typedef struct draco_extra_form {
    geom_attribute attribute;
    const char *name;
    uint8_t type, data_type, components; /* as Draco numbers them */
    bool quantised;                      /* floats from 0 to a range; else u16 */
} draco_extra_form;

/* Number `index` < DRACO_EXTRAS; its unique id in the mesh is index + 1. Static storage. */
const draco_extra_form *draco_extra_at(uint32_t index);
uint32_t draco_extra_count(uint32_t attributes);
/* Writes the descriptions of these attributes to `at` [DRACO_EXTRAS * DRACO_EXTRA_DESCRIPTION_BYTES]; returns the place
 * after them. */
unsigned char *draco_extra_describe(uint32_t attributes, unsigned char *at);

/* The values of one: [vertices][components], each below 2^DRACO_EXTRA_BITS. */
typedef struct draco_extra_values {
    const uint16_t *numbers;
    float range; /* of floats: what the greatest number stands for */
} draco_extra_values;

/* Gives a mesh of draco_mesh_make that has positions these attributes, and their values [DRACO_EXTRAS], of which only
 * those of `attributes` are looked at. AWT_NO_MEMORY; the mesh is unchanged then. */
awt_status draco_extra_add(draco_mesh *mesh, uint32_t attributes, const draco_extra_values *values, awt_error *error);

#ifdef __cplusplus
}
#endif

#endif
