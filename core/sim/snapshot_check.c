/* snapshot_check.c: what must hold of what a snapshot brought. */
#include "sim/snapshot.h"

#include "base/error.h"

awt_status snapshot_damaged(const char *section, awt_error *error)
{
    return error_set(error, AWT_BAD_VALUE, "section %s of the snapshot is damaged", section);
}

awt_status snapshot_check_sizes(const groom_plan *plan, awt_error *error)
{
    bool sound = plan->strand_count >= 1 && plan->strand_count <= AWT_MAX_STRANDS && plan->points_per_strand >= 2 &&
                 plan->points_per_strand <= AWT_MAX_POINTS_PER_STRAND && plan->levels >= 1 &&
                 plan->levels <= AWT_MAX_LEVELS && plan->sections >= 2 && plan->sections <= AWT_MAX_SECTIONS &&
                 plan->head_radius_m > 0 && plan->head_radius_m <= SNAPSHOT_FARTHEST_M;
    uint32_t above = 1;
    for (uint32_t level = 0; level < AWT_MAX_LEVELS; level++) {
        uint32_t wisps = plan->wisp_count[level];
        bool used = level < plan->levels;
        sound = sound && (used ? wisps >= above && wisps <= plan->strand_count : wisps == 0);
        above = wisps;
    }
    return sound ? plan_check_sizes(plan, error) : snapshot_damaged("SIZE", error);
}

static bool is_length(double metres)
{
    return metres >= 0 && metres <= SNAPSHOT_FARTHEST_M;
}

awt_status snapshot_check_measures(const awt_groom *g, awt_error *error)
{
    const awt_groom_info *info = &g->info;
    uint32_t unit_bits;
    memcpy(&unit_bits, &g->mass_unit_kg, sizeof unit_bits);
    bool sound = g->mass_unit_kg >= 1e-12f && g->mass_unit_kg <= 1.0f && (unit_bits & 0x7fffffu) == 0 &&
                 info->mass_kg > 0 && info->mass_kg <= SNAPSHOT_FARTHEST_M && is_length(info->longest_strand_m) &&
                 is_length(info->median_strand_m);
    for (int level = 0; level < AWT_MAX_LEVELS; level++) {
        sound = sound && is_length(info->mean_radius_m[level]);
    }
    for (int axis = 0; axis < 3; axis++) {
        sound = sound && info->box_min[axis] < 0 && info->box_max[axis] > 0 &&
                is_length(-(double)info->box_min[axis]) && is_length((double)info->box_max[axis]);
    }
    return sound ? AWT_OK : snapshot_damaged("MEAS", error);
}

awt_status snapshot_check_look(const awt_groom *g, awt_error *error)
{
    bool sound = true;
    for (int k = 0; k < 3; k++) {
        sound = sound && g->info.colour[k] >= 0 && g->info.colour[k] <= 1;
    }
    return sound ? AWT_OK : snapshot_damaged("LOOK", error);
}

static bool is_finite(dvec3 v)
{
    return isfinite(v.x) && isfinite(v.y) && isfinite(v.z);
}

static bool is_turn(dquat q)
{
    return fabs(dquat_dot(q, q) - 1.0) <= 1e-6;
}

static bool poses_are_sound(const track_pose *pose, uint32_t own_count)
{
    bool sound = true;
    for (uint32_t k = 0; k < TRACK_OWN + own_count; k++) {
        sound = sound && is_finite(pose[k].position) && is_finite(pose[k].velocity) &&
                isfinite(dquat_dot(pose[k].rate, pose[k].rate)) && is_turn(pose[k].orientation);
    }
    return sound;
}

awt_status snapshot_check_motion(const awt_forest *f, awt_error *error)
{
    const track *t = &f->track;
    bool sound = is_finite(f->frame_velocity) && is_turn(f->still_orientation) && f->still_s >= 0.0f &&
                 isfinite(f->still_s) && poses_are_sound(f->pose, t->own_count) &&
                 poses_are_sound(t->last.pose, t->own_count) && t->last.time_us >= -AWT_MAX_TIME_US &&
                 t->last.time_us <= f->time_us && f->time_us <= AWT_MAX_TIME_US;
    int64_t before_us = f->time_us;
    for (uint32_t k = 0; k < t->queue_count; k++) {
        const track_instant *instant = &t->queue[track_queued(t, k)];
        sound = sound && instant->time_us > before_us && instant->time_us <= AWT_MAX_TIME_US &&
                poses_are_sound(instant->pose, t->own_count);
        before_us = instant->time_us;
    }
    return sound ? AWT_OK : snapshot_damaged("MOTN", error);
}

awt_status snapshot_check_splits(const awt_forest *f, awt_error *error)
{
    const awt_groom *g = f->groom;
    for (uint32_t gc = 0; gc < g->gc_count; gc++) {
        bool finest = gc >= groom_finest_first(g);
        if (f->first_split[gc] < f->first_split[g->gc_super[gc]] ||
            (finest && f->first_split[gc] != g->info.sections)) {
            return snapshot_damaged("SPLT", error);
        }
    }
    return AWT_OK;
}

awt_status snapshot_check_trees(const awt_forest *f, awt_error *error)
{
    if (f->split_from >= f->groom->info.wisp_count[0]) {
        return snapshot_damaged("TREE", error);
    }
    for (uint32_t t = 0; t < f->groom->info.wisp_count[0]; t++) {
        const tree *tr = &f->trees[t];
        bool merged = tr->count == f->groom->info.sections;
        bool times = tr->quiet_s >= 0.0f && tr->quiet_s <= 1e9f && tr->unrelaxed_s >= 0.0f && tr->unrelaxed_s <= 1e9f;
        if (!times || (tr->asleep && !merged)) {
            return snapshot_damaged("TREE", error);
        }
    }
    return AWT_OK;
}
