/* obstacle.h: head and body (AWT §4.3): spheres and tapered capsules that hair is kept out of. */
#ifndef SIM_OBSTACLE_H
#define SIM_OBSTACLE_H

#include "sim/state.h"

/* The default head and body for this groom: of its head's radius, and without the body where the groom grows beyond the
 * head (a mane, fur): all roots ride the head, so the body would move through its own hair. Returns how many. */
uint32_t obstacle_defaults(const awt_groom *groom, awt_collider out[AWT_MAX_COLLIDERS]);

/* AWT_BAD_VALUE for what cannot be an obstacle. */
awt_status obstacle_check(const awt_collider *colliders, uint32_t count, awt_error *error);

/* Puts the obstacles where the poses of this sub-step have them; `before` are the poses of its beginning. */
void obstacle_place(awt_forest *f, const track_pose *before, float dt_s);

/* Root to tip: every link gets exactly its length, and every child node that is inside an obstacle turns about its
 * parent onto the surface and takes the obstacle's velocity, and of its own along the surface the share
 * params.obstacle_slip. Where the surface cannot be reached so, the link wins and the node is counted. Returns how
 * many. */
uint32_t obstacle_settle(awt_forest *f, const tree *t, float dt_s);

#endif
