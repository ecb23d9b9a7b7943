/* figure.h: the head and body that the hair of built-in styles lies on: the default colliders, at rest. */
#ifndef GROOM_FIGURE_H
#define GROOM_FIGURE_H

#include "awt.h"
#include "base/vec.h"

typedef struct figure_part {
    dvec3 a, axis; /* a capsule from a to a + axis, tapered */
    double axis_square;
    double radius_a_m, radius_b_m, widest_m;
} figure_part;

typedef struct figure {
    figure_part part[AWT_MAX_COLLIDERS];
    uint32_t part_count;
} figure;

/* With a head of AWT_HEAD_RADIUS_M. */
void figure_init(figure *f);

/* `point` moved out of head and body to a distance of at least `clearance_m`. */
dvec3 figure_clear(const figure *f, dvec3 point, double clearance_m);

/* A direction turned along what is near, the more the nearer it is: hair comes to lie on it without a kink. */
dvec3 figure_turn(const figure *f, dvec3 point, dvec3 direction, double clearance_m);

#endif
