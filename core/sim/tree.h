/* tree.h: which nodes are active, and the tree that their segments make (AWT §2.2).
 *
 * The state is one number per GC, first_split; everything here follows from it. */
#ifndef SIM_TREE_H
#define SIM_TREE_H

#include "sim/state.h"

/* Nodes that can be active at once in the tree of top-level GC t: the root section and the finest of every other. */
uint32_t tree_capacity(const awt_groom *groom, uint32_t t);

/* Makes the slots of tree t anew from first_split, with rest lengths and the style's targets. */
void tree_rebuild(awt_forest *f, uint32_t t);

#endif
