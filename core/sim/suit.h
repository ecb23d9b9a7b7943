/* suit.h: a style frequency that suits a groom of which nothing is known but its strands. */
#ifndef SIM_SUIT_H
#define SIM_SUIT_H

#include "groom/groom.h"

/* rad/s. Gravity alone bends every joint about alike, as in the built-in styles; hair that stands upright is stiff
 * enough not to buckle under its own weight, nearly all of it. */
float suit_style_omega(const awt_groom *groom);

#endif
