/* tree.h: which nodes are active, and the tree that their segments make (AWT §2.2).
 *
 * The state is one number per GC, first_split; everything here follows from it. */
#ifndef SIM_TREE_H
#define SIM_TREE_H

#include "sim/forest.h"

/* Nodes that can be active at once in the tree of top-level GC t: the root section and the finest of every other. */
uint32_t tree_capacity(const awt_groom *groom, uint32_t t);

/* Makes the slots of tree t anew from first_split, with rest lengths and the style's targets. */
void tree_rebuild(awt_forest *f, uint32_t t);

/* The GCs one level below GCs lo .. hi-1 (contiguous). False: those are the finest. */
static inline bool tree_descend(const awt_groom *groom, uint32_t *lo, uint32_t *hi)
{
    if (groom->gc_sub_count[*lo] == 0) {
        return false;
    }
    uint32_t last = *hi - 1;
    *lo = groom->gc_sub_first[*lo];
    *hi = groom->gc_sub_first[last] + groom->gc_sub_count[last];
    return true;
}

#endif
