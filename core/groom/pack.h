/* pack.h: how much room the wisps of a level leave each other.
 *
 * The radius of a wisp contains its strands (AWT §2.1), and the strands of neighbours mix: drawn hair has wisps that
 * lie in each other many deep (forty segments about each, where a pile of cylinders has six), and if all of these
 * rubbed, each would rub against the whole lock. So a segment has room up to half the way to its sixth nearest
 * neighbour of the same level at rest, as far as cylinders side by side have; contacts are between wisps that lie side
 * by side. */
#ifndef GROOM_PACK_H
#define GROOM_PACK_H

#include "groom/groom.h"

/* Fills rest_room from rest_position and rest_radius. False: no memory. */
bool pack_wisps(awt_groom *groom);

#endif
