/* nodes.c: the AWT itself, read back (awt.h): for overlays and for debugging. */
#include "sim/state.h"

static uint32_t level_of(const awt_groom *groom, uint32_t g)
{
    uint32_t level = 0;
    while (g >= groom->level_first[level + 1]) {
        level++;
    }
    return level;
}

uint32_t awt_forest_nodes(const awt_forest *f, awt_node *out)
{
    const awt_groom *groom = f->groom;
    uint32_t count = 0;
    for (uint32_t t = 0; t < groom->info.wisp_count[0]; t++) {
        const tree *tr = &f->trees[t];
        const uint32_t first = count; /* of the tree, in the list */
        for (uint32_t k = tr->first; k < tr->first + tr->count; k++) {
            const uint32_t node = f->active_node[k];
            const vec3 at = state_to_head(f, f->position[node]);
            out[count++] = (awt_node){.position = {at.x, at.y, at.z},
                                      .radius_m = f->radius[node],
                                      .level = level_of(groom, node / groom->info.sections),
                                      .parent = first + f->active_parent[k] - tr->first};
        }
    }
    return count;
}
