/* extras.h: the values of attributes that are the same in every frame (read.h, geom_attribute), patch by patch. */
#ifndef GEOM_EXTRAS_H
#define GEOM_EXTRAS_H

#include "geom/layout.h"

/* Gives every mesh of a layout of ribbons or strands these attributes. AWT_NO_MEMORY. */
awt_status extras_add(geom_layout *layout, const awt_groom *groom, uint32_t attributes, awt_error *error);

/* The place on the scalp of a root, both from 0 to 1: Lambert's azimuthal projection of its direction from the head's
 * centre. The crown is (1/2, 1/2), +x (the head's left) is to the right, +z (the face) is down, a circle around the
 * crown stays one, and equal parts of the head have equal parts of the square. */
void extras_root_uv(const float root[3], float uv[2]);

#endif
