/* encode_window.c: see encode_window.h. */
#include "geom/encode_window.h"

#include "base/error.h"
#include "geom/glb_shim.h"
#include "geom/guides.h"
#include "geom/quantised.h"

#include <stdlib.h>

struct encode_hand {
    draco_writer *writer;
    float *vertices[RANS_LANES]; /* of the largest patch each; NULL where points are taken as they are */
    int16_t *turns[RANS_LANES];  /* of guides: [vertices][3] */
    size_t held;
};

/* ---- memory ------------------------------------------------------------------------------------------------------ */

static bool take_arrays(encode_hand *hand, const geom_layout *layout, uint32_t vertices)
{
    const size_t turns = layout->kind == GEOM_GUIDES ? 3 * (size_t)vertices * sizeof(int16_t) : 0;
    const size_t copies = layout->kind == GEOM_RIBBON ? 3 * (size_t)vertices * sizeof(float) : 0;
    bool taken = true;
    for (int k = 0; k < RANS_LANES && taken; k++) {
        hand->turns[k] = turns ? malloc(turns) : NULL;
        hand->vertices[k] = copies ? malloc(copies) : NULL;
        hand->held += turns + copies;
        taken = (!turns || hand->turns[k]) && (!copies || hand->vertices[k]);
    }
    return taken;
}

awt_status encode_hand_create(const geom_layout *layout, encode_hand **out, awt_error *error)
{
    const geom_patch largest = {0, layout->largest_patch};
    const uint32_t vertices = layout_patch_vertices(layout, &largest);
    const symbols_scheme scheme = layout->kind == GEOM_RIBBON ? SYMBOLS_TAGGED : SYMBOLS_RAW;
    *out = NULL;
    encode_hand *hand = calloc(1, sizeof *hand);
    if (!hand) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    hand->held = sizeof *hand;
    awt_status status =
        draco_writer_create(vertices, layout->box.bits, scheme, layout->attributes.form, &hand->writer, error);
    if (status == AWT_OK && !take_arrays(hand, layout, vertices)) {
        status = error_set(error, AWT_NO_MEMORY, NULL);
    }
    if (status != AWT_OK) {
        encode_hand_destroy(hand);
        return status;
    }
    *out = hand;
    return AWT_OK;
}

void encode_hand_destroy(encode_hand *hand)
{
    if (hand) {
        draco_writer_destroy(hand->writer);
        for (int k = 0; k < RANS_LANES; k++) {
            free(hand->vertices[k]);
            free(hand->turns[k]);
        }
        free(hand);
    }
}

size_t encode_hand_bytes(const encode_hand *hand)
{
    return hand->held + draco_writer_bytes(hand->writer);
}

/* ---- windows ----------------------------------------------------------------------------------------------------- */

bool encode_keeps(const geom_frame_def *def, uint32_t patch)
{
    return def->unchanged && def->unchanged[patch];
}

void encode_window_plan(const geom_layout *layout, const geom_frame_def *def, uint32_t first, encode_window *out)
{
    *out = (encode_window){.first = first, .after = first};
    while (out->after < layout->patch_count && (out->count < RANS_LANES || encode_keeps(def, out->after))) {
        if (!encode_keeps(def, out->after)) {
            out->patches[out->count++] = out->after;
        }
        out->after++;
    }
}

awt_status encode_refuse_points(const geom_layout *layout, const geom_patch *patch, awt_error *error)
{
    return error_set(error, AWT_BAD_VALUE, "a point or frame among %s %u to %u is not a finite number",
                     glb_words_of(layout->kind).lines, patch->first_strand, patch->first_strand + patch->strands - 1);
}

const float *encode_points_of(const geom_layout *layout, const geom_frame_def *def, const geom_patch *patch)
{
    return def->points + (size_t)patch->first_strand * layout->points_per_strand * 3;
}

/* Points to vertices. False: one, or a frame, is not finite. */
static bool fill_job(encode_hand *hand, const geom_layout *layout, const geom_frame_def *def, encode_window *w, int k)
{
    const geom_patch *patch = &layout->patches[w->patches[k]];
    draco_job *job = &w->jobs[k];
    *job = (draco_job){.mesh = &layout->meshes[w->patches[k]]};
    if (def->quantised) {
        job->numbers = quantised_patch(def->quantised, w->patches[k]);
        return true;
    }
    job->positions = encode_points_of(layout, def, patch);
    if (layout->kind == GEOM_RIBBON) {
        const float *points = job->positions;
        job->positions = hand->vertices[k];
        return ribbon_vertices(&layout->shape, points, patch->strands, hand->vertices[k], &w->clamped_points);
    }
    if (layout->kind == GEOM_GUIDES) {
        const guides_part part = {patch->first_strand, patch->strands};
        const float *frames = def->frames + 4 * (size_t)part.first_wisp * layout->points_per_strand;
        job->turns = hand->turns[k];
        return guides_turns(layout->binding, part, (const quat *)(const void *)frames, hand->turns[k]);
    }
    return true;
}

static awt_status check_jobs(const geom_layout *layout, encode_window *w)
{
    for (int k = 0; k < w->count; k++) {
        const draco_job *job = &w->jobs[k];
        if (!job->found.finite) {
            return encode_refuse_points(layout, &layout->patches[w->patches[k]], &w->error);
        }
        if (job->found.outside && layout->kind != GEOM_RIBBON) {
            w->clamped_points += quantise_count_outside(&layout->bounds, job->positions, job->mesh->vertices);
        }
    }
    return AWT_OK;
}

void encode_window_run(encode_hand *hand, const geom_layout *layout, const geom_frame_def *def, encode_window *w)
{
    for (int k = 0; k < w->count; k++) {
        if (!fill_job(hand, layout, def, w, k)) {
            w->status = encode_refuse_points(layout, &layout->patches[w->patches[k]], &w->error);
            return;
        }
    }
    if (w->count > 0) {
        draco_writer_run(hand->writer, &layout->box, &layout->bounds, w->jobs, def->measure);
    }
    w->status = check_jobs(layout, w);
}

void encode_window_put(const encode_hand *hand, const geom_layout *layout, const encode_window *w, int job,
                       unsigned char *out)
{
    draco_writer_put(hand->writer, &layout->box, &w->jobs[job], job, out);
}
