/* hanging.h: what hangs on a tree that is not split, LANES cross-sections at once (embed.c).
 *
 * Where every active node is of one GC, that GC's sub-nodes lie section by section in every array, and the sections
 * can be taken side by side. The same products in the same order as section by section: not a bit differs. */
#ifndef SIM_HANGING_H
#define SIM_HANGING_H

#include "sim/state.h"

/* True: the tree's slots are one GC's sections, at least LANES of them. */
bool hanging_is_even(const awt_forest *f, const tree *t);

/* Offsets and frames below the tree go by `share` towards rest, turned at section i by turn[i]; those of the root's
 * section stay. True: all of them were near (EMBED_SETTLED_M, EMBED_SETTLED_TURN). The tree is even. */
bool hanging_relax(awt_forest *f, const tree *t, const quat *turn, float share);

#endif
