/* sphere.h: the sphere nearest to some of a file's roots, by least squares. Whether it is a head is head.h's. */
#ifndef GROOM_SPHERE_H
#define GROOM_SPHERE_H

#include "groom/head.h"

enum { SPHERE_MIN_ROOTS = 50 /* of fewer nothing is said */ };

/* The roots that are looked at: above a height, and, once there is a sphere, not far from it. */
typedef struct sphere_window {
    awt_up_axis up;
    double lowest;
    head_sphere around; /* radius 0: anywhere */
    double reach;
} sphere_window;

typedef struct sphere_fit {
    head_sphere sphere;   /* radius 0: none fits */
    sphere_window window; /* the roots it was fitted to */
    double residual;      /* rms, in radii */
    uint32_t used;        /* how many they are */
} sphere_fit;

/* Of a point along the axis. */
double sphere_height(dvec3 at, awt_up_axis up);
/* Distance of a point from the surface, outside or inside. */
double sphere_off_surface(const head_sphere *sphere, dvec3 at);
/* Is the root one of those that are looked at? */
bool sphere_window_holds(const sphere_window *window, const head_root *root);

/* The sphere nearest to the roots at `lowest` and above: fits, leaves out what is further than three standard
 * deviations from the sphere, and fits again. Its radius is 0 where they are too few or lie in a plane. */
sphere_fit sphere_through(const head_root *roots, uint32_t count, awt_up_axis up, double lowest);

#endif
