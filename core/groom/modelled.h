/* modelled.h: a hierarchy that came with the strands, as the paper's modeller drew it (AWT 2.1), checked and brought
 * into the order that a groom has: the wisps of a level in the order of their first strands, inside the wisp above, and
 * a wisp's strands in their own order. The wisps' numbers play no part in it: with other numbers the groom is the same.
 */
#ifndef GROOM_MODELLED_H
#define GROOM_MODELLED_H

#include "groom/plan.h"

typedef struct modelled_strand {
    uint32_t first[AWT_MAX_LEVELS]; /* the first strand of the wisp it is in, level by level: what names the wisp */
    uint32_t strand;                /* of the input */
} modelled_strand;

/* Strands in the groom's order, [strand_count] from the heap, and the plan's levels and wisp_count. The plan must have
 * been made for these strands and this hierarchy. AWT_BAD_VALUE, AWT_NO_MEMORY; *out is then NULL. */
awt_status modelled_sort(const awt_strands *strands, const awt_hierarchy *hierarchy, groom_plan *plan,
                         modelled_strand **out, awt_error *error);

#endif
