/* contact.c: friction and repulsion between wisp segments.
 *
 * Segments are cylinders, without caps: where the nearest points are ends of both and each lies beyond the other's end,
 * the two are not in contact there. Hair's radii are greater than its segments are long, and with caps a segment would
 * touch every second one of its own wisp and a handful of each neighbour's.
 *
 * Velocities are taken relative to the turning head: hair that turns with its head as one solid has no relative motion,
 * touches nothing and costs nothing. Only segments faster than half the threshold can be part of a pair above it, so
 * only these look for others.
 *
 * The paper bounds friction by alpha dt < 1 for one contact; a node has ten and more, and their sum would throw it
 * about. So contacts are found first and loads counted: a node's load is the sum over its contacts of its share in the
 * contact point times m / (its mass). With N the greatest load of the four nodes, at least 1, the implicit step of a
 * contact that had N - 1 others like it beside it, friction   J = m v / (2 N) * x / (1 + x),  x = 2 N alpha dt  (and
 * its second-order term), repulsion  J = m o / (2 N dt) * y / (1 + y),  y = 2 N omega^2 dt^2, takes from each side at
 * most half of the relative velocity v and half of the overlap o, however many contacts there are and whatever alpha,
 * omega and dt; for few contacts and short steps it is the paper's k v dt and k o dt. */
#include "sim/contact.h"

#include "base/trig.h"
#include "sim/tree.h"

#define CYLINDER_END_MARGIN 1.001f
#define PARALLEL_SINE2 1e-6f

/* Pairs in contact per slot that there is room for, and at most. */
enum { CONTACTS_PER_SLOT = 16, CONTACTS_MOST = 4 * 1000 * 1000 };

/* An active segment (§4.1): the cylinder from parent to child. */
typedef struct segment {
    vec3 middle, along; /* a unit vector */
    float half_length, radius;
    uint32_t child, parent; /* slots */
} segment;

/* Two segments in contact; P = share * N_parent + (1 - share) * N_child on each axis, eq. (3). */
typedef struct contact {
    uint32_t child[2];
    float share[2];
    float mass;
    vec3 velocity; /* of the second's point against the first's: friction pulls the first along it */
    vec3 overlap;  /* by which the first is to be pushed away from the second; zero: no repulsion */
} contact;

/* What all pairs of one sub-step have in common. */
typedef struct contact_rule {
    float least_speed2; /* relative motion below is none */
    float cosine2;      /* of the angle above which segments repel each other */
    float friction;     /* alpha dt */
    float repulsion;    /* omega^2 dt^2 */
    float per_dt;
} contact_rule;

void contact_lay_out(awt_forest *f, arena *a, size_t slots)
{
    size_t contacts = slots < CONTACTS_MOST / CONTACTS_PER_SLOT ? slots * CONTACTS_PER_SLOT : CONTACTS_MOST;
    f->active_push = ARENA_PUSH(a, vec3, slots);
    f->contact_velocity = ARENA_PUSH(a, vec3, slots);
    f->contact_load = ARENA_PUSH(a, float, slots);
    f->segments = ARENA_PUSH(a, segment, slots);
    f->segment_box = ARENA_PUSH(a, grid_box, slots);
    f->contacts = ARENA_PUSH(a, contact, contacts);
    f->contact_capacity = (uint32_t)contacts;
    grid_lay_out(&f->grid, a, slots);
}

static contact_rule contact_rule_of(const awt_params *p, float dt_s)
{
    double sine, cosine;
    trig_sin_cos((double)p->contact_angle * (TRIG_PI / 180.0), &sine, &cosine);
    return (contact_rule){p->relative_motion * p->relative_motion, (float)(cosine * cosine), p->friction_alpha * dt_s,
                          p->repulsion_omega * p->repulsion_omega * dt_s * dt_s, 1.0f / dt_s};
}

static vec3 slot_position(const awt_forest *f, uint32_t slot)
{
    return f->position[f->active_node[slot]];
}

/* ---- segments ---------------------------------------------------------------------------------------------------- */

/* Velocities relative to the turning head, no push and no load; roots ride on it. False: all of it is slower than
 * `speed2` allows. */
static bool contact_begin_tree(awt_forest *f, const tree *t, float speed2)
{
    bool moves = false;
    for (uint32_t k = t->first; k < t->first + t->count; k++) {
        uint32_t node = f->active_node[k];
        vec3 carried = vec3_cross(f->head_spin, f->position[node]), still = {0, 0, 0};
        f->contact_velocity[k] = k == t->first ? still : vec3_sub(f->velocity[node], carried);
        f->active_push[k] = still;
        f->contact_load[k] = 0.0f;
        moves = moves || vec3_dot(f->contact_velocity[k], f->contact_velocity[k]) >= speed2;
    }
    return moves;
}

static float axis_least(float a, float b, float radius)
{
    return (a < b ? a : b) - radius;
}

static float axis_most(float a, float b, float radius)
{
    return (a > b ? a : b) + radius;
}

/* False: not a cylinder in space, and it touches nothing (the grid would never have room for it). */
static bool segment_put(awt_forest *f, uint32_t k, uint32_t index)
{
    uint32_t p = f->active_parent[k];
    vec3 a = slot_position(f, p), b = slot_position(f, k);
    float r = f->radius[f->active_node[k]];
    vec3 link = vec3_sub(b, a);
    f->segments[index] =
        (segment){vec3_lerp(a, b, 0.5f), vec3_unit(link, vec3_make(0, 0, 0)), 0.5f * vec3_length(link), r, k, p};
    f->segment_box[index] = (grid_box){
        {axis_least(a.x, b.x, r), axis_least(a.y, b.y, r), axis_least(a.z, b.z, r)},
        {axis_most(a.x, b.x, r), axis_most(a.y, b.y, r), axis_most(a.z, b.z, r)},
    };
    return vec3_finite(f->segment_box[index].least) && vec3_finite(f->segment_box[index].most);
}

/* Adds the segments of all trees that move, or that do not, after the first `count`; returns the new count. */
static uint32_t contact_collect(awt_forest *f, bool moving, float speed2, uint32_t count)
{
    for (uint32_t t = 0; t < f->groom->info.wisp_count[0]; t++) {
        const tree *tr = &f->trees[t];
        for (uint32_t k = tr->first + 1; k < tr->first + tr->count; k++) {
            vec3 v = f->contact_velocity[k], v_parent = f->contact_velocity[f->active_parent[k]];
            bool moves = vec3_dot(v, v) >= speed2 || vec3_dot(v_parent, v_parent) >= speed2;
            count += moves == moving && segment_put(f, k, count);
        }
    }
    return count;
}

/* ---- pairs ------------------------------------------------------------------------------------------------------- */

static float share_clamp(float share)
{
    return share < 0.0f ? 0.0f : share > 1.0f ? 1.0f : share;
}

/* Shares along two segments, from their beginnings, of the points nearest to each other. */
static void closest_shares(vec3 a, vec3 along_a, vec3 b, vec3 along_b, float *on_a, float *on_b)
{
    vec3 between = vec3_sub(a, b);
    float aa = vec3_dot(along_a, along_a), bb = vec3_dot(along_b, along_b), ab = vec3_dot(along_a, along_b);
    float a_between = vec3_dot(along_a, between), b_between = vec3_dot(along_b, between);
    float area2 = aa * bb - ab * ab, s = 0.0f, t = 0.0f;
    if (area2 > PARALLEL_SINE2 * aa * bb) {
        s = share_clamp((ab * b_between - a_between * bb) / area2);
    } else if (aa > 0.0f) { /* parallel: the middle of where they lie side by side */
        float begin = -a_between / aa;
        s = 0.5f * (share_clamp(begin) + share_clamp(begin + ab / aa));
    }
    if (bb > 0.0f) {
        t = (ab * s + b_between) / bb;
    }
    if (t < 0.0f || t > 1.0f || bb <= 0.0f) {
        t = t > 1.0f ? 1.0f : 0.0f;
        s = aa > 0.0f ? share_clamp((ab * t - a_between) / aa) : 0.0f;
    }
    *on_a = s;
    *on_b = t;
}

/* How far apart the axes of the two segments are at rest. */
static float rest_distance(const awt_forest *f, const segment *a, const segment *b)
{
    const vec3 *rest = f->groom->rest_position;
    vec3 from_a = rest[f->active_node[a->parent]], from_b = rest[f->active_node[b->parent]];
    vec3 along_a = vec3_sub(rest[f->active_node[a->child]], from_a);
    vec3 along_b = vec3_sub(rest[f->active_node[b->child]], from_b);
    float s, t;
    closest_shares(from_a, along_a, from_b, along_b, &s, &t);
    return vec3_distance(vec3_mad(from_a, along_a, s), vec3_mad(from_b, along_b, t));
}

/* Eq. (2)'s (r - d) (P1 - P2) / |P1 - P2|, where the segments cross at more than the angle. Hair rests overlapping: two
 * wisps are pushed no farther apart than they rest, or their style and this would fight for ever. */
static vec3 contact_overlap(const awt_forest *f, const segment *a, const segment *b, vec3 along_a, vec3 along_b,
                            vec3 apart, float cosine2)
{
    const vec3 none = {0, 0, 0};
    float ab = vec3_dot(along_a, along_b);
    if (!(ab * ab < cosine2 * (vec3_dot(along_a, along_a) * vec3_dot(along_b, along_b)))) {
        return none;
    }
    float wanted = rest_distance(f, a, b), d = vec3_length(apart);
    wanted = wanted < a->radius + b->radius ? wanted : a->radius + b->radius;
    if (!(d < wanted)) {
        return none;
    }
    /* Axes that meet part sideways of both. */
    vec3 away = vec3_unit(apart, vec3_unit(vec3_cross(along_a, along_b), none));
    return vec3_scale(away, wanted - d);
}

/* Does the other axis' nearest point lie beyond the end, at `share`, of this one? `apart` leads here from there, times
 * `sign`. */
static bool beyond_end(vec3 apart, vec3 along, float share, float sign)
{
    float back = -sign * vec3_dot(apart, along), margin = 1e-4f * vec3_dot(along, along);
    return (share >= 1.0f && back > margin) || (share <= 0.0f && back < -margin);
}

/* Is this pair in contact and in relative motion? */
static bool contact_find(const awt_forest *f, const segment *a, const segment *b, const contact_rule *rule,
                         contact *out)
{
    vec3 from_a = slot_position(f, a->parent), from_b = slot_position(f, b->parent);
    vec3 along_a = vec3_sub(slot_position(f, a->child), from_a), along_b = vec3_sub(slot_position(f, b->child), from_b);
    float s, t, r = a->radius + b->radius;
    closest_shares(from_a, along_a, from_b, along_b, &s, &t);
    vec3 apart = vec3_sub(vec3_mad(from_a, along_a, s), vec3_mad(from_b, along_b, t));
    if (!(vec3_dot(apart, apart) < r * r)) {
        return false;
    }
    if (beyond_end(apart, along_a, s, 1.0f) && beyond_end(apart, along_b, t, -1.0f)) {
        return false;
    }
    const vec3 *v = f->contact_velocity;
    vec3 velocity = vec3_sub(vec3_lerp(v[b->parent], v[b->child], t), vec3_lerp(v[a->parent], v[a->child], s));
    if (!(vec3_dot(velocity, velocity) >= rule->least_speed2)) {
        return false;
    }
    float mass_a = f->active_mass[a->child], mass_b = f->active_mass[b->child];
    *out = (contact){
        .child = {a->child, b->child},
        .share = {1.0f - s, 1.0f - t},
        .mass = mass_a < mass_b ? mass_a : mass_b,
        .velocity = velocity,
        .overlap = contact_overlap(f, a, b, along_a, along_b, apart, rule->cosine2),
    };
    return true;
}

/* May these two be in contact? Cheap, and never wrong when it says no. */
static bool segments_near(const segment *a, const segment *b)
{
    vec3 between = vec3_sub(a->middle, b->middle);
    float length = a->half_length + b->half_length, reach = length + a->radius + b->radius;
    if (!(vec3_dot(between, between) < reach * reach)) {
        return false;
    }
    length *= CYLINDER_END_MARGIN;
    return fabsf(vec3_dot(between, a->along)) <= length || fabsf(vec3_dot(between, b->along)) <= length;
}

static bool segments_joined(const segment *a, const segment *b)
{
    return a->child == b->parent || a->parent == b->child || a->parent == b->parent;
}

/* All pairs of one cell that belong to it; returns the new number of contacts. */
static uint32_t contact_search_cell(awt_forest *f, uint32_t cell, uint32_t moving, const contact_rule *rule,
                                    uint32_t found)
{
    const grid *g = &f->grid;
    const segment *segments = f->segments;
    const uint32_t end = g->cell_first[cell + 1];
    for (uint32_t i = g->cell_first[cell]; i < end && g->entry[i] < moving; i++) {
        const segment *a = &segments[g->entry[i]];
        for (uint32_t j = i + 1; j < end; j++) {
            const segment *b = &segments[g->entry[j]];
            if (!segments_near(a, b) || grid_pair_cell(g, g->entry[i], g->entry[j]) != cell || segments_joined(a, b)) {
                continue;
            }
            contact c;
            if (contact_find(f, a, b, rule, &c)) {
                if (found < f->contact_capacity) {
                    f->contacts[found] = c;
                }
                found++;
            }
        }
    }
    return found;
}

/* ---- response ---------------------------------------------------------------------------------------------------- */

/* Adds each contact's part of the loads of its four nodes. */
static void contact_weigh(awt_forest *f, uint32_t count)
{
    for (uint32_t n = 0; n < count; n++) {
        const contact *c = &f->contacts[n];
        for (int side = 0; side < 2; side++) {
            uint32_t k = c->child[side], p = f->active_parent[k];
            f->contact_load[p] += c->share[side] * c->mass / f->active_mass[p];
            f->contact_load[k] += (1.0f - c->share[side]) * c->mass / f->active_mass[k];
        }
    }
}

/* N of this file's head. A root is carried by the head: nothing weighs on it. */
static float contact_greatest_load(const awt_forest *f, const contact *c)
{
    float greatest = 1.0f;
    for (int side = 0; side < 2; side++) {
        uint32_t k = c->child[side], p = f->active_parent[k];
        float load = f->contact_load[k];
        greatest = load > greatest ? load : greatest;
        load = f->active_parent[p] == p ? 0.0f : f->contact_load[p];
        greatest = load > greatest ? load : greatest;
    }
    return greatest;
}

/* The impulse on the first segment, the opposite on the second, over their nodes by eq. (3). */
static void contact_push(awt_forest *f, uint32_t count, const contact_rule *rule)
{
    for (uint32_t n = 0; n < count; n++) {
        const contact *c = &f->contacts[n];
        float twice = 2.0f * contact_greatest_load(f, c), x = rule->friction * twice, y = rule->repulsion * twice;
        float friction = (x + 0.5f * x * x) / (twice * (1.0f + x + 0.5f * x * x));
        float repulsion = rule->repulsion * rule->per_dt / (1.0f + y);
        vec3 impulse = vec3_scale(c->velocity, friction * c->mass);
        impulse = vec3_mad(impulse, c->overlap, repulsion * c->mass);
        for (int side = 0; side < 2; side++) {
            uint32_t k = c->child[side], p = f->active_parent[k];
            float sign = side == 0 ? 1.0f : -1.0f;
            if (f->active_parent[p] != p) {
                f->active_push[p] = vec3_mad(f->active_push[p], impulse, sign * c->share[side] / f->active_mass[p]);
            }
            f->active_push[k] =
                vec3_mad(f->active_push[k], impulse, sign * (1.0f - c->share[side]) / f->active_mass[k]);
        }
    }
}

void contact_clear(awt_forest *f)
{
    f->contacts_left_out = 0;
    for (uint32_t t = 0; t < f->groom->info.wisp_count[0]; t++) {
        uint32_t first = f->trees[t].first, end = first + tree_capacity(f->groom, t);
        for (uint32_t k = first; k < end; k++) {
            f->active_push[k] = (vec3){0, 0, 0};
        }
    }
}

uint32_t contact_resolve(awt_forest *f, float dt_s)
{
    if (f->params.contact < 0.5f) {
        return 0; /* and no slot has a push: contact_clear */
    }
    const contact_rule rule = contact_rule_of(&f->params, dt_s);
    const float moving_speed2 = 0.25f * rule.least_speed2;
    bool moves = false;
    f->contacts_left_out = 0;
    for (uint32_t t = 0; t < f->groom->info.wisp_count[0]; t++) {
        moves = contact_begin_tree(f, &f->trees[t], moving_speed2) || moves;
    }
    uint32_t moving = moves ? contact_collect(f, true, moving_speed2, 0) : 0;
    if (moving == 0) {
        return 0;
    }
    uint32_t segments = contact_collect(f, false, moving_speed2, moving), found = 0;
    grid_build(&f->grid, f->segment_box, moving, segments);
    for (uint32_t cell = 0; cell < grid_cell_count(&f->grid); cell++) {
        found = contact_search_cell(f, cell, moving, &rule, found);
    }
    uint32_t kept = found < f->contact_capacity ? found : f->contact_capacity;
    f->contacts_left_out = found - kept;
    contact_weigh(f, kept);
    contact_push(f, kept, &rule);
    return found;
}
