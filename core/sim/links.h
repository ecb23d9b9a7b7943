/* links.h: rigid links (AWT §2.3). */
#ifndef SIM_LINKS_H
#define SIM_LINKS_H

#include "sim/state.h"

/* Moves f->next of the tree's nodes, least by mass, so that every link has its target length to first order;
 * params.link_iterations times. The root does not move. */
void links_project(awt_forest *f, const tree *t);

/* Sets how far each slot's link turns towards its predicted direction (links.c); when the slots have been made anew,
 * after joint_measure. */
void links_measure(awt_forest *f, const tree *t);

#endif
