/* tree.c: see tree.h. */
#include "sim/tree.h"

#include "base/assert.h"
#include "sim/embed.h"
#include "sim/links.h"
#include "sim/joint.h"

uint32_t tree_capacity(const awt_groom *groom, uint32_t t)
{
    uint32_t lo = t, hi = t + 1;
    while (groom_descend(groom, &lo, &hi)) {
    }
    return 1 + (hi - lo) * (groom->info.sections - 1);
}

/* The GC whose node at section i governs GC g: the coarsest one above it, or g itself, that has not split there. */
static uint32_t tree_governor(const awt_forest *f, uint32_t g, uint32_t i)
{
    for (;;) {
        uint32_t super = f->groom->gc_super[g];
        if (super == g || i >= f->first_split[super]) {
            return g;
        }
        g = super;
    }
}

static void tree_add(awt_forest *f, tree *t, uint32_t g, uint32_t i)
{
    const awt_groom *groom = f->groom;
    uint32_t node = g * groom->info.sections + i, slot = t->first + t->count++;
    uint32_t parent_node = i == 0 ? node : tree_governor(f, g, i - 1) * groom->info.sections + i - 1;
    f->active_node[slot] = node;
    f->slot_of_node[node] = slot;
    f->active_parent[slot] = f->slot_of_node[parent_node];
    f->active_mass[slot] = (float)groom->gc_strand_count[g];
    vec3 link = vec3_sub(groom->rest_position[node], groom->rest_position[parent_node]);
    f->active_rest_length[slot] = vec3_length(link);
    f->active_rest_tangent[slot] = vec3_unit(link, f->active_rest_tangent[f->active_parent[slot]]);
    f->active_style[slot] = link;
}

/* Adds the active nodes of section i at and below GCs lo .. hi-1. */
static void tree_add_section(awt_forest *f, tree *t, uint32_t lo, uint32_t hi, uint32_t i)
{
    for (uint32_t g = lo; g < hi; g++) {
        if (i < f->first_split[g]) {
            tree_add(f, t, g, i);
        } else {
            uint32_t first = f->groom->gc_sub_first[g];
            tree_add_section(f, t, first, first + f->groom->gc_sub_count[g], i);
        }
    }
}

void tree_rebuild(awt_forest *f, uint32_t t)
{
    tree *tr = &f->trees[t];
    tr->count = 0;
    /* A root has no segment: it turns as the head does, whatever this tangent is. */
    f->active_rest_tangent[tr->first] = vec3_make(0, 1, 0);
    f->slot_of_node[t * f->groom->info.sections] = tr->first;
    for (uint32_t i = 0; i < f->groom->info.sections; i++) {
        tree_add_section(f, tr, t, t + 1, i);
    }
    ASSERT(tr->count <= tree_capacity(f->groom, t));
    joint_measure(f, tr);
    links_measure(f, tr);
    embed_measure(f, tr);
}
