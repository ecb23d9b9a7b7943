/* joint.c: see joint.h.
 *
 * The style spring of a node holds it where its parent's segment, carried rigidly with the arm between them at rest,
 * would have it. It acts on both ends: what turns the node back turns the parent's segment forward. (Acting on the node
 * alone it is no force but a source of energy: hair without gravity then shook itself to pieces.) The damper acts on
 * the velocity relative to the turning segment: a wisp that swings as a whole is not damped.
 *
 * Each joint has the stiffness that what hangs on it asks for: the first moment of its sub-tree, so that gravity bends
 * every joint of a style alike, whether many nodes hang on it or few; each spring link has that of the mass that hangs
 * on it.
 *
 * Backward Euler: wanted are the velocities v of least sum over nodes of m |v - v0|^2 / 2 and over springs of c |r +
 * e|^2 / 2. For a style spring r = v - (1 + A) v_parent + A v_above - (twist) is the rate of its stretch, A the way in
 * which the arm's end follows the ends of the parent's segment, and e what remains of the stretch; for a link r is the
 * rate of its length, and its tension resists turning. A joint ties three generations together, and still the graph is
 * a tree: elimination from tip to root (each node leaves a term on its parent and the one above) and substitution from
 * root to tip is exact and O(n), for any stiffness. */
#include "sim/joint.h"

#define JOINT_LEAST_LENGTH_M 1e-3f

/* One node's terms: its style spring, and its link where links are springs. */
typedef struct joint {
    float weight;                 /* c */
    mat3 arm;                     /* A */
    vec3 bias;                    /* e - twist */
    float link_weight, link_bias; /* along the link */
    float link_turning;           /* across it: its tension */
} joint;

static mat3 mat3_scaled(mat3 a, float s)
{
    return (mat3){vec3_scale(a.x, s), vec3_scale(a.y, s), vec3_scale(a.z, s)};
}

static mat3 mat3_plus_one(mat3 a)
{
    a.x.x += 1.0f, a.y.y += 1.0f, a.z.z += 1.0f;
    return a;
}

/* a + s A^T B */
static inline mat3 mat3_add_product(mat3 a, mat3 A, mat3 B, float s)
{
    return (mat3){vec3_mad(a.x, mat3_apply_transposed(A, B.x), s), vec3_mad(a.y, mat3_apply_transposed(A, B.y), s),
                  vec3_mad(a.z, mat3_apply_transposed(A, B.z), s)};
}

/* A segment of direction `along` turns by along x d / length when its ends move by d against each other; so the
 * end of `arm` moves by ((along . arm) d - along (arm . d)) / length. */
static mat3 arm_matrix(vec3 along, vec3 arm, float inverse_length)
{
    float a = vec3_dot(along, arm) * inverse_length;
    vec3 w = vec3_scale(arm, -inverse_length);
    mat3 m = {vec3_scale(along, w.x), vec3_scale(along, w.y), vec3_scale(along, w.z)};
    m.x.x += a, m.y.y += a, m.z.z += a;
    return m;
}

static joint joint_style(const awt_forest *f, const tree *t, uint32_t k, float stiffness, float damping, float dt_s)
{
    uint32_t p = f->active_parent[k];
    vec3 x = f->position[f->active_node[k]], x_parent = f->position[f->active_node[p]];
    vec3 arm = mat3_apply(f->turn[p], f->active_style[k]), along = f->tangent[p];
    float strength = damping + dt_s * stiffness;
    joint j = {.weight = f->active_stiffness[k] * dt_s * strength};
    vec3 stretch = vec3_sub(vec3_sub(x, x_parent), arm);
    vec3 turning; /* by the head's own spin: all of it at the root, elsewhere that along the segment */
    if (p == t->first) {
        turning = vec3_cross(f->head_spin, arm);
    } else {
        float length = vec3_distance(x_parent, f->position[f->active_node[f->active_parent[p]]]);
        j.arm = arm_matrix(along, arm, 1.0f / (length > JOINT_LEAST_LENGTH_M ? length : JOINT_LEAST_LENGTH_M));
        turning = vec3_scale(vec3_cross(along, arm), vec3_dot(f->head_spin, along));
    }
    j.bias = vec3_sub(vec3_scale(stretch, strength > 0.0f ? stiffness / strength : 0.0f), turning);
    return j;
}

/* A viscous spring along the link, and, while it pulls, the resistance of its tension against being turned. */
static void joint_link(const awt_forest *f, uint32_t k, float dt_s, joint *j)
{
    const awt_params *p = &f->params;
    uint32_t node = f->active_node[k];
    float stiffness = p->link_omega * p->link_omega, damping = 2.0f * p->link_damping * p->link_omega;
    float strength = damping + dt_s * stiffness, mass = f->active_hung_mass[k];
    float length = vec3_distance(f->position[node], f->position[f->active_node[f->active_parent[k]]]);
    float stretch = length - f->link_length[node];
    j->link_weight = mass * dt_s * strength;
    j->link_bias = stretch * stiffness / strength;
    float tension = stretch > 0.0f ? mass * stiffness * stretch : 0.0f;
    j->link_turning = dt_s * dt_s * tension / (length > JOINT_LEAST_LENGTH_M ? length : JOINT_LEAST_LENGTH_M);
}

/* Each node's own inertia. */
static void joint_begin(awt_forest *f, const tree *t)
{
    for (uint32_t k = t->first; k < t->first + t->count; k++) {
        f->joint_mass[k] = sym3_of_scalar(f->active_mass[k]);
        f->joint_up[k] = (mat3){{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
        f->joint_push[k] = vec3_scale(f->next[k], f->active_mass[k]);
    }
}

/* Adds slot k's spring link to its two nodes. */
static void joint_add_link(awt_forest *f, uint32_t k, const joint *j)
{
    uint32_t p = f->active_parent[k];
    vec3 along = f->tangent[k];
    float across = j->link_turning, more = j->link_weight - across;
    sym3 link = sym3_add_outer(sym3_of_scalar(across), along, more);
    f->joint_mass[k] = sym3_sum(f->joint_mass[k], link);
    f->joint_mass[p] = sym3_sum(f->joint_mass[p], link);
    mat3 *up = &f->joint_up[k];
    up->x = vec3_sub(up->x, vec3_make(link.xx, link.xy, link.xz));
    up->y = vec3_sub(up->y, vec3_make(link.xy, link.yy, link.yz));
    up->z = vec3_sub(up->z, vec3_make(link.xz, link.yz, link.zz));
    float pull = j->link_weight * j->link_bias;
    f->joint_push[k] = vec3_mad(f->joint_push[k], along, -pull);
    f->joint_push[p] = vec3_mad(f->joint_push[p], along, pull);
}

/* Adds slot k's joint to the three nodes that it ties, then takes node k out of the system:
 * v_k = free - by_parent v_parent - by_above v_above. Nothing is left on the root: its velocity is given. */
static void joint_eliminate(awt_forest *f, const tree *t, uint32_t k, const joint *j)
{
    uint32_t p = f->active_parent[k], above = f->active_parent[p];
    float c = j->weight;
    mat3 one_arm = mat3_plus_one(j->arm);
    sym3 own = f->joint_mass[k];
    own.xx += c, own.yy += c, own.zz += c;
    vec3 push = vec3_mad(f->joint_push[k], j->bias, -c);
    mat3 to_parent = {vec3_mad(f->joint_up[k].x, one_arm.x, -c), vec3_mad(f->joint_up[k].y, one_arm.y, -c),
                      vec3_mad(f->joint_up[k].z, one_arm.z, -c)};
    mat3 to_above = mat3_scaled(j->arm, c);

    sym3 inverse = sym3_inverse(own);
    vec3 free = sym3_apply(inverse, push);
    mat3 by_parent = sym3_mul(inverse, to_parent);
    f->joint_push[k] = free;
    f->joint_up[k] = by_parent;
    f->joint_far[k] = (mat3){{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}; /* a root has no arm */
    if (p == t->first) {
        return;
    }
    mat3 by_above = sym3_mul(inverse, to_above);
    f->joint_far[k] = by_above;

    sym3 parent_mass = sym3_add_product(f->joint_mass[p], one_arm, one_arm, c);
    f->joint_mass[p] = sym3_add_product(parent_mass, to_parent, by_parent, -1.0f);
    mat3 parent_up = mat3_add_product(f->joint_up[p], one_arm, j->arm, -c);
    f->joint_up[p] = mat3_add_product(parent_up, to_parent, by_above, -1.0f);
    vec3 parent_push = vec3_mad(f->joint_push[p], mat3_apply_transposed(one_arm, j->bias), c);
    f->joint_push[p] = vec3_sub(parent_push, mat3_apply_transposed(to_parent, free));
    if (above == t->first) {
        return;
    }
    sym3 above_mass = sym3_add_product(f->joint_mass[above], j->arm, j->arm, c);
    f->joint_mass[above] = sym3_add_product(above_mass, to_above, by_above, -1.0f);
    vec3 above_push = vec3_mad(f->joint_push[above], mat3_apply_transposed(j->arm, j->bias), -c);
    f->joint_push[above] = vec3_sub(above_push, mat3_apply_transposed(to_above, free));
}

void joint_resolve(awt_forest *f, const tree *t, float dt_s)
{
    bool links = joint_links_are_springs(f);
    float stiffness = f->params.style_omega * f->params.style_omega;
    float damping = 2.0f * f->params.style_damping * f->params.style_omega;
    if (stiffness <= 0.0f && !links) {
        return;
    }
    joint_begin(f, t);
    for (uint32_t k = t->first + t->count - 1; k > t->first; k--) {
        joint j = joint_style(f, t, k, stiffness, damping, dt_s);
        if (links) {
            joint_link(f, k, dt_s, &j);
            joint_add_link(f, k, &j);
        }
        joint_eliminate(f, t, k, &j);
    }
    for (uint32_t k = t->first + 1; k < t->first + t->count; k++) {
        uint32_t p = f->active_parent[k], above = f->active_parent[p];
        vec3 given = vec3_add(mat3_apply(f->joint_up[k], f->next[p]), mat3_apply(f->joint_far[k], f->next[above]));
        f->next[k] = vec3_sub(f->joint_push[k], given);
    }
}

/* At rest a link carries, along itself, its node's weight and what its children's links carry; the rest falls to the
 * style (params.rest_gravity), so that the rest shape is in equilibrium as it was drawn: on an upright head, where down
 * is -Y. It is a dead load in the head frame: a load that turned with the segment would feed energy into hair that
 * hangs over (long hair then never came to rest). */
static void measure_preload(awt_forest *f, const tree *t)
{
    vec3 gravity = {0, -vec3_length(vec3_make(f->params.gravity_x, f->params.gravity_y, f->params.gravity_z)), 0};
    vec3 *load = f->joint_push; /* working memory, free between steps */
    for (uint32_t k = t->first; k < t->first + t->count; k++) {
        load[k] = vec3_scale(gravity, f->active_mass[k]);
    }
    for (uint32_t k = t->first + t->count - 1; k > t->first; k--) {
        vec3 along = f->active_rest_tangent[k];
        vec3 carried = vec3_scale(along, vec3_dot(along, load[k]));
        vec3 left = vec3_sub(load[k], carried);
        f->active_preload[k] = vec3_scale(left, -f->params.rest_gravity / f->active_mass[k]);
        load[f->active_parent[k]] = vec3_add(load[f->active_parent[k]], carried);
    }
}

/* Mass of each sub-tree, and its first moment about its joint over its first link's length: both in mass units. */
static void measure_stiffness(awt_forest *f, const tree *t)
{
    float *hung_mass = f->active_hung_mass,
          *moment = f->link_gap; /* the latter is working memory, free between steps */
    for (uint32_t k = t->first; k < t->first + t->count; k++) {
        hung_mass[k] = f->active_mass[k];
        moment[k] = 0.0f;
    }
    for (uint32_t k = t->first + t->count - 1; k > t->first; k--) {
        float length = f->active_rest_length[k];
        length = length > JOINT_LEAST_LENGTH_M ? length : JOINT_LEAST_LENGTH_M;
        moment[k] += hung_mass[k] * length;
        f->active_stiffness[k] = moment[k] / length;
        hung_mass[f->active_parent[k]] += hung_mass[k];
        moment[f->active_parent[k]] += moment[k];
    }
}

void joint_measure(awt_forest *f, const tree *t)
{
    measure_preload(f, t);
    measure_stiffness(f, t);
}
