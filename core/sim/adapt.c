/* adapt.c: see adapt.h.
 *
 * With the state as one number per GC the paper's order is built in: only node (g, first_split - 1) can split, whose
 * child has split already (tip to root), and only the sub-nodes at (., first_split) can merge (root to tip). The root
 * cross-section stays coarse. */
#include "sim/adapt.h"

#include "sim/embed.h"
#include "sim/rest.h"
#include "sim/tree.h"

/* The super-node that stands for the sub-nodes of (g, i): centre of mass, mean velocity, acceleration and agitation by
 * mass, and the radius that just contains them (§3.2). Sums in double: nothing is lost. */
typedef struct fusion {
    vec3 position, velocity, acceleration;
    float agitation, radius;
} fusion;

static fusion adapt_fuse(const awt_forest *f, uint32_t g, uint32_t i)
{
    const awt_groom *groom = f->groom;
    const uint32_t sections = groom->info.sections;
    const uint32_t first = groom->gc_sub_first[g], end = first + groom->gc_sub_count[g];
    dvec3 x = {0, 0, 0}, v = {0, 0, 0}, a = {0, 0, 0};
    double agitation = 0, mass = 0;
    for (uint32_t s = first; s < end; s++) {
        uint32_t node = s * sections + i;
        double m = groom->gc_strand_count[s];
        x = dvec3_add(x, dvec3_scale(dvec3_of_vec3(f->position[node]), m));
        v = dvec3_add(v, dvec3_scale(dvec3_of_vec3(f->velocity[node]), m));
        a = dvec3_add(a, dvec3_scale(dvec3_of_vec3(f->acceleration[node]), m));
        agitation += (double)f->agitation[node] * m;
        mass += m;
    }
    fusion result = {vec3_of_dvec3(dvec3_scale(x, 1.0 / mass)), vec3_of_dvec3(dvec3_scale(v, 1.0 / mass)),
                     vec3_of_dvec3(dvec3_scale(a, 1.0 / mass)), (float)(agitation / mass), 0};
    for (uint32_t s = first; s < end; s++) {
        uint32_t node = s * sections + i;
        float reach = vec3_distance(f->position[node], result.position) + f->radius[node];
        result.radius = reach > result.radius ? reach : result.radius;
    }
    return result;
}

/* |a| * radius, the measure of §3.1; beside |a| stands what §5.3 would add to it. */
static float split_measure(vec3 acceleration, float agitation, float radius)
{
    return (vec3_length(acceleration) + agitation) * radius;
}

/* Long enough since the last event of this GC? */
static bool adapt_settled(const awt_forest *f, uint32_t g)
{
    return (double)(f->time_us - f->event_us[g]) * 1e-6 >= (double)f->params.residence;
}

/* §3.2's three conditions, for the sub-nodes at (g, first_split). All of them share one parent, whatever its level. */
static bool merge_due(const awt_forest *f, uint32_t g, fusion *out)
{
    const awt_groom *groom = f->groom;
    const uint32_t sections = groom->info.sections, i = f->first_split[g];
    if (i >= sections || !adapt_settled(f, g)) {
        return false;
    }
    const uint32_t first = groom->gc_sub_first[g], end = first + groom->gc_sub_count[g];
    for (uint32_t s = first; s < end; s++) {
        if (f->first_split[s] <= i) {
            return false; /* split further: its own sub-nodes merge first */
        }
    }
    *out = adapt_fuse(f, g, i);
    /* What still lies apart when nothing moves any more, an obstacle holds there; it merges too, and its offsets relax.
     */
    bool settled = rest_is_settled(&f->trees[groom->gc_tree[g]]);
    float reach = groom->rest_radius[g * sections + i] * f->params.merge_slack;
    for (uint32_t s = first; s < end; s++) {
        uint32_t node = s * sections + i;
        if ((!settled && vec3_distance(f->position[node], out->position) > reach) ||
            vec3_distance(f->velocity[node], out->velocity) > f->params.merge_velocity) {
            return false;
        }
    }
    return split_measure(out->acceleration, out->agitation, out->radius) <=
           f->params.split_threshold * f->params.split_hysteresis;
}

static void merge_apply(awt_forest *f, uint32_t g, const fusion *super)
{
    const awt_groom *groom = f->groom;
    const uint32_t sections = groom->info.sections, i = f->first_split[g]++, node = g * sections + i;
    f->event_us[g] = f->time_us;
    f->position[node] = super->position;
    f->velocity[node] = super->velocity;
    f->acceleration[node] = super->acceleration;
    f->agitation[node] = super->agitation;
    f->radius[node] = super->radius;
    for (uint32_t s = groom->gc_sub_first[g]; s < groom->gc_sub_first[g] + groom->gc_sub_count[g]; s++) {
        f->offset[s * sections + i] = state_to_head(f, vec3_sub(f->position[s * sections + i], super->position));
        f->parent_node[s * sections + i] = STATE_NO_PARENT;
    }
}

/* §3.1: the node before the first split one, if it is active and its measure exceeds the threshold. */
static bool split_due(const awt_forest *f, uint32_t g)
{
    const awt_groom *groom = f->groom;
    const uint32_t i = f->first_split[g] - 1, super = groom->gc_super[g];
    bool active = i >= 1 && (super == g || i >= f->first_split[super]);
    if (!active || !adapt_settled(f, g)) {
        return false;
    }
    uint32_t node = g * groom->info.sections + i;
    return split_measure(f->acceleration[node], f->agitation[node], f->radius[node]) > f->params.split_threshold;
}

static void split_apply(awt_forest *f, uint32_t g)
{
    const awt_groom *groom = f->groom;
    const uint32_t sections = groom->info.sections, i = --f->first_split[g], node = g * sections + i;
    f->event_us[g] = f->time_us;
    f->parent_node[node] = STATE_NO_PARENT;
    for (uint32_t s = groom->gc_sub_first[g]; s < groom->gc_sub_first[g] + groom->gc_sub_count[g]; s++) {
        uint32_t sub = s * sections + i;
        f->position[sub] = vec3_add(f->position[node], mat3_apply(f->head, f->offset[sub]));
        f->velocity[sub] = f->velocity[node];
        f->acceleration[sub] = f->acceleration[node];
        f->agitation[sub] = f->agitation[node];
        f->radius[sub] = groom->rest_radius[sub];
    }
}

/* After events: the slots anew, references at the present tangents, and links whose parent changed at their present
 * lengths (from which they relax). */
static void adapt_rebase(awt_forest *f, uint32_t t)
{
    tree_rebuild(f, t);
    const tree *tr = &f->trees[t];
    embed_refer(f, tr);
    for (uint32_t k = tr->first + 1; k < tr->first + tr->count; k++) {
        uint32_t node = f->active_node[k], parent = f->active_node[f->active_parent[k]];
        if (f->parent_node[node] != parent) {
            f->parent_node[node] = parent;
            f->link_length[node] = vec3_distance(f->position[node], f->position[parent]);
        }
    }
}

adapt_counts adapt_tree(awt_forest *f, uint32_t t, uint32_t budget)
{
    const awt_groom *groom = f->groom;
    adapt_counts counts = {0};
    bool baked = false;
    uint32_t lo = t, hi = t + 1;
    do {
        for (uint32_t g = lo; g < hi && groom->gc_sub_count[g] > 0; g++) {
            fusion super;
            bool merges = merge_due(f, g, &super);
            bool splits = !merges && split_due(f, g);
            bool refused = splits && counts.splits == budget;
            counts.refused += refused;
            if (refused || (!merges && !splits)) {
                continue;
            }
            if (!baked) {
                embed_bake(f, &f->trees[t]);
                f->trees[t].loose = baked = true;
            }
            if (merges) {
                merge_apply(f, g, &super);
                counts.merges++;
            } else {
                split_apply(f, g);
                counts.splits++;
            }
        }
    } while (groom_descend(groom, &lo, &hi));
    if (baked) {
        adapt_rebase(f, t);
    }
    return counts;
}

static uint32_t adapt_budget(const awt_params *p)
{
    return p->split_budget > 0.0f ? (uint32_t)ceilf(p->split_budget) : UINT32_MAX;
}

/* The next step begins with the first tree refused, but not with the same one as this step unless it is the only one:
 * its share has been given to it, and others wait. */
adapt_counts adapt_forest(awt_forest *f)
{
    const uint32_t trees = f->groom->info.wisp_count[0], from = f->split_from, budget = adapt_budget(&f->params);
    adapt_counts all = {0};
    for (uint32_t n = 0; n < trees; n++) {
        uint32_t t = n < trees - from ? from + n : from + n - trees;
        if (f->trees[t].asleep) {
            continue;
        }
        adapt_counts counts = adapt_tree(f, t, budget - all.splits);
        if (counts.refused > 0 && f->split_from == from) {
            f->split_from = t;
        }
        all.splits += counts.splits;
        all.merges += counts.merges;
        all.refused += counts.refused;
    }
    return all;
}
