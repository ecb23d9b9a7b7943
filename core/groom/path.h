/* path.h: the way a lock of a built-in style takes from its root: off the scalp, along the combing direction, then
 * falling, over the head and body and not through them. */
#ifndef GROOM_PATH_H
#define GROOM_PATH_H

#include "base/vec.h"
#include "groom/figure.h"
#include "groom/look.h"

enum { PATH_STEPS = 72 };

typedef struct path_start {
    dvec3 place; /* direction of the root from the head's centre */
    double length_m;
    double layer;    /* 0: against the scalp, 1: on top of all other hair */
    double side;     /* of the parting: -1 or 1 */
    double turn_sin; /* turn of the combing direction about the scalp's normal */
} path_start;

typedef struct path {
    double length_m;
    dvec3 point[PATH_STEPS + 1]; /* evenly spaced */
    dvec3 side[PATH_STEPS + 1]; /* at right angles to the path, turning no more than it does; set by path_carry_sides */
} path;

/* Without sides: most paths need none. */
void path_grow(const style_look *look, const figure *body, const path_start *start, path *out);
void path_carry_sides(path *way);

/* The path's place `arc_m` from the root. */
dvec3 path_place(const path *way, double arc_m);
/* The same with its two cross directions. */
dvec3 path_at(const path *way, double arc_m, dvec3 *across_u, dvec3 *across_v);

#endif
