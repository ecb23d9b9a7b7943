/* measure.h: how wide strands are drawn, and the cube that a groom's positions are quantised in. */
#ifndef GEOM_MEASURE_H
#define GEOM_MEASURE_H

#include "awt.h"
#include "geom/box.h"

/* A ribbon narrower than this many quantisation steps loses its shape (STREAM.md, traps). */
#define MEASURE_LEAST_STEPS 4.0f

/* Half the width of a strand at its middle, metres; `growth` times that of the whole hair's. */
float measure_middle(const awt_groom_info *info, float growth);
/* Half widths [points_per_strand] from root to tip, none under `least`. */
void measure_half_widths(const awt_groom_info *info, float growth, float least, float *half_width);

/* The groom's box, made a cube, with room for half a ribbon around it. */
draco_box measure_box(const awt_groom_info *info, float half_width, int bits);

#endif
