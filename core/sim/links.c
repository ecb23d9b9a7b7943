/* links.c: the mass-weighted projection of §2.3's rigid links, solved exactly.
 *
 * Wanted: displacements d of least sum of m |d|^2 with t_a . (d_a - d_parent) = gap_a for every link, t_a its
 * direction. The links make a tree, so elimination from tip to root and substitution from root to tip is exact and
 * O(n): seen from its parent, a whole sub-tree is one 3 x 3 mass (its own, plus for every child's link the mass that it
 * drags along its direction). Sweeps in van Overveld's manner need about M^2 rounds for a chain of M links to
 * say the same, and lose weight and momentum where they stop early; this is one round a Newton step.
 *
 * The pulls act along the links as they stood at the beginning of the sub-step, as in SHAKE: there the forces balanced,
 * and along the predicted links hair at rest would sag by millimetres. But a pull along an old direction is explicit,
 * and on short links with much weight on them too stiff for the step; these turn, by their `lead`, towards the
 * predicted direction. */
#include "sim/links.h"

/* Cosine of a turn in one sub-step beyond which the old direction says nothing any more. */
#define LINK_FAR_TURN 0.7f
/* Stiffness of a link's turning in units of 1 / dt^2 (4 is the limit of an explicit step) where its lead begins and is
 * whole. */
#define LINK_LEAD_BEGIN 0.5f
#define LINK_LEAD_WHOLE 1.5f

/* Sets the pull direction of slot k's link and returns by how much the link has to be stretched along it to have its
 * length. A link that turns far in this sub-step is pulled along its present direction. */
static float link_gap(awt_forest *f, uint32_t k, uint32_t parent)
{
    vec3 link = vec3_sub(f->next[k], f->next[parent]), old = f->tangent[k];
    float target = f->link_length[f->active_node[k]], length2 = vec3_dot(link, link);
    vec3 now = vec3_unit(link, old);
    float lead = vec3_dot(now, old) < LINK_FAR_TURN ? 1.0f : f->active_lead[k];
    f->tangent[k] = vec3_unit(vec3_lerp(old, now, lead), now);
    float along = vec3_dot(link, f->tangent[k]);
    return along > 1e-9f ? 0.5f * (target * target - length2) / along : target;
}

/* Tip to root: per link, its direction, its gain (the mass it drags) and what is left of its gap. */
static void links_eliminate(awt_forest *f, const tree *t)
{
    uint32_t first = t->first, end = t->first + t->count;
    for (uint32_t k = first; k < end; k++) {
        f->link_mass[k] = sym3_of_scalar(f->active_mass[k]);
        f->link_carry[k] = (vec3){0, 0, 0};
    }
    for (uint32_t k = end - 1; k > first; k--) {
        uint32_t p = f->active_parent[k];
        float gap = link_gap(f, k, p);
        vec3 along = f->tangent[k];
        sym3 inverse = sym3_inverse(f->link_mass[k]);
        vec3 push = sym3_apply(inverse, along), carry = sym3_apply(inverse, f->link_carry[k]);
        float gain = 1.0f / vec3_dot(along, push);
        gap -= vec3_dot(along, carry);
        f->link_push[k] = push;
        f->link_carry[k] = carry;
        f->link_gain[k] = gain;
        f->link_gap[k] = gap;
        f->link_mass[p] = sym3_add_outer(f->link_mass[p], along, gain);
        f->link_carry[p] = vec3_mad(f->link_carry[p], along, -gain * gap);
    }
}

/* Root to tip: the displacements. */
static void links_substitute(awt_forest *f, const tree *t)
{
    vec3 *moved = f->link_carry; /* turns from carried into displacement, slot by slot */
    moved[t->first] = (vec3){0, 0, 0};
    for (uint32_t k = t->first + 1; k < t->first + t->count; k++) {
        float pull = f->link_gain[k] * (f->link_gap[k] + vec3_dot(f->tangent[k], moved[f->active_parent[k]]));
        moved[k] = vec3_mad(f->link_carry[k], f->link_push[k], pull);
        f->next[k] = vec3_add(f->next[k], moved[k]);
    }
}

void links_project(awt_forest *f, const tree *t)
{
    int iterations = (int)f->params.link_iterations;
    for (int n = 0; n < iterations; n++) {
        links_eliminate(f, t);
        links_substitute(f, t);
    }
}

void links_measure(awt_forest *f, const tree *t)
{
    const awt_params *p = &f->params;
    const float step_s = (float)AWT_STEP_US * 1e-6f;
    float gravity = vec3_length(vec3_make(p->gravity_x, p->gravity_y, p->gravity_z));
    for (uint32_t k = t->first + 1; k < t->first + t->count; k++) {
        float stiffness = step_s * step_s * gravity * f->active_hung_mass[k] /
                          (f->active_mass[k] * (f->active_rest_length[k] + 1e-6f));
        float lead = (stiffness - LINK_LEAD_BEGIN) / (LINK_LEAD_WHOLE - LINK_LEAD_BEGIN);
        f->active_lead[k] = lead < 0.0f ? 0.0f : lead > 1.0f ? 1.0f : lead;
    }
}
