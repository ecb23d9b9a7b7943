/* forest_work.c: see forest_work.h. */
#include "forest_work.h"
#include "base/error.h"
#include "clock.h"

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

/* Strands in the head frame, from the style or the file. */
static awt_status make_strands(recipe *r, awt_strands *strands, awt_error *error)
{
    if (r->style) {
        return awt_style_grow(r->style, r->strands, r->seed, strands, error);
    }
    awt_status status = awt_strands_read(r->file->bytes, (size_t)r->file->total, strands, error);
    if (status == AWT_OK) {
        status = awt_strands_place(strands, &r->placement, error);
        r->groom.head_radius_m = r->placement.head_radius_m;
    }
    return status;
}

static awt_status make_groom(forest_work *w, const awt_strands *strands, awt_error *error)
{
    int64_t begun_us = clock_monotonic_us();
    const upload *file = w->making->hierarchy;
    awt_groom_def def = w->making->groom;
    awt_hierarchy hierarchy = {0};
    awt_status status = AWT_OK;
    if (file) {
        status = awt_hierarchy_read(file->bytes, (size_t)file->total, &hierarchy, error);
        def.hierarchy = &hierarchy;
    }
    if (status == AWT_OK) {
        status = awt_groom_build(strands, &def, note_wisps, w, &w->groom, error);
    }
    awt_hierarchy_fini(&hierarchy);
    w->build_us = clock_between_us(begun_us, clock_monotonic_us());
    w->skipped_strands = strands->skipped_count;
    w->rebuilt = status == AWT_OK ? awt_groom_rebuilt(w->groom) : (awt_rebuilt){0};
    return status;
}

static float *make_floats(uint64_t count)
{
    return count <= SIZE_MAX / sizeof(float) ? malloc((size_t)(count ? count : 1) * sizeof(float)) : NULL;
}

/* Everything that a frame needs, so that later frames allocate nothing but themselves. */
static awt_status make_buffers(forest_work *w, awt_error *error)
{
    awt_groom_get_info(w->groom, &w->info);
    uint64_t points = (uint64_t)w->info.strand_count * w->info.points_per_strand;
    if (points > AWT_MAX_POINTS) {
        return error_set(error, AWT_LIMIT, "%lu strands of %lu points are more than %d points together",
                         (unsigned long)w->info.strand_count, (unsigned long)w->info.points_per_strand, AWT_MAX_POINTS);
    }
    w->centres = make_floats((uint64_t)w->info.finest_nodes * 3);
    w->frames = make_floats((uint64_t)w->info.finest_nodes * 4);
    w->strand_scratch = make_floats(awt_groom_strand_scratch(w->groom));
    w->points = make_floats(points * 3);
    if (!w->centres || !w->frames || !w->strand_scratch || !w->points) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    awt_status status = geom_layout_create(w->groom, NULL, &w->layout, error);
    return status == AWT_OK ? geom_scratch_create(w->layout, &w->scratch, error) : status;
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

static awt_status make_hair(forest_work *w, awt_error *error)
{
    awt_strands strands = {0};
    note_stage(w, FOREST_STRANDS, 0);
    awt_status status = make_strands(w->making, &strands, error);
    if (status == AWT_OK) {
        status = make_groom(w, &strands, error);
    }
    awt_strands_fini(&strands);
    note_stage(w, FOREST_DRAWS, 0);
    if (status == AWT_OK) {
        status = make_buffers(w, error);
    }
    return status == AWT_OK ? make_forest(w, error) : status;
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

/* ---- publishing ------------------------------------------------------------------------------------------------ */

static void fill_frame(forest_work *w, published *out, const awt_step_stats *step, const geom_frame_stats *drawn)
{
    struct proto_frame *f = &out->frame;
    f->forest = w->handle;
    f->sequence = w->sequence;
    f->time_us = step->time_us;
    f->active_nodes = step->active_nodes;
    f->splits = step->splits;
    f->merges = step->merges;
    f->steps = step->steps;
    f->unreached_contacts = step->unreached_contacts;
    f->clamped_speeds = step->clamped_speeds;
    f->link_error = step->link_error;
    f->kinetic_energy_j = step->kinetic_energy_j;
    f->clamped_points = drawn->clamped_points;
    f->glb = (proto_blob){.bytes = out->glb.bytes, .length = (uint32_t)out->glb.size};
}

/* Guides, strands, ribbons, Draco, GLB: the state as a frame that nobody will change. */
static awt_status publish(forest_work *w, const awt_step_stats *step, int64_t stepped_us, awt_error *error)
{
    published *out = published_create();
    if (!out) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    awt_forest_guides(w->forest, w->centres, w->frames);
    awt_groom_strands(w->groom, w->centres, w->frames, w->strand_scratch, w->points);
    const geom_frame_def def = {.points = w->points, .head = awt_forest_head(w->forest), .time_us = step->time_us};
    geom_frame_stats drawn = {0};
    awt_status status = geom_encode(w->layout, w->scratch, &def, &out->glb, &drawn, error);
    if (status != AWT_OK) {
        published_release(out);
        return status;
    }
    fill_frame(w, out, step, &drawn);
    out->stepped_us = stepped_us;
    out->frame.encode_us = clock_between_us(stepped_us, clock_monotonic_us());
    w->encode_us = out->frame.encode_us;
    w->frame = out;
    return AWT_OK;
}

/* ---- the job --------------------------------------------------------------------------------------------------- */

void forest_work_run(job *work)
{
    forest_work *w = (forest_work *)(void *)((unsigned char *)work - offsetof(forest_work, job));
    int64_t begun_us = clock_monotonic_us();
    int64_t to_us = 0;
    awt_status status = AWT_OK;
    w->error = (awt_error){0};
    w->encode_us = 0;
    if (w->making) {
        status = make_hair(w, &w->error);
        to_us = w->making->start.time_us;
    } else {
        to_us = take_inputs(w)->as.query_us;
    }
    /* A new forest is brought to where it stands: no step, but its active nodes are counted. */
    int64_t made_us = clock_monotonic_us();
    awt_step_stats step = {0};
    if (status == AWT_OK) {
        status = awt_forest_advance(w->forest, to_us, &step, &w->error);
    }
    int64_t stepped_us = clock_monotonic_us();
    w->steps = step.steps;
    w->step_us = clock_between_us(made_us, stepped_us);
    if (status == AWT_OK) {
        status = publish(w, &step, stepped_us, &w->error);
    }
    if (status == AWT_OK) {
        w->frame->frame.queue_us = clock_between_us(w->submitted_us, begun_us);
        w->frame->frame.step_us = (uint32_t)w->step_us;
    } else {
        w->error.status = status;
    }
}

/* ---- the end --------------------------------------------------------------------------------------------------- */

void forest_inputs_free(forest_input *first)
{
    while (first) {
        forest_input *next = first->next;
        free(first);
        first = next;
    }
}

void forest_work_fini(forest_work *w)
{
    recipe_destroy(w->making);
    forest_inputs_free(w->inputs);
    published_release(w->frame);
    awt_forest_destroy(w->forest);
    geom_scratch_destroy(w->scratch);
    geom_layout_destroy(w->layout);
    awt_groom_destroy(w->groom);
    free(w->centres);
    free(w->frames);
    free(w->strand_scratch);
    free(w->points);
    *w = (forest_work){0};
}

uint64_t forest_work_bytes(const forest_work *w)
{
    uint64_t points = (uint64_t)w->info.strand_count * w->info.points_per_strand;
    uint64_t floats = points * 3 + (uint64_t)w->info.finest_nodes * 7;
    return w->info.bytes + (w->forest ? awt_forest_bytes(w->forest) : 0) + floats * sizeof(float);
}
