/* step.c: one sub-step, as PHYSICS.md lists it: poses, forces, links, obstacles, velocities, adaptation, rest. */
#include "sim/step.h"

#include "sim/adapt.h"
#include "sim/contact.h"
#include "sim/dynamics.h"
#include "sim/embed.h"
#include "sim/joint.h"
#include "sim/links.h"
#include "sim/obstacle.h"
#include "sim/rest.h"

#include <string.h>

/* A change of velocity beyond this in one sub-step is taken for a teleport, flagged or not (CONTRACT.md). */
#define STEP_TELEPORT_M_S 30.0

void step_orient(awt_forest *f)
{
    f->head = mat3_of_quat(quat_of_dquat(f->pose[TRACK_HEAD].orientation));
}

/* Poses at the end of the sub-step, and what their change means in the moving frame. */
static void step_pose(awt_forest *f, double sample_us, float dt_s, track_pose before[TRACK_COUNT])
{
    memcpy(before, f->pose, sizeof f->pose);
    bool teleported = track_sample(&f->track, sample_us, f->pose);
    const track_pose *head = &f->pose[TRACK_HEAD], *head_before = &before[TRACK_HEAD];
    dvec3 velocity = dvec3_scale(dvec3_sub(head->position, head_before->position), 1.0 / (double)dt_s);
    dvec3 change = dvec3_sub(velocity, f->frame_velocity);
    if (teleported || dvec3_length(change) > STEP_TELEPORT_M_S) {
        /* in a frame that rides on the head there is nothing else to do */
        rest_carry(f, head_before->orientation, head->orientation, false);
        memcpy(before, f->pose, sizeof f->pose);
        velocity = change = (dvec3){0, 0, 0};
    }
    f->frame_velocity = velocity;
    f->frame_acceleration = vec3_of_dvec3(dvec3_scale(change, 1.0 / (double)dt_s));
    obstacle_place(f, before, dt_s);
    f->head_spin = track_spin(before[TRACK_HEAD].orientation, head->orientation, (double)dt_s);
    step_orient(f);
}

void step_skip(awt_forest *f, int64_t end_us, float dt_s)
{
    const track_pose *head = &f->pose[TRACK_HEAD];
    const dquat from = head->orientation;
    track_pose nearly[TRACK_COUNT];
    bool teleported = track_sample(&f->track, (double)end_us - (double)dt_s * 1e6, nearly);
    teleported = track_sample(&f->track, (double)end_us, f->pose) || teleported;
    rest_carry(f, from, head->orientation, false);
    if (teleported) {
        memcpy(nearly, f->pose, sizeof nearly);
    }
    f->frame_velocity = dvec3_scale(dvec3_sub(head->position, nearly[TRACK_HEAD].position), 1.0 / (double)dt_s);
    f->frame_acceleration = (vec3){0, 0, 0};
    f->head_spin = track_spin(nearly[TRACK_HEAD].orientation, head->orientation, (double)dt_s);
    obstacle_place(f, nearly, dt_s); /* nothing is swept on the way */
    step_orient(f);
    f->time_us = end_us;
}

/* Greatest |length - target| / target of the tree's links; a link under 5 mm counts as 5 mm long, because positions
 * are floats that step by 0.03 um. */
static float step_link_error(const awt_forest *f, const tree *t)
{
    float worst = 0.0f, slack = joint_links_are_springs(f) ? f->params.strain_limit : 0.0f;
    for (uint32_t k = t->first + 1; k < t->first + t->count; k++) {
        float target = f->link_length[f->active_node[k]];
        float length = vec3_distance(f->next[k], f->next[f->active_parent[k]]);
        float error = fabsf(length - target) / (target > 0.005f ? target : 0.005f) - slack;
        worst = error > worst ? error : worst;
    }
    return worst;
}

static void step_tree(awt_forest *f, uint32_t index, float dt_s, awt_step_stats *stats)
{
    tree *t = &f->trees[index];
    dynamics_agitate(f, t, dt_s);
    t->moved = f->sub_steps;
    dynamics_predict(f, t, dt_s);
    if (!joint_links_are_springs(f)) {
        links_project(f, t);
    }
    stats->unreached_contacts += obstacle_settle(f, t, dt_s);
    float error = step_link_error(f, t);
    stats->link_error = error > stats->link_error ? error : stats->link_error;
    stats->clamped_speeds += dynamics_finish(f, t, dt_s);
    embed_relax(f, t, dt_s);
}

void step_run(awt_forest *f, int64_t end_us, double sample_us, float dt_s, awt_step_stats *stats)
{
    const uint32_t trees = f->groom->info.wisp_count[0];
    track_pose before[TRACK_COUNT];
    f->sub_steps++;
    step_pose(f, sample_us, dt_s, before);
    stats->contacts += contact_resolve(f, dt_s);
    stats->contacts_left_out += f->contacts_left_out;
    f->wind = wind_blow(&f->params, end_us, f->pose[TRACK_HEAD].position);
    bool world_is_still = rest_world_is_still(f, dt_s);
    rest_sleepers(f, world_is_still, before[TRACK_HEAD].orientation);
    f->time_us = end_us;
    for (uint32_t t = 0; t < trees; t++) {
        if (f->trees[t].asleep) {
            embed_relax(f, &f->trees[t], dt_s);
            continue;
        }
        step_tree(f, t, dt_s, stats);
    }
    adapt_counts counts = adapt_forest(f);
    stats->splits += counts.splits;
    stats->merges += counts.merges;
    for (uint32_t t = 0; t < trees; t++) {
        if (!f->trees[t].asleep) {
            rest_observe(f, &f->trees[t], world_is_still, dt_s);
        }
    }
    stats->steps++;
}
