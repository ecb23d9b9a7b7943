/* forest_work.c: see forest_work.h. */
#include "forest_work.h"
#include "base/error.h"
#include "clock.h"
#include "forest_state.h"
#include "groom_make.h"
#include "metrics.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* ---- making -------------------------------------------------------------------------------------------------- */

enum { NOTE_WHOLE = 65535 }; /* a note is the stage, and its share in 16 bits */

static void note_stage(forest_work *w, forest_stage stage, double share)
{
    unsigned part = (unsigned)(share * NOTE_WHOLE);
    atomic_store_explicit(&w->note, (unsigned)stage << 16 | part, memory_order_relaxed);
}

static void note_wisps(void *context, double share)
{
    note_stage(context, FOREST_WISPS, share);
}

forest_stage forest_work_stage(forest_work *w, float *share)
{
    unsigned note = atomic_load_explicit(&w->note, memory_order_relaxed);
    *share = (float)(note & NOTE_WHOLE) / (float)NOTE_WHOLE;
    return (forest_stage)(note >> 16);
}

static awt_status make_forest(forest_work *w, awt_error *error)
{
    recipe *r = w->making;
    awt_forest_def def = awt_forest_def_default(w->groom);
    if (!r->style && !r->own_stiffness) {
        r->params.style_omega = def.params.style_omega;
    }
    def.params = r->params;
    def.start = r->start;
    if (r->own_colliders) {
        def.collider_count = r->collider_count;
        memcpy(def.colliders, r->colliders, sizeof def.colliders);
    } else {
        r->collider_count = def.collider_count;
        memcpy(r->colliders, def.colliders, sizeof r->colliders);
    }
    return awt_forest_create(w->groom, &def, &w->forest, error);
}

/* The groom; of a snapshot the forest, too. */
static awt_status make_wisps(forest_work *w, awt_error *error)
{
    if (w->making->state) {
        return forest_state_restore(w, error);
    }
    w->shared = groom_make(w->grooms, w->making, note_wisps, w, &w->build_us, error);
    if (!w->shared) {
        return error->status;
    }
    w->groom = w->shared->groom;
    w->skipped_strands = w->shared->skipped_strands;
    w->rebuilt = w->shared->rebuilt;
    return AWT_OK;
}

static awt_status make_hair(forest_work *w, awt_error *error)
{
    note_stage(w, FOREST_STRANDS, 0);
    awt_status status = recipe_check_files(w->making, error); /* first: a groom is known by the file's hash */
    status = status == AWT_OK ? make_wisps(w, error) : status;
    note_stage(w, FOREST_DRAWS, 0);
    if (status == AWT_OK) {
        awt_groom_get_info(w->groom, &w->info);
        status = drawing_create(w->groom, w->helpers, &w->draws, error);
    }
    return status == AWT_OK && !w->forest ? make_forest(w, error) : status;
}

/* ---- advancing ------------------------------------------------------------------------------------------------- */

/* Motions and parameters in order. One that is refused changes nothing and its sender hears of it. */
static const forest_input *take_inputs(forest_work *w)
{
    forest_input *input = w->inputs;
    for (; input->kind != FOREST_QUERY; input = input->next) {
        if (input->kind == FOREST_MOTION) {
            awt_forest_move(w->forest, &input->as.motion, &input->error);
        } else {
            awt_forest_set_params(w->forest, &input->as.params, &input->error);
        }
    }
    return input;
}

/* By the daemon's clock: what is shown may lie before the forest's time. */
static awt_status run_free(forest_work *w, int64_t *shown_us, awt_step_stats *step, awt_error *error)
{
    const free_forest d = {w->forest, w->recorder};
    free_result result;
    awt_status status = free_run(&d, &w->free, w->inputs, w->wanted.count > 0 ? w->draws : NULL, &result, error);
    w->dropped_us = result.dropped_us;
    *step = result.stats;
    *shown_us = drawing_show(w->draws, w->forest, result.shown_us);
    return status;
}

/* To the query's time. A new forest is brought to where it stands: no step, but its active nodes are counted. */
static awt_status run_to_query(forest_work *w, int64_t *shown_us, awt_step_stats *step, awt_error *error)
{
    *shown_us = w->making ? w->making->start.time_us : take_inputs(w)->as.query.time_us;
    awt_status status = awt_forest_advance(w->forest, *shown_us, step, error);
    drawing_show(w->draws, w->forest, *shown_us);
    return status;
}

static awt_status advance(forest_work *w, awt_error *error)
{
    int64_t begun_us = clock_monotonic_us(), shown_us = 0;
    awt_step_stats step = {0};
    awt_status status = w->runs ? run_free(w, &shown_us, &step, error) : run_to_query(w, &shown_us, &step, error);
    int64_t ended_us = clock_monotonic_us();
    w->steps = step.steps;
    w->step_us = clock_between_us(begun_us, ended_us);
    metrics_count(METRIC_STEPS, step.steps);
    metrics_observe(METRIC_STEP, w->step_us);
    if (status != AWT_OK) {
        return status;
    }
    w->stepped = true;
    w->asleep = step.asleep_trees == w->info.wisp_count[0];
    w->sequence++;
    w->stepped_us = ended_us;
    w->state_us = awt_forest_time(w->forest);
    w->figures = (struct proto_frame){.forest = w->handle,
                                      .sequence = w->sequence,
                                      .time_us = shown_us,
                                      .active_nodes = step.active_nodes,
                                      .splits = step.splits,
                                      .merges = step.merges,
                                      .steps = step.steps,
                                      .unreached_contacts = step.unreached_contacts,
                                      .clamped_speeds = step.clamped_speeds,
                                      .link_error = step.link_error,
                                      .kinetic_energy_j = step.kinetic_energy_j,
                                      .step_us = (uint32_t)w->step_us};
    return AWT_OK;
}

/* ---- drawing --------------------------------------------------------------------------------------------------- */

/* The picture, without views yet. NULL: no memory. */
static picture *begin_picture(forest_work *w, int64_t begun_us)
{
    picture *out = w->spare ? w->spare : picture_create();
    w->spare = NULL;
    if (out) {
        out->figures = w->figures;
        out->figures.queue_us = clock_between_us(w->submitted_us, begun_us);
        out->stepped_us = w->stepped_us;
    }
    return out;
}

static awt_status draw_binding(forest_work *w, awt_error *error)
{
    size_t size = 0;
    awt_status status = geom_binding_write(w->groom, NULL, 0, &size, error);
    if (status == AWT_OK && size > GEOM_MAX_GLB) {
        status = error_set(error, AWT_LIMIT, "the binding has %zu bytes; a message takes %d", size, GEOM_MAX_GLB);
    }
    picture *out = status == AWT_OK ? picture_of_bytes(PICTURE_BINDING, size) : NULL;
    if (!out) {
        return status == AWT_OK ? error_set(error, AWT_NO_MEMORY, NULL) : status;
    }
    out->figures.forest = w->handle;
    status = geom_binding_write(w->groom, out->views[0].glb.bytes, size, &size, error);
    if (status != AWT_OK) {
        picture_release(out);
        return status;
    }
    w->binding = out;
    return AWT_OK;
}

static void show(forest_work *w, awt_status (*make)(forest_work *w, awt_error *error))
{
    awt_error error = {0};
    awt_status status = make(w, &error);
    if (status != AWT_OK && w->draw_error.status == AWT_OK) {
        w->draw_error = error;
        w->draw_error.status = status;
    }
}

/* What is wanted of the forest as it stands. What fails is missing, and the first failure stands in draw_error. */
static void draw(forest_work *w, int64_t begun_us)
{
    int64_t drawn_us = clock_monotonic_us();
    w->drawn = begin_picture(w, begun_us);
    if (w->drawn) {
        w->draw_error.status = drawing_draw(w->draws, w->forest, w->sequence, &w->wanted, w->drawn, &w->draw_error);
    } else {
        w->draw_error.status = error_set(&w->draw_error, AWT_NO_MEMORY, NULL);
    }
    if (w->wants_binding) {
        show(w, draw_binding);
    }
    if (w->wants_state) {
        show(w, forest_state_show);
    }
    w->encode_us = clock_between_us(drawn_us, clock_monotonic_us());
}

/* ---- the job --------------------------------------------------------------------------------------------------- */

static void run(forest_work *w, int64_t begun_us)
{
    awt_status status = AWT_OK;
    w->error = w->draw_error = (awt_error){0};
    w->steps = w->step_us = w->encode_us = 0;
    w->dropped_us = 0;
    w->stepped = false;
    if (w->making) {
        status = make_hair(w, &w->error);
    }
    if (status == AWT_OK && (w->making || w->inputs || w->runs)) {
        status = advance(w, &w->error);
    }
    w->error.status = status;
    /* A step that failed left the state as it was: whoever only looks is answered all the same. */
    if (status == AWT_OK || (!w->making && w->looks)) {
        draw(w, begun_us);
    }
    w->kept = w->keeper && w->forest && forest_state_keep(w);
}

void forest_work_run(job *work)
{
    forest_work *w = (forest_work *)(void *)((unsigned char *)work - offsetof(forest_work, job));
    int64_t begun_us = clock_monotonic_us();
    metrics_add(METRIC_JOBS_WAITING, -1);
    metrics_add(METRIC_JOBS_RUNNING, 1);
    metrics_observe(METRIC_QUEUE_WAIT, clock_between_us(w->submitted_us, begun_us));
    run(w, begun_us);
    metrics_add(METRIC_JOBS_RUNNING, -1);
}

/* ---- the end --------------------------------------------------------------------------------------------------- */

void forest_work_fini(forest_work *w)
{
    recipe_destroy(w->making);
    forest_inputs_free(w->inputs);
    forest_inputs_free(w->looks);
    picture_release(w->spare);
    picture_release(w->drawn);
    picture_release(w->binding);
    picture_release(w->state);
    drawing_destroy(w->draws);
    awt_forest_destroy(w->forest);
    if (w->shared) {
        groom_cache_release(w->grooms, w->shared);
    } else {
        awt_groom_destroy(w->groom);
    }
    *w = (forest_work){0};
}

uint64_t forest_work_bytes(const forest_work *w)
{
    return (w->shared ? 0 : w->info.bytes) + (w->forest ? awt_forest_bytes(w->forest) : 0) +
           (w->draws ? drawing_bytes(w->draws) : 0);
}
