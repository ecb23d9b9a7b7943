/* joint.h: the springs of a tree, resolved together and implicitly: the style springs by which hair remembers its shape
 * (PHYSICS.md, step 5; not in the paper), and, where a style wants them, viscous spring links (AWT §2.3). */
#ifndef SIM_JOINT_H
#define SIM_JOINT_H

#include "sim/state.h"

/* From the velocities in f->next (the root's is the head's): what a sub-step of the springs and their dampers makes of
 * them, in place. Needs f->turn and f->tangent. */
void joint_resolve(awt_forest *f, const tree *t, float dt_s);

/* Sets what each slot's springs hold, and the part of gravity that the style carries at rest; when the slots have been
 * made anew. */
void joint_measure(awt_forest *f, const tree *t);

static inline bool joint_links_are_springs(const awt_forest *f)
{
    return f->params.links >= 0.5f;
}

#endif
