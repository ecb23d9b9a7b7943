/* head.h: the head under a file's roots: found from them, and what they say of it. File units and axes throughout. */
#ifndef GROOM_HEAD_H
#define GROOM_HEAD_H

#include "awt.h"
#include "base/vec.h"

enum { HEAD_MAX_ROOTS = 8192 }; /* of more strands an even choice is looked at */

/* A strand as far as it tells of the head. */
typedef struct head_root {
    dvec3 at;
    dvec3 growth; /* unit: from the root to the next point that differs */
    dvec3 fall;   /* unit: from the root to the tip; zero where they coincide */
} head_root;

typedef struct head_sphere {
    dvec3 centre;
    double radius;
} head_sphere;

/* What the roots near a head's surface say. */
typedef struct head_view {
    double coverage;  /* share of the sphere, 0 .. 1, over which hair grows */
    dvec3 mean;       /* mean direction of these roots from the centre */
    bool covers_head; /* enough of it to tell its axes */
} head_view;

/* Fills roots[<= HEAD_MAX_ROOTS] from strands whose points are all finite; returns how many. */
uint32_t head_roots(const awt_strands *strands, head_root *roots);

/* The sphere that the largest part of the roots, counted from the top along Y or Z, lies on. `up`: the axis to look
 * along; AWT_UP_GUESS: both. AWT_NO_HEAD with the reason and what to give. */
awt_status head_find(const head_root *roots, uint32_t count, awt_up_axis up, head_sphere *out, awt_error *error);

/* Does a root lie near the sphere's surface? */
bool head_carries(const head_sphere *head, const head_root *root);

head_view head_look(const head_root *roots, uint32_t count, const head_sphere *head);

#endif
