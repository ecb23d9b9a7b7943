/* forest.c: a forest's life, its inputs and its face to the outside. */
#include "sim/state.h"

#include "base/error.h"
#include "base/hash.h"
#include "sim/contact.h"
#include "sim/dynamics.h"
#include "sim/embed.h"
#include "sim/obstacle.h"
#include "sim/rest.h"
#include "sim/step.h"
#include "sim/suit.h"
#include "sim/tree.h"

#include <stdlib.h>

static awt_status params_check(const awt_params *params, awt_error *error)
{
    awt_params checked;
    awt_status status = AWT_OK;
#define PARAM_CHECK(name, value, least, greatest, unit, text) \
    status = status == AWT_OK ? awt_params_set(&checked, #name, params->name, error) : status;
    AWT_PARAM_LIST(PARAM_CHECK)
#undef PARAM_CHECK
    return status;
}

/* Every array of the forest, from a real arena or a counting one. */
static void forest_lay_out(awt_forest *f, arena *a)
{
    const awt_groom *groom = f->groom;
    size_t nodes = (size_t)groom->gc_count * groom->info.sections, slots = 0;
    for (uint32_t t = 0; t < groom->info.wisp_count[0]; t++) {
        slots += tree_capacity(groom, t);
    }
    f->first_split = ARENA_PUSH(a, uint32_t, groom->gc_count);
    f->event_us = ARENA_PUSH(a, int64_t, groom->gc_count);
    f->position = ARENA_PUSH(a, vec3, nodes);
    f->velocity = ARENA_PUSH(a, vec3, nodes);
    f->acceleration = ARENA_PUSH(a, vec3, nodes);
    f->agitation = ARENA_PUSH(a, float, nodes);
    f->radius = ARENA_PUSH(a, float, nodes);
    f->link_length = ARENA_PUSH(a, float, nodes);
    f->parent_node = ARENA_PUSH(a, uint32_t, nodes);
    f->reference = ARENA_PUSH(a, vec3, nodes);
    f->offset = ARENA_PUSH(a, vec3, nodes);
    f->frame = ARENA_PUSH(a, quat, groom->info.finest_nodes);
    f->trees = ARENA_PUSH(a, tree, groom->info.wisp_count[0]);
    f->active_node = ARENA_PUSH(a, uint32_t, slots);
    f->active_parent = ARENA_PUSH(a, uint32_t, slots);
    f->active_mass = ARENA_PUSH(a, float, slots);
    f->active_rest_tangent = ARENA_PUSH(a, vec3, slots);
    f->active_chord = ARENA_PUSH(a, uint32_t, slots);
    f->active_rest_chord = ARENA_PUSH(a, vec3, slots);
    f->active_turn_share = ARENA_PUSH(a, float, slots);
    f->active_style = ARENA_PUSH(a, vec3, slots);
    f->active_preload = ARENA_PUSH(a, vec3, slots);
    f->active_stiffness = ARENA_PUSH(a, float, slots);
    f->active_hung_mass = ARENA_PUSH(a, float, slots);
    f->active_rest_length = ARENA_PUSH(a, float, slots);
    f->active_lead = ARENA_PUSH(a, float, slots);
    f->slot_of_node = ARENA_PUSH(a, uint32_t, nodes);
    f->next = ARENA_PUSH(a, vec3, slots);
    f->turn = ARENA_PUSH(a, mat3, slots);
    f->tangent = ARENA_PUSH(a, vec3, slots);
    f->touching = ARENA_PUSH(a, bool, slots);
    f->link_mass = ARENA_PUSH(a, sym3, slots);
    f->link_push = ARENA_PUSH(a, vec3, slots);
    f->link_carry = ARENA_PUSH(a, vec3, slots);
    f->link_gain = ARENA_PUSH(a, float, slots);
    f->link_gap = ARENA_PUSH(a, float, slots);
    f->joint_mass = ARENA_PUSH(a, sym3, slots);
    f->joint_up = ARENA_PUSH(a, mat3, slots);
    f->joint_far = ARENA_PUSH(a, mat3, slots);
    f->joint_push = ARENA_PUSH(a, vec3, slots);
    contact_lay_out(f, a, slots);
}

/* Only the coarsest nodes active (§2.3), everything as the groom rests, at the head's pose. */
static void forest_rest(awt_forest *f)
{
    const awt_groom *groom = f->groom;
    uint32_t slots = 0;
    for (uint32_t g = 0; g < groom->gc_count; g++) {
        f->first_split[g] = groom->info.sections;
        f->event_us[g] = f->time_us;
    }
    for (uint32_t n = 0; n < groom->gc_count * groom->info.sections; n++) {
        f->parent_node[n] = STATE_NO_PARENT;
    }
    for (uint32_t t = 0; t < groom->info.wisp_count[0]; t++) {
        f->trees[t].first = slots;
        slots += tree_capacity(groom, t);
        tree_rebuild(f, t);
        for (uint32_t k = f->trees[t].first; k < f->trees[t].first + f->trees[t].count; k++) {
            uint32_t node = f->active_node[k];
            f->position[node] = mat3_apply(f->head, groom->rest_position[node]);
            f->radius[node] = groom->rest_radius[node];
            f->link_length[node] = f->active_rest_length[k];
            f->parent_node[node] = f->active_node[f->active_parent[k]];
        }
    }
    embed_rest(f);
}

awt_forest_def awt_forest_def_default(const awt_groom *groom)
{
    awt_forest_def def = {.params = awt_params_default()};
    def.params.style_omega = suit_style_omega(groom);
    def.collider_count = obstacle_defaults(groom, def.colliders);
    def.start.head.orientation[3] = 1.0;
    def.start.body.orientation[3] = 1.0;
    return def;
}

awt_status awt_forest_create(const awt_groom *groom, const awt_forest_def *def, awt_forest **out, awt_error *error)
{
    *out = NULL;
    awt_status status = params_check(&def->params, error);
    if (status == AWT_OK) {
        status = obstacle_check(def->colliders, def->collider_count, error);
    }
    if (status != AWT_OK) {
        return status;
    }
    awt_forest *f = calloc(1, sizeof *f);
    if (!f) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    f->groom = groom;
    arena counting = arena_counting();
    forest_lay_out(f, &counting);
    if (counting.overflowed || !arena_init(&f->memory, counting.used)) {
        status = error_set(error, AWT_NO_MEMORY, NULL);
        goto fail;
    }
    forest_lay_out(f, &f->memory);
    f->params = def->params;
    f->collider_count = def->collider_count;
    for (uint32_t k = 0; k < def->collider_count; k++) {
        f->colliders[k] = def->colliders[k];
    }
    status = track_init(&f->track, &def->start, f->colliders, f->collider_count, error);
    if (status != AWT_OK) {
        goto fail;
    }
    f->time_us = def->start.time_us;
    track_sample(&f->track, (double)f->time_us, f->pose);
    f->still_orientation = f->pose[TRACK_HEAD].orientation;
    step_orient(f);
    forest_rest(f);
    *out = f;
    return AWT_OK;
fail:
    awt_forest_destroy(f);
    return status;
}

void awt_forest_destroy(awt_forest *f)
{
    if (f) {
        arena_fini(&f->memory);
        free(f);
    }
}

awt_status awt_forest_move(awt_forest *f, const awt_motion *motion, awt_error *error)
{
    return track_push(&f->track, motion, f->time_us, error);
}

awt_status awt_forest_set_params(awt_forest *f, const awt_params *params, awt_error *error)
{
    awt_status status = params_check(params, error);
    if (status != AWT_OK) {
        return status;
    }
    f->params = *params;
    rest_wake_all(f);
    contact_clear(f);
    dynamics_calm(f);
    for (uint32_t t = 0; t < f->groom->info.wisp_count[0]; t++) {
        tree_rebuild(f, t); /* the style's targets depend on them */
    }
    return AWT_OK;
}

awt_params awt_forest_params(const awt_forest *f)
{
    return f->params;
}

static void forest_measure(const awt_forest *f, awt_step_stats *stats)
{
    double energy = 0;
    stats->time_us = f->time_us;
    for (uint32_t t = 0; t < f->groom->info.wisp_count[0]; t++) {
        const tree *tr = &f->trees[t];
        stats->active_nodes += tr->count;
        stats->asleep_trees += tr->asleep;
        for (uint32_t k = tr->first; k < tr->first + tr->count; k++) {
            vec3 v = f->velocity[f->active_node[k]];
            energy += 0.5 * (double)f->active_mass[k] * (double)vec3_dot(v, v);
        }
    }
    stats->kinetic_energy_j = (float)(energy * (double)f->groom->mass_unit_kg);
}

awt_status awt_forest_advance(awt_forest *f, int64_t time_us, awt_step_stats *stats, awt_error *error)
{
    if (time_us > AWT_MAX_TIME_US || time_us < f->time_us) {
        return error_set(error, AWT_BAD_TIME, "the forest is at %.6f s already, past %.6f s", (double)f->time_us * 1e-6,
                         (double)time_us * 1e-6);
    }
    int64_t start_us = f->time_us, span_us = time_us - start_us;
    if (span_us > AWT_MAX_ADVANCE_US) {
        return error_set(error, AWT_LIMIT, "%.3f s at once; %.0f s are the most", (double)span_us * 1e-6,
                         (double)AWT_MAX_ADVANCE_US * 1e-6);
    }
    awt_step_stats sums = {0};
    int64_t count = (span_us + AWT_STEP_US - 1) / AWT_STEP_US;
    for (int64_t n = 1; n <= count; n++) {
        double sample_us = (double)start_us + (double)span_us * (double)n / (double)count;
        step_run(f, start_us + span_us * n / count, sample_us, (float)((double)span_us * 1e-6 / (double)count), &sums);
    }
    forest_measure(f, &sums);
    if (stats) {
        *stats = sums;
    }
    return AWT_OK;
}

awt_status awt_forest_skip(awt_forest *f, int64_t time_us, awt_error *error)
{
    if (time_us > AWT_MAX_TIME_US || time_us < f->time_us) {
        return error_set(error, AWT_BAD_TIME, "the forest is at %.6f s already, past %.6f s", (double)f->time_us * 1e-6,
                         (double)time_us * 1e-6);
    }
    const int64_t span_us = time_us - f->time_us;
    if (span_us > 0) {
        step_skip(f, time_us, (float)((double)(span_us < AWT_STEP_US ? span_us : AWT_STEP_US) * 1e-6));
    }
    return AWT_OK;
}

int64_t awt_forest_time(const awt_forest *f)
{
    return f->time_us;
}

awt_pose awt_forest_head(const awt_forest *f)
{
    const track_pose *head = &f->pose[TRACK_HEAD];
    return (awt_pose){{head->position.x, head->position.y, head->position.z},
                      {head->orientation.x, head->orientation.y, head->orientation.z, head->orientation.w}};
}

const awt_groom *awt_forest_groom(const awt_forest *f)
{
    return f->groom;
}

size_t awt_forest_bytes(const awt_forest *f)
{
    return sizeof *f + f->memory.size;
}

uint64_t awt_forest_hash(const awt_forest *f)
{
    const awt_groom *groom = f->groom;
    const uint32_t sections = groom->info.sections;
    uint64_t hash = hash_u64(HASH_SEED, (uint64_t)f->time_us);
    hash = hash_words(hash, f->first_split, groom->gc_count);
    hash = hash_words(hash, f->event_us, 2 * (size_t)groom->gc_count);
    hash = hash_words(hash, &f->split_from, 1);
    hash = hash_words(hash, &f->still_s, 1);
    hash = hash_words(hash, &f->frame_velocity, sizeof f->frame_velocity / 4);
    for (uint32_t k = 0; k < TRACK_OWN + f->track.own_count; k++) {
        hash = hash_words(hash, &f->pose[k].position, sizeof f->pose[k].position / 4);
        hash = hash_words(hash, &f->pose[k].orientation, sizeof f->pose[k].orientation / 4);
    }
    for (uint32_t t = 0; t < groom->info.wisp_count[0]; t++) {
        hash = hash_words(hash, &f->trees[t].quiet_s, 1);
        hash = hash_words(hash, &f->trees[t].unrelaxed_s, 1);
        for (uint32_t k = f->trees[t].first; k < f->trees[t].first + f->trees[t].count; k++) {
            uint32_t node = f->active_node[k];
            hash = hash_words(hash, &f->position[node], 3);
            hash = hash_words(hash, &f->velocity[node], 3);
            hash = hash_words(hash, &f->acceleration[node], 3);
            hash = hash_words(hash, &f->agitation[node], 1);
            hash = hash_words(hash, &f->reference[node], 3);
            hash = hash_words(hash, &f->radius[node], 1);
            hash = hash_words(hash, &f->link_length[node], 1);
            uint32_t lo = node / sections, hi = lo + 1;
            while (groom_descend(groom, &lo, &hi)) {
                for (uint32_t s = lo; s < hi; s++) {
                    hash = hash_words(hash, &f->offset[s * sections + node % sections], 3);
                }
            }
        }
    }
    return hash_words(hash, f->frame, 4 * (size_t)groom->info.finest_nodes);
}

uint64_t awt_forest_sub_steps(const awt_forest *f)
{
    return f->sub_steps;
}

uint32_t awt_forest_moved(const awt_forest *f, uint64_t since, bool *moved)
{
    uint32_t count = 0;
    for (uint32_t t = 0; t < f->groom->info.wisp_count[0]; t++) {
        moved[t] = f->trees[t].moved > since;
        count += moved[t];
    }
    return count;
}
