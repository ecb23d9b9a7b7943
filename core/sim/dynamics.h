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

#endif
