/* between.h: what lies between two steps of a forest, for frames whose time is none of a step. */
#ifndef BETWEEN_H
#define BETWEEN_H

#include "awt.h"

/* `count` vectors of `width` numbers, `share` of the way from one to the other: straight, and those of width 4 as unit
 * quaternions, the shorter way. What is alike in both stays to the bit. */
void between_mix(const float *from, const float *to, double share, uint32_t width, uint32_t count, float *out);

awt_pose between_pose(const awt_pose *from, const awt_pose *to, double share);

#endif
