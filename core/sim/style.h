/* style.h: the style spring: hair remembers its shape (PHYSICS.md, step 5; not in the paper). */
#ifndef SIM_STYLE_H
#define SIM_STYLE_H

#include "sim/state.h"

/* From the velocities in f->next (the root's is the head's): what a sub-step of the style springs and their dampers
 * makes of them, in place. Needs f->turn and f->tangent. */
void style_resolve(awt_forest *f, const tree *t, float dt_s);

/* Sets the stiffness of each slot's spring, as a multiple of style_omega^2, and the part of gravity that the style
 * carries at rest; when the slots have been made anew. */
void style_measure(awt_forest *f, const tree *t);

#endif
