/* obstacle.c: see obstacle.h.
 *
 * No node is held farther out than it rests: a sphere is only roughly a head, and hair that its file drew inside of it
 * must lie at rest as it was drawn. So a node's own surface is the lesser of the obstacle's and its rest distance. */
#include "sim/obstacle.h"

#include "base/error.h"
#include "sim/joint.h"

#include <string.h>

enum { COLLIDER_DEFAULTS = 6 };

/* A root farther than this many head radii from the head's centre does not grow on the head. */
#define SCALP_HEAD_RADII 1.5f

uint32_t awt_colliders_default(double head_radius_m, awt_collider out[AWT_MAX_COLLIDERS])
{
    static const struct {
        awt_frame frame;
        float a[3], b[3], radius_a, radius_b;
    } person[COLLIDER_DEFAULTS] = {
        {AWT_FRAME_HEAD, {0, 0, 0}, {0, 0, 0}, 0.095f, 0.095f},                                    /* cranium */
        {AWT_FRAME_HEAD, {0, -0.030f, 0.035f}, {0, -0.075f, 0.045f}, 0.070f, 0.045f},              /* face and jaw */
        {AWT_FRAME_BODY, {0, -0.090f, -0.015f}, {0, -0.200f, -0.020f}, 0.055f, 0.055f},            /* neck */
        {AWT_FRAME_BODY, {-0.160f, -0.270f, -0.030f}, {0.160f, -0.270f, -0.030f}, 0.070f, 0.070f}, /* shoulders */
        {AWT_FRAME_BODY, {0, -0.360f, -0.020f}, {0, -0.620f, -0.020f}, 0.130f, 0.130f},            /* chest and back */
        {AWT_FRAME_BODY, {0, -0.250f, -0.025f}, {0, -0.360f, -0.020f}, 0.080f, 0.130f}, /* between neck and chest */
    };
    float s = (float)(head_radius_m / AWT_HEAD_RADIUS_M);
    for (uint32_t k = 0; k < COLLIDER_DEFAULTS; k++) {
        out[k] = (awt_collider){.id = k + 1,
                                .frame = person[k].frame,
                                .radius_a = person[k].radius_a * s,
                                .radius_b = person[k].radius_b * s};
        for (int axis = 0; axis < 3; axis++) {
            out[k].a[axis] = person[k].a[axis] * s;
            out[k].b[axis] = person[k].b[axis] * s;
        }
    }
    return COLLIDER_DEFAULTS;
}

/* Does the groom grow on the head alone, but for strays? */
static bool grows_on_the_head(const awt_groom *groom)
{
    const float scalp = SCALP_HEAD_RADII * (float)groom->info.head_radius_m;
    uint32_t elsewhere = 0;
    for (uint32_t g = groom_finest_first(groom); g < groom->gc_count; g++) {
        elsewhere += vec3_length(groom->rest_position[g * groom->info.sections]) > scalp;
    }
    return elsewhere <= (groom->gc_count - groom_finest_first(groom)) / 20;
}

uint32_t obstacle_defaults(const awt_groom *groom, awt_collider out[AWT_MAX_COLLIDERS])
{
    awt_collider person[AWT_MAX_COLLIDERS] = {0};
    uint32_t count = awt_colliders_default(groom->info.head_radius_m, person), taken = 0;
    bool with_body = grows_on_the_head(groom);
    for (uint32_t k = 0; k < count; k++) {
        if (with_body || person[k].frame == AWT_FRAME_HEAD) {
            out[taken++] = person[k];
        }
    }
    return taken;
}

uint32_t awt_forest_colliders(const awt_forest *f, awt_collider out[AWT_MAX_COLLIDERS])
{
    memcpy(out, f->colliders, f->collider_count * sizeof *out);
    return f->collider_count;
}

awt_status obstacle_check(const awt_collider *colliders, uint32_t count, awt_error *error)
{
    if (count > AWT_MAX_COLLIDERS) {
        return error_set(error, AWT_LIMIT, "%u obstacles; %d are the most", count, AWT_MAX_COLLIDERS);
    }
    for (uint32_t k = 0; k < count; k++) {
        const awt_collider *c = &colliders[k];
        bool radii = c->radius_a > 0 && c->radius_a <= 100 && c->radius_b > 0 && c->radius_b <= 100;
        bool centres = true;
        for (int axis = 0; axis < 3; axis++) {
            centres = centres && fabsf(c->a[axis]) <= 1000 && fabsf(c->b[axis]) <= 1000;
        }
        if (!radii || !centres) {
            return error_set(error, AWT_BAD_VALUE, "obstacle %u: radii go from 0 to 100 m, centres to 1000 m", c->id);
        }
        if (c->frame != AWT_FRAME_HEAD && c->frame != AWT_FRAME_BODY && c->frame != AWT_FRAME_OWN) {
            return error_set(error, AWT_BAD_VALUE, "obstacle %u is tied to no known frame", c->id);
        }
        for (uint32_t other = 0; other < k; other++) {
            if (colliders[other].id == c->id) {
                return error_set(error, AWT_BAD_VALUE, "two obstacles have the id %u", c->id);
            }
        }
    }
    return AWT_OK;
}

static uint32_t obstacle_track(const awt_forest *f, uint32_t k)
{
    if (f->colliders[k].frame != AWT_FRAME_OWN) {
        return f->colliders[k].frame == AWT_FRAME_HEAD ? TRACK_HEAD : TRACK_BODY;
    }
    uint32_t own = 0;
    while (f->track.own_id[own] != f->colliders[k].id) {
        own++;
    }
    return TRACK_OWN + own;
}

/* The sphere about both ends, a little wider than rounding asks for. */
static void obstacle_bound(obstacle *o)
{
    float greatest = o->radius_a > o->radius_b ? o->radius_a : o->radius_b;
    o->middle = vec3_lerp(o->a, o->b, 0.5f);
    o->reach = (0.5f * vec3_distance(o->a, o->b) + greatest) * 1.001f;
}

void obstacle_place(awt_forest *f, const track_pose *before, float dt_s)
{
    dvec3 head = f->pose[TRACK_HEAD].position;
    for (uint32_t k = 0; k < f->collider_count; k++) {
        const awt_collider *c = &f->colliders[k];
        uint32_t which = obstacle_track(f, k);
        const track_pose *old = &before[which], *now = &f->pose[which];
        dvec3 velocity =
            dvec3_sub(dvec3_scale(dvec3_sub(now->position, old->position), 1.0 / (double)dt_s), f->frame_velocity);
        vec3 origin = vec3_of_dvec3(dvec3_sub(now->position, head));
        quat q = quat_of_dquat(now->orientation);
        vec3 a = {c->a[0], c->a[1], c->a[2]}, b = {c->b[0], c->b[1], c->b[2]};
        f->obstacles[k] = (obstacle){
            .a = vec3_add(origin, quat_rotate(q, a)),
            .b = vec3_add(origin, quat_rotate(q, b)),
            .radius_a = c->radius_a,
            .radius_b = c->radius_b,
            .velocity = vec3_of_dvec3(velocity),
            .spin = track_spin(old->orientation, now->orientation, (double)dt_s),
            .origin = origin,
            .rest_a = a,
            .rest_b = b,
            .rests = c->frame != AWT_FRAME_OWN,
        };
        obstacle_bound(&f->obstacles[k]);
    }
}

/* Share along a..b of the point nearest to x. */
static float axis_share(vec3 a, vec3 b, vec3 x)
{
    vec3 axis = vec3_sub(b, a);
    float length2 = vec3_dot(axis, axis);
    if (length2 <= 0.0f) {
        return 0.0f;
    }
    float share = vec3_dot(vec3_sub(x, a), axis) / length2;
    return share < 0.0f ? 0.0f : share > 1.0f ? 1.0f : share;
}

/* How far from the axis at x this node is kept. */
static float surface_radius(const obstacle *o, float share, vec3 rest)
{
    float radius = o->radius_a + (o->radius_b - o->radius_a) * share;
    if (o->rests) {
        vec3 centre = vec3_lerp(o->rest_a, o->rest_b, axis_share(o->rest_a, o->rest_b, rest));
        float rest_distance = vec3_distance(rest, centre);
        radius = rest_distance < radius ? rest_distance : radius;
    }
    return radius;
}

/* The point at `length` from `parent` and `radius` from `centre` that is nearest to x. False: there is none. */
static bool turn_onto(vec3 parent, float length, vec3 centre, float radius, vec3 *x)
{
    vec3 between = vec3_sub(centre, parent);
    float distance = vec3_length(between);
    if (distance < 1e-9f) {
        return false;
    }
    vec3 towards = vec3_scale(between, 1.0f / distance);
    float along = (length * length + distance * distance - radius * radius) / (2.0f * distance);
    float across2 = length * length - along * along;
    if (across2 < 0.0f) {
        return false;
    }
    vec3 arm = vec3_sub(*x, parent);
    vec3 sideways = vec3_unit(vec3_mad(arm, towards, -vec3_dot(arm, towards)), vec3_orthogonal(towards));
    vec3 turned = vec3_mad(vec3_scale(towards, along), sideways, sqrtf(across2));
    *x = vec3_mad(parent, vec3_unit(turned, towards), length);
    return true;
}

/* Keeps slot k out of one obstacle. False: the link kept it inside. */
static bool obstacle_keep_out(awt_forest *f, uint32_t k, const obstacle *o, vec3 parent, float length, float dt_s)
{
    vec3 apart = vec3_sub(f->next[k], o->middle);
    if (vec3_dot(apart, apart) >= o->reach * o->reach) {
        return true;
    }
    float share = axis_share(o->a, o->b, f->next[k]);
    vec3 centre = vec3_lerp(o->a, o->b, share);
    float greatest = o->radius_a > o->radius_b ? o->radius_a : o->radius_b;
    vec3 away = vec3_sub(f->next[k], centre);
    float distance2 = vec3_dot(away, away);
    if (distance2 >= greatest * greatest) {
        return true;
    }
    float radius = surface_radius(o, share, f->groom->rest_position[f->active_node[k]]);
    if (distance2 >= radius * radius) {
        return true;
    }
    if (!turn_onto(parent, length, centre, radius, &f->next[k])) {
        return false;
    }
    const uint32_t node = f->active_node[k];
    vec3 arm = vec3_sub(f->next[k], o->origin);
    vec3 surface = vec3_add(o->velocity, vec3_cross(o->spin, arm));
    if (f->params.obstacle_slip > 0.0f) {
        vec3 slip = vec3_sub(vec3_scale(vec3_sub(f->next[k], f->position[node]), 1.0f / dt_s), surface);
        vec3 normal = vec3_unit(vec3_sub(f->next[k], centre), (vec3){0, 0, 0});
        slip = vec3_mad(slip, normal, -vec3_dot(slip, normal));
        surface = vec3_mad(surface, slip, f->params.obstacle_slip);
    }
    f->velocity[node] = surface;
    f->touching[k] = true;
    return true;
}

/* The length that slot k's link takes: a rigid one its target, a spring its own within the strain limit. */
static float link_length_allowed(const awt_forest *f, uint32_t k, float length)
{
    float target = f->link_length[f->active_node[k]];
    if (!joint_links_are_springs(f)) {
        return target;
    }
    float least = target * (1.0f - f->params.strain_limit), greatest = target * (1.0f + f->params.strain_limit);
    return length < least ? least : length > greatest ? greatest : length;
}

uint32_t obstacle_settle(awt_forest *f, const tree *t, float dt_s)
{
    uint32_t unreached = 0;
    for (uint32_t k = t->first + 1; k < t->first + t->count; k++) {
        vec3 parent = f->next[f->active_parent[k]];
        vec3 link = vec3_sub(f->next[k], parent), along = vec3_unit(link, f->tangent[k]);
        float length = link_length_allowed(f, k, vec3_length(link));
        f->next[k] = vec3_mad(parent, along, length);
        f->touching[k] = false;
        bool reached = true;
        for (uint32_t o = 0; o < f->collider_count; o++) {
            reached = obstacle_keep_out(f, k, &f->obstacles[o], parent, length, dt_s) && reached;
        }
        unreached += reached ? 0 : 1;
    }
    return unreached;
}
