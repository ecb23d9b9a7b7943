/* contact.c: friction and repulsion between wisp segments.
 *
 * A segment is a cylinder of its child's radius, or of what room its neighbours leave it at rest (groom/pack.h).
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
#include "sim/rest.h"
#include "sim/touch.h"
#include "sim/tree.h"

/* Pairs in contact per slot that there is room for, and at most. */
enum { CONTACTS_PER_SLOT = 16, CONTACTS_MOST = 4 * 1000 * 1000 };

/* PHYSICS.md says 1.3. Boxes of one cell are compared many at once, so that longer lists in fewer cells are faster: a
 * tenth of a whole step of running long hair; beyond 2.4 nothing changes up to 5. */
#define CONTACT_CELL_EXTENTS 2.4f

/* What all contacts of one sub-step have in common. */
typedef struct contact_rule {
    touch_rule touch;
    float friction;  /* alpha dt */
    float repulsion; /* omega^2 dt^2 */
    float per_dt;
} contact_rule;

void contact_lay_out(awt_forest *f, arena *a, size_t slots)
{
    size_t contacts = slots < CONTACTS_MOST / CONTACTS_PER_SLOT ? slots * CONTACTS_PER_SLOT : CONTACTS_MOST;
    f->active_push = ARENA_PUSH(a, vec3, slots);
    f->contact_nodes = ARENA_PUSH(a, struct contact_node, slots);
    f->contact_load = ARENA_PUSH(a, float, slots);
    f->segments = ARENA_PUSH(a, segment, slots);
    f->ends = ARENA_PUSH(a, segment_ends, slots);
    f->segment_box = ARENA_PUSH(a, grid_box, slots);
    f->contacts = ARENA_PUSH(a, wisp_contact, contacts + GRID_PAIRS); /* a whole call of touch_find past the last */
    f->contact_capacity = (uint32_t)contacts;
    grid_lay_out(&f->grid, a, slots);
}

static contact_rule contact_rule_of(const awt_params *p, float dt_s)
{
    double sine, cosine;
    trig_sin_cos((double)p->contact_angle * (TRIG_PI / 180.0), &sine, &cosine);
    return (contact_rule){{p->relative_motion * p->relative_motion, (float)(cosine * cosine)},
                          p->friction_alpha * dt_s,
                          p->repulsion_omega * p->repulsion_omega * dt_s * dt_s,
                          1.0f / dt_s};
}

static vec3 slot_position(const awt_forest *f, uint32_t slot)
{
    return f->position[f->active_node[slot]];
}

/* ---- segments ---------------------------------------------------------------------------------------------------- */

/* Velocities relative to the turning head, no push and no load. False: all of it is slower than `speed2` allows. */
static bool contact_begin_tree(awt_forest *f, const tree *t, float speed2)
{
    bool moves = false;
    f->contact_nodes[t->first] = (struct contact_node){{0, 0, 0}, 0.0f};
    f->active_push[t->first] = (vec3){0, 0, 0};
    f->contact_load[t->first] = 0.0f;
    for (uint32_t k = t->first + 1; k < t->first + t->count; k++) {
        uint32_t node = f->active_node[k];
        vec3 velocity = vec3_sub(f->velocity[node], vec3_cross(f->head_spin, f->position[node]));
        f->contact_nodes[k] = (struct contact_node){velocity, 1.0f / f->active_mass[k]};
        f->active_push[k] = (vec3){0, 0, 0};
        f->contact_load[k] = 0.0f;
        moves = moves || vec3_dot(velocity, velocity) >= speed2;
    }
    return moves;
}

/* Of the child's radius, as much as there is room for. */
static float segment_radius(const awt_forest *f, uint32_t node)
{
    float radius = f->radius[node], room = f->groom->rest_room[node];
    return room < radius ? radius + (room - radius) * f->params.contact_packing : radius;
}

/* False: not a cylinder in space, or one without width, and it touches nothing (the grid would have no room for it). */
static bool segment_put(awt_forest *f, uint32_t k, uint32_t index)
{
    vec3 a = slot_position(f, f->active_parent[k]), b = slot_position(f, k);
    float radius = segment_radius(f, f->active_node[k]);
    f->segments[index] = (segment){.from = a, .radius = radius, .along = vec3_sub(b, a), .mass = f->active_mass[k]};
    f->ends[index] = (segment_ends){.child = k, .parent = f->active_parent[k]};
    f->segment_box[index] = grid_box_of(a, b, radius);
    return radius > 0.0f && vec3_finite(f->segment_box[index].least) && vec3_finite(f->segment_box[index].most);
}

static bool slot_moves(const awt_forest *f, uint32_t k, float speed2)
{
    vec3 v = f->contact_nodes[k].velocity;
    return vec3_dot(v, v) >= speed2;
}

/* Adds the segments of all trees that move, or that do not, after the first `count`; returns the new count. */
static uint32_t contact_collect(awt_forest *f, bool moving, float speed2, uint32_t count)
{
    for (uint32_t t = 0; t < f->groom->info.wisp_count[0]; t++) {
        const tree *tr = &f->trees[t];
        for (uint32_t k = tr->first + 1; k < tr->first + tr->count; k++) {
            bool moves = slot_moves(f, k, speed2) || slot_moves(f, f->active_parent[k], speed2);
            count += moves == moving && segment_put(f, k, count);
        }
    }
    return count;
}

/* ---- pairs ------------------------------------------------------------------------------------------------------- */

/* Adds each contact's part of the loads of its four nodes. */
static void contact_weigh(awt_forest *f, const wisp_contact *contacts, uint32_t count)
{
    const struct contact_node *node = f->contact_nodes;
    for (uint32_t n = 0; n < count; n++) {
        const wisp_contact *c = &contacts[n];
        for (int side = 0; side < 2; side++) {
            segment_ends of = c->of[side];
            f->contact_load[of.parent] += (1.0f - c->on[side]) * c->mass * node[of.parent].inverse_mass;
            f->contact_load[of.child] += c->on[side] * c->mass * node[of.child].inverse_mass;
        }
    }
}

typedef struct contact_search {
    awt_forest *forest;
    const touch_rule *rule;
    uint32_t found, kept;
} contact_search;

static void contact_take(void *context, const grid_pair *pairs, uint32_t count)
{
    contact_search *search = context;
    awt_forest *f = search->forest;
    uint32_t found = touch_find(f, search->rule, pairs, count, f->contacts + search->kept);
    uint32_t room = f->contact_capacity - search->kept, kept = found < room ? found : room;
    contact_weigh(f, f->contacts + search->kept, kept);
    search->found += found;
    search->kept += kept;
}

/* A sleeping tree that something rubs against wakes. */
static void contact_wake(awt_forest *f, uint32_t count)
{
    const float speed = rest_waking_speed(f);
    for (uint32_t n = 0; n < count; n++) {
        const wisp_contact *c = &f->contacts[n];
        if (vec3_dot(c->velocity, c->velocity) >= speed * speed) {
            rest_wake(f, c->of[0].child);
            rest_wake(f, c->of[1].child);
        }
    }
}

/* ---- response ---------------------------------------------------------------------------------------------------- */

/* N of this file's head. */
static float contact_greatest_load(const awt_forest *f, const wisp_contact *c)
{
    const float *load = f->contact_load;
    float first = grid_most(load[c->of[0].child], load[c->of[0].parent]);
    float second = grid_most(load[c->of[1].child], load[c->of[1].parent]);
    return grid_most(grid_most(first, second), 1.0f);
}

/* The impulse on the first segment, the opposite on the second, over their nodes by eq. (3). */
static void contact_push(awt_forest *f, uint32_t count, const contact_rule *rule)
{
    const struct contact_node *node = f->contact_nodes;
    for (uint32_t n = 0; n < count; n++) {
        const wisp_contact *c = &f->contacts[n];
        float twice = 2.0f * contact_greatest_load(f, c), x = rule->friction * twice, y = rule->repulsion * twice;
        float friction = (x + 0.5f * x * x) / (twice * (1.0f + x + 0.5f * x * x));
        float repulsion = rule->repulsion * rule->per_dt / (1.0f + y);
        vec3 impulse = vec3_scale(c->velocity, friction * c->mass);
        impulse = vec3_mad(impulse, c->overlap, repulsion * c->mass);
        for (int side = 0; side < 2; side++) {
            segment_ends of = c->of[side];
            vec3 *parent = &f->active_push[of.parent], *child = &f->active_push[of.child];
            float sign = side == 0 ? 1.0f : -1.0f;
            *parent = vec3_mad(*parent, impulse, sign * (1.0f - c->on[side]) * node[of.parent].inverse_mass);
            *child = vec3_mad(*child, impulse, sign * c->on[side] * node[of.child].inverse_mass);
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
    const float moving_speed2 = 0.25f * rule.touch.least_speed2;
    bool moves = false, sleeps = false;
    f->contacts_left_out = 0;
    for (uint32_t t = 0; t < f->groom->info.wisp_count[0]; t++) {
        moves = contact_begin_tree(f, &f->trees[t], moving_speed2) || moves;
        sleeps = sleeps || f->trees[t].asleep;
    }
    uint32_t moving = moves ? contact_collect(f, true, moving_speed2, 0) : 0;
    if (moving == 0) {
        return 0;
    }
    contact_search search = {.forest = f, .rule = &rule.touch};
    grid_build(&f->grid, f->segment_box, moving, contact_collect(f, false, moving_speed2, moving),
               CONTACT_CELL_EXTENTS);
    grid_visit_pairs(&f->grid, f->segment_box, moving, contact_take, &search);
    f->contacts_left_out = search.found - search.kept;
    if (sleeps) {
        contact_wake(f, search.kept);
    }
    contact_push(f, search.kept, &rule);
    return search.found;
}
