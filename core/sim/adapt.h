/* adapt.h: the AWT splits and merges (AWT §3.1, §3.2). */
#ifndef SIM_ADAPT_H
#define SIM_ADAPT_H

#include "sim/state.h"

typedef struct adapt_counts {
    uint32_t splits, merges;
    uint32_t refused; /* splits that were due and beyond the budget */
} adapt_counts;

/* Merges, then splits, where the rules say so: at most one event of each GC in a step, and at most `budget` splits,
 * those of coarser GCs first. Positions of finest nodes, mass and momentum stay as they are. */
adapt_counts adapt_tree(awt_forest *f, uint32_t t, uint32_t budget);

/* adapt_tree for all trees that are awake, which share the step's budget of splits (params.split_budget): when nearly
 * everything splits at once, the burst is spread over the next steps. The trees are asked round the head from where the
 * last step's budget ended (split_from), so that a tree that is refused is the first to be asked after as many steps as
 * there are trees at most. Only the order of trees decides, not the order in which they were stepped. */
adapt_counts adapt_forest(awt_forest *f);

#endif
