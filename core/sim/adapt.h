/* adapt.h: the AWT splits and merges (AWT §3.1, §3.2). */
#ifndef SIM_ADAPT_H
#define SIM_ADAPT_H

#include "sim/state.h"

typedef struct adapt_counts {
    uint32_t splits, merges;
} adapt_counts;

/* Merges, then splits, where the rules say so: at most one event of each GC in a step. Positions of finest nodes, mass
 * and momentum stay as they are. */
adapt_counts adapt_tree(awt_forest *f, uint32_t t);

#endif
