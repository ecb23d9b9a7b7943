/* dynamics.c: see dynamics.h. Everything that could be stiff (style, drag) is implicit: no value within the parameters'
 * ranges can blow up. */
#include "sim/dynamics.h"

#include "sim/relax.h"
#include "sim/rest.h"
#include "sim/joint.h"

#include <string.h>

/* The turn of every segment from rest to now, and its tangent. */
static void dynamics_turns(awt_forest *f, const tree *t)
{
    f->turn[t->first] = f->head;
    f->tangent[t->first] = mat3_apply(f->head, f->active_rest_tangent[t->first]);
    quat head = quat_of_dquat(f->pose[TRACK_HEAD].orientation);
    for (uint32_t k = t->first + 1; k < t->first + t->count; k++) {
        vec3 x = f->position[f->active_node[k]], parent = f->position[f->active_node[f->active_parent[k]]];
        vec3 along = vec3_unit(vec3_sub(x, parent), f->tangent[f->active_parent[k]]);
        f->tangent[k] = along;
        quat bend = quat_between(f->active_rest_tangent[k], state_to_head(f, along));
        f->turn[k] = mat3_of_quat(quat_mul(head, bend));
    }
}

/* The velocities with which the step begins, contacts included, in f->next; the root's is the head's. */
static void dynamics_begin(awt_forest *f, const tree *t, float dt_s)
{
    uint32_t root = f->active_node[t->first];
    vec3 root_end = mat3_apply(f->head, f->groom->rest_position[root]);
    f->next[t->first] = vec3_scale(vec3_sub(root_end, f->position[root]), 1.0f / dt_s);
    for (uint32_t k = t->first + 1; k < t->first + t->count; k++) {
        f->next[k] = vec3_add(f->velocity[f->active_node[k]], f->active_push[k]);
    }
}

/* Adds gravity, the style's share of it, the moving frame's inertia, and drag. */
static void dynamics_load(awt_forest *f, const tree *t, float dt_s)
{
    const awt_params *p = &f->params;
    vec3 gravity = {p->gravity_x, p->gravity_y, p->gravity_z};
    vec3 calm = vec3_sub(gravity, f->frame_acceleration), outside = vec3_mad(calm, f->wind.mean, p->drag);
    float slowing = 1.0f / (1.0f + dt_s * (p->drag + rest_drag(f)));
    for (uint32_t k = t->first + 1; k < t->first + t->count; k++) {
        vec3 preload = mat3_apply(f->head, f->active_preload[k]);
        if (f->wind.gusts) {
            outside = vec3_mad(calm, wind_at(&f->wind, f->position[f->active_node[k]]), p->drag);
        }
        f->next[k] = vec3_scale(vec3_mad(f->next[k], vec3_add(outside, preload), dt_s), slowing);
    }
}

static void dynamics_drift(awt_forest *f, const tree *t, float dt_s)
{
    for (uint32_t k = t->first; k < t->first + t->count; k++) {
        f->next[k] = vec3_mad(f->position[f->active_node[k]], f->next[k], dt_s);
    }
}

void dynamics_predict(awt_forest *f, const tree *t, float dt_s)
{
    dynamics_turns(f, t);
    dynamics_begin(f, t, dt_s);
    if (joint_links_are_springs(f)) { /* springs have to see the load that they carry */
        dynamics_load(f, t, dt_s);
        joint_resolve(f, t, dt_s);
    } else { /* and must not see a load that rigid links are about to take away */
        joint_resolve(f, t, dt_s);
        dynamics_load(f, t, dt_s);
    }
    dynamics_drift(f, t, dt_s);
}

uint32_t dynamics_finish(awt_forest *f, const tree *t, float dt_s)
{
    const awt_params *p = &f->params;
    float filter = relaxation_share(dt_s, p->acceleration_tau);
    float relax = relaxation_share(dt_s, p->length_relaxation);
    float limit2 = p->speed_limit * p->speed_limit;
    uint32_t clamped = 0;
    for (uint32_t k = t->first; k < t->first + t->count; k++) {
        uint32_t node = f->active_node[k];
        vec3 before = f->velocity[node];
        vec3 velocity =
            k > t->first && f->touching[k] ? before : vec3_scale(vec3_sub(f->next[k], f->position[node]), 1.0f / dt_s);
        float speed2 = vec3_dot(velocity, velocity);
        if (speed2 > limit2) {
            velocity = vec3_scale(velocity, p->speed_limit / sqrtf(speed2));
            clamped++;
        }
        vec3 acceleration = vec3_mad(f->frame_acceleration, vec3_sub(velocity, before), 1.0f / dt_s);
        f->acceleration[node] = vec3_lerp(f->acceleration[node], acceleration, filter);
        f->velocity[node] = velocity;
        f->position[node] = f->next[k];
        f->link_length[node] += (f->active_rest_length[k] - f->link_length[node]) * relax;
    }
    return clamped;
}

/* ---- what may split a wisp besides its acceleration (AWT §5.3) --------------------------------------------------- */

static bool dynamics_agitates(const awt_params *p)
{
    return p->split_contact > 0.0f || p->split_wind > 0.0f;
}

void dynamics_agitate(awt_forest *f, const tree *t, float dt_s)
{
    const awt_params *p = &f->params;
    if (!dynamics_agitates(p)) {
        return;
    }
    float filter = relaxation_share(dt_s, p->acceleration_tau), by_contact = p->split_contact / dt_s;
    float by_air = p->split_wind * p->drag;
    for (uint32_t k = t->first + 1; k < t->first + t->count; k++) {
        uint32_t node = f->active_node[k];
        vec3 gust = vec3_scale(f->wind.mean, wind_gust_at(&f->wind, f->position[node]));
        float agitation = by_contact * vec3_length(f->active_push[k]) + by_air * vec3_distance(gust, f->velocity[node]);
        f->agitation[node] += (agitation - f->agitation[node]) * filter;
    }
}

void dynamics_calm(awt_forest *f)
{
    size_t nodes = (size_t)f->groom->gc_count * f->groom->info.sections;
    if (!dynamics_agitates(&f->params)) {
        memset(f->agitation, 0, nodes * sizeof *f->agitation);
    }
}
