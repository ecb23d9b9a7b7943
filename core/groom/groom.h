/* groom.h: the groom's insides, shared by what builds it (core/groom) and what moves it (core/sim).
 *
 * Generalised cylinders (GCs) are numbered level by level, coarsest first; the sub-GCs of a GC are
 * contiguous, and so is each tree (top-level GC) at every level. Node (g, i), cross-section i of GC g, has
 * index g * sections + i. Strands are ordered by their finest GC. */
#ifndef GROOM_GROOM_H
#define GROOM_GROOM_H

#include "awt.h"
#include "base/arena.h"
#include "base/vec.h"
#include "groom/plan.h"

struct awt_groom {
    awt_groom_info info;
    awt_rebuilt rebuilt;
    arena memory; /* holds every array below */

    uint32_t gc_count;                        /* all levels */
    uint32_t level_first[AWT_MAX_LEVELS + 1]; /* GCs of level l: level_first[l] .. level_first[l+1]-1 */
    uint32_t *gc_super;                       /* [gc_count]; of a top-level GC: itself */
    uint32_t *gc_sub_first;                   /* [gc_count]; of a finest GC: 0 */
    uint32_t *gc_sub_count;                   /* [gc_count]; of a finest GC: 0 */
    uint32_t *gc_tree;                        /* [gc_count]; the top-level GC above, = its tree's number */
    uint32_t *gc_strand_count;                /* [gc_count] */

    /* nodes, [gc_count * sections] */
    vec3 *rest_position; /* head frame; a super-node stands at the centre of mass of its sub-nodes */
    float *rest_radius;  /* contains the sub-nodes' sections */
    float *rest_room;    /* of it, what the neighbours leave room for (pack.h); a root section's: 0 */

    float mass_unit_kg; /* a power of two; a node weighs gc_strand_count * mass_unit_kg, exactly */

    /* finest level */
    quat *rest_frame; /* [finest GCs * sections]; section frame to head frame, e_y along the wisp */

    /* strands, binding to the stations of their finest GC (evaluate.h) */
    uint32_t *gc_strand_first; /* [finest GCs + 1] */
    float *strand_offset;      /* [strands][3][points]; x y z in the frames of the stations */
};

static inline uint32_t groom_finest_first(const awt_groom *groom)
{
    return groom->level_first[groom->info.levels - 1];
}

/* The GCs one level below GCs lo .. hi-1 (contiguous). False: those are the finest. */
static inline bool groom_descend(const awt_groom *groom, uint32_t *lo, uint32_t *hi)
{
    if (groom->gc_sub_count[*lo] == 0) {
        return false;
    }
    uint32_t last = *hi - 1;
    *lo = groom->gc_sub_first[*lo];
    *hi = groom->gc_sub_first[last] + groom->gc_sub_count[last];
    return true;
}

/* Sets every size of a zeroed groom. */
void groom_take_plan(awt_groom *groom, const groom_plan *plan);
/* Takes the memory of all arrays, zeroed, for the sizes that the groom has. False: no memory. */
bool groom_take_memory(awt_groom *groom);
/* Sets gc_super, gc_sub_first, gc_tree and gc_strand_first from gc_sub_count and gc_strand_count. False: the counts
 * do not make trees that share out all wisps and strands. */
bool groom_number(awt_groom *groom);

#endif
