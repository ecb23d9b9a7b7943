/* dynamics.h: forces and integration of one tree (AWT §2.3; PHYSICS.md, steps 5, 6 and 8). */
#ifndef SIM_DYNAMICS_H
#define SIM_DYNAMICS_H

#include "sim/state.h"

/* From the state at the beginning of the sub-step: f->next where the nodes would go without links; the root goes
 * with the head. */
void dynamics_predict(awt_forest *f, const tree *t, float dt_s);

/* From f->next after the links: positions, velocities, filtered accelerations, relaxed link lengths. Returns how many
 * nodes the speed limit stopped. */
uint32_t dynamics_finish(awt_forest *f, const tree *t, float dt_s);

/* Before dynamics_predict, with this sub-step's pushes and wind: filters f->agitation, with the time constant of the
 * acceleration. Contacts count by the change of velocity that they push a node to, per second. The air counts by the
 * drag of gusts and of the node's own motion through it; the steady wind does not, for it bends all of a wisp alike and
 * hair at rest in it is to be whole and asleep. Does nothing where neither has a weight. */
void dynamics_agitate(awt_forest *f, const tree *t, float dt_s);

/* After the parameters have changed: nothing remains of an agitation that no longer has any weight. */
void dynamics_calm(awt_forest *f);

#endif
