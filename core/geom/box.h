/* box.h: the cube in which positions are quantised, with Draco's arithmetic. */
#ifndef GEOM_BOX_H
#define GEOM_BOX_H

#include <stdint.h>

/* The cube that positions are quantised in; origin and range are multiples of 1/64. */
typedef struct draco_box {
    float origin[3], range;
    int bits;
} draco_box;

/* Metres from one quantised position to the next. */
static inline float draco_box_step(const draco_box *box)
{
    return box->range / (float)((1 << box->bits) - 1);
}

/* Coordinate along `axis` that a decoder gives back for whole number `value`. */
static inline float draco_box_coordinate(const draco_box *box, int axis, int32_t value)
{
    return (float)value * draco_box_step(box) + box->origin[axis];
}

/* The whole number that stands for coordinate `value` within the box. */
static inline int32_t draco_box_number(const draco_box *box, int axis, float value)
{
    const float per_metre = (float)((1 << box->bits) - 1) / box->range;
    return (int32_t)((value - box->origin[axis]) * per_metre + 0.5f);
}

#endif
