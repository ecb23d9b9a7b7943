/* rest.c: see rest.h.
 *
 * A tree is quiet while no node of it moves faster than a centimetre a second against the head and the world is still
 * (the longer it has been still, the less is asked: hair that creeps back over a shoulder would take a minute); when it
 * has been quiet for half a second and is merged to its coarsest nodes, it sleeps: its velocities become exactly zero
 * and only the head carries it. Its offsets go on relaxing until they have arrived, so that it sleeps in style. */
#include "sim/rest.h"

#include "sim/embed.h"

#define REST_SPEED_M_S 0.01f
#define REST_SPEED_MOST_M_S 0.05f
#define REST_PATIENCE_S 1.0f        /* from here on more speed is quiet */
#define REST_HEAD_SPIN 0.02f        /* rad/s */
#define REST_HEAD_ACCELERATION 0.1f /* m/s2 */
#define REST_OBSTACLE_SPEED_M_S 0.002f
/* 1 - |q . q0| of a head that has turned by 0.01 rad, however slowly, since it last moved. */
#define REST_TURNED 1.25e-5
#define REST_DRAG_AFTER_S 1.5f
#define REST_DRAG_MOST 300.0f

static bool obstacles_are_still(const awt_forest *f)
{
    for (uint32_t k = 0; k < f->collider_count; k++) {
        const obstacle *o = &f->obstacles[k];
        vec3 slip = vec3_sub(o->spin, f->head_spin);
        if (vec3_length(o->velocity) > REST_OBSTACLE_SPEED_M_S || vec3_length(slip) > REST_HEAD_SPIN) {
            return false;
        }
    }
    return true;
}

/* Speed below which a node is quiet. */
static float quiet_speed(const awt_forest *f)
{
    float speed = REST_SPEED_M_S * f->still_s / REST_PATIENCE_S;
    return speed < REST_SPEED_M_S ? REST_SPEED_M_S : speed > REST_SPEED_MOST_M_S ? REST_SPEED_MOST_M_S : speed;
}

bool rest_world_is_still(awt_forest *f, float dt_s)
{
    dquat now = f->pose[TRACK_HEAD].orientation;
    bool still =
        vec3_length(f->head_spin) < REST_HEAD_SPIN && vec3_length(f->frame_acceleration) < REST_HEAD_ACCELERATION &&
        fabs(dquat_dot(now, f->still_orientation)) > 1.0 - REST_TURNED && !f->wind.gusts && obstacles_are_still(f);
    if (!still) {
        f->still_orientation = now;
    }
    f->still_s = still ? f->still_s + dt_s : 0.0f;
    return still;
}

float rest_drag(const awt_forest *f)
{
    float drag = (f->still_s - REST_DRAG_AFTER_S) * f->params.settling;
    return drag < 0.0f ? 0.0f : drag > REST_DRAG_MOST ? REST_DRAG_MOST : drag;
}

void rest_carry(awt_forest *f, dquat from, dquat to, bool sleepers_only)
{
    mat3 turn = mat3_of_quat(quat_of_dquat(dquat_unit(dquat_mul(to, dquat_conjugate(from)))));
    for (uint32_t t = 0; t < f->groom->info.wisp_count[0]; t++) {
        const tree *tr = &f->trees[t];
        if (sleepers_only && !tr->asleep) {
            continue;
        }
        for (uint32_t k = tr->first; k < tr->first + tr->count; k++) {
            uint32_t node = f->active_node[k];
            f->position[node] = mat3_apply(turn, f->position[node]);
            f->velocity[node] = mat3_apply(turn, f->velocity[node]);
            f->acceleration[node] = mat3_apply(turn, f->acceleration[node]);
        }
    }
}

static void tree_wake(tree *t)
{
    t->asleep = false;
    t->quiet_s = 0.0f;
}

void rest_sleepers(awt_forest *f, bool world_is_still, dquat from)
{
    dquat to = f->pose[TRACK_HEAD].orientation;
    if (world_is_still) {
        if (from.x != to.x || from.y != to.y || from.z != to.z || from.w != to.w) {
            rest_carry(f, from, to, true);
        }
        return;
    }
    for (uint32_t t = 0; t < f->groom->info.wisp_count[0]; t++) {
        if (f->trees[t].asleep) {
            tree_wake(&f->trees[t]);
        }
    }
}

void rest_observe(awt_forest *f, tree *t, bool world_is_still, float dt_s)
{
    bool quiet = world_is_still;
    float speed = quiet_speed(f);
    for (uint32_t k = t->first; quiet && k < t->first + t->count; k++) {
        vec3 v = f->velocity[f->active_node[k]];
        quiet = vec3_dot(v, v) < speed * speed;
    }
    t->quiet_s = quiet ? t->quiet_s + dt_s : 0.0f;
    if (!rest_is_settled(t) || t->count > f->groom->info.sections) {
        return;
    }
    t->asleep = true;
    for (uint32_t k = t->first; k < t->first + t->count; k++) {
        f->velocity[f->active_node[k]] = f->acceleration[f->active_node[k]] = (vec3){0, 0, 0};
        f->agitation[f->active_node[k]] = 0.0f;
    }
}

float rest_waking_speed(const awt_forest *f)
{
    return 2.0f * quiet_speed(f);
}

void rest_wake(awt_forest *f, uint32_t slot)
{
    tree *t = &f->trees[f->groom->gc_tree[f->active_node[slot] / f->groom->info.sections]];
    if (t->asleep) {
        tree_wake(t);
    }
}

void rest_wake_all(awt_forest *f)
{
    f->still_s = 0.0f;
    for (uint32_t t = 0; t < f->groom->info.wisp_count[0]; t++) {
        tree_wake(&f->trees[t]);
    }
}
