/* encode.c: strands to a frame: patches to vertices to Draco, all of them behind the layout's JSON.
 *
 * Patches are taken by windows: as many in a row as hold RANS_LANES patches to be encoded, for the own encoder goes
 * through so many at once. What comes out of a patch does not depend on the window it was in. */
#include "geom/encode.h"

#include "base/error.h"
#include "geom/buffer.h"
#include "geom/delta_write.h"
#include "geom/draco_shim.h"
#include "geom/glb_template.h"
#include "geom/guides.h"
#include "geom/head_pose.h"
#include "geom/layout.h"
#include "geom/quantised.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct geom_scratch {
    draco_writer *writer;        /* NULL: stock encoder */
    float *vertices[RANS_LANES]; /* of the largest patch each; NULL where points are taken as they are */
    int16_t *turns[RANS_LANES];  /* of guides: [vertices][3] */
    size_t held;
    delta_scratch *delta; /* NULL: of no kind that has deltas */
};

/* Where encoding stands. */
typedef struct encoding {
    const geom_layout *layout;
    geom_scratch *scratch;
    const geom_frame_def *def;
    geom_buffer *out;
    geom_frame_stats stats;
    awt_error *error;
} encoding;

awt_status geom_scratch_create(const geom_layout *layout, geom_scratch **out, awt_error *error)
{
    const geom_patch largest = {0, layout->largest_patch};
    const uint32_t vertices = layout_patch_vertices(layout, &largest);
    const symbols_scheme scheme = layout->kind == GEOM_RIBBON ? SYMBOLS_TAGGED : SYMBOLS_RAW;
    *out = NULL;
    geom_scratch *scratch = calloc(1, sizeof *scratch);
    if (!scratch) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    scratch->held = sizeof *scratch;
    awt_status status = AWT_OK;
    if (!layout->stock) {
        status =
            draco_writer_create(vertices, layout->box.bits, scheme, layout->attributes.form, &scratch->writer, error);
    }
    for (int k = 0; k < RANS_LANES && layout->kind == GEOM_GUIDES && status == AWT_OK; k++) {
        const size_t size = 3 * (size_t)vertices * sizeof(int16_t);
        scratch->turns[k] = malloc(size);
        scratch->held += size;
        status = scratch->turns[k] ? AWT_OK : error_set(error, AWT_NO_MEMORY, NULL);
    }
    const int copies = layout->stock ? 1 : layout->kind == GEOM_RIBBON ? RANS_LANES : 0;
    for (int k = 0; k < copies && status == AWT_OK; k++) {
        const size_t size = 3 * (size_t)vertices * sizeof(float);
        scratch->vertices[k] = malloc(size);
        scratch->held += size;
        status = scratch->vertices[k] ? AWT_OK : error_set(error, AWT_NO_MEMORY, NULL);
    }
    if (status == AWT_OK && layout->kind != GEOM_RIBBON && !layout->stock) {
        status = delta_scratch_create(layout, &scratch->delta, error);
    }
    if (status != AWT_OK) {
        geom_scratch_destroy(scratch);
        return status;
    }
    *out = scratch;
    return AWT_OK;
}

void geom_scratch_destroy(geom_scratch *scratch)
{
    if (scratch) {
        draco_writer_destroy(scratch->writer);
        delta_scratch_destroy(scratch->delta);
        for (int k = 0; k < RANS_LANES; k++) {
            free(scratch->vertices[k]);
            free(scratch->turns[k]);
        }
        free(scratch);
    }
}

size_t geom_scratch_bytes(const geom_scratch *scratch)
{
    return scratch->held + (scratch->writer ? draco_writer_bytes(scratch->writer) : 0) +
           (scratch->delta ? delta_scratch_bytes(scratch->delta) : 0);
}

delta_scratch *geom_scratch_delta(geom_scratch *scratch)
{
    return scratch->delta;
}

/* ---- points to vertices */

static awt_status refuse_points(const encoding *e, const geom_patch *patch)
{
    return error_set(e->error, AWT_BAD_VALUE, "a point or frame among %s %u to %u is not a finite number",
                     glb_words_of(e->layout->kind).lines, patch->first_strand,
                     patch->first_strand + patch->strands - 1);
}

static const float *points_of(const encoding *e, const geom_patch *patch)
{
    return e->def->points + (size_t)patch->first_strand * e->layout->points_per_strand * 3;
}

/* ---- patches into the frame */

static awt_status append_zeros(encoding *e)
{
    static const unsigned char zeros[4];
    return geom_buffer_append(e->out, zeros, (4 - e->out->size % 4) % 4, e->error);
}

/* The bytes of a patch that did not change. */
static awt_status keep_patch(encoding *e, uint32_t index)
{
    const geom_layout *layout = e->layout;
    const geom_buffer *previous = e->def->previous;
    glb_patch from;
    if (!glb_template_keep(&layout->frame, index, previous, e->out, &from)) {
        return error_set(e->error, AWT_BAD_VALUE, "the previous frame is damaged");
    }
    const glb_patch place = {.offset = e->out->size - layout->frame.size, .size = from.size};
    glb_template_place(&layout->frame, index, &place, e->out);
    awt_status status =
        geom_buffer_append(e->out, previous->bytes + layout->frame.size + from.offset, from.size, e->error);
    return status == AWT_OK ? append_zeros(e) : status;
}

/* What a job made of a patch. */
static awt_status put_patch(encoding *e, uint32_t index, const draco_job *job, int lane)
{
    const geom_layout *layout = e->layout;
    unsigned char *at;
    glb_patch place = {.offset = e->out->size - layout->frame.size, .size = job->size};
    awt_status status = geom_buffer_extend(e->out, job->size, &at, e->error);
    if (status != AWT_OK) {
        return status;
    }
    draco_writer_put(e->scratch->writer, &layout->box, job, lane, at);
    for (int k = 0; k < 3; k++) {
        place.min[k] = draco_box_coordinate(&layout->box, k, job->found.least[k]);
        place.max[k] = draco_box_coordinate(&layout->box, k, job->found.greatest[k]);
    }
    glb_template_patch(&layout->frame, index, &place, e->out);
    e->stats.encoded_patches++;
    e->stats.entropy_bits += job->entropy_bits;
    return append_zeros(e);
}

/* ---- our own encoder */

/* Patches in a row, and the jobs of those that are to be encoded, in order. */
typedef struct window {
    uint32_t first, after;
    draco_job jobs[RANS_LANES];
    uint32_t patches[RANS_LANES]; /* of the jobs */
    int count;
} window;

static bool is_kept(const encoding *e, uint32_t index)
{
    return e->def->unchanged && e->def->unchanged[index];
}

/* False: a frame is not finite. */
static bool add_turns(encoding *e, const geom_patch *patch, int lane, draco_job *job)
{
    const guides_part part = {patch->first_strand, patch->strands};
    const float *frames = e->def->frames + 4 * (size_t)part.first_wisp * e->layout->points_per_strand;
    job->turns = e->scratch->turns[lane];
    return guides_turns(e->layout->binding, part, (const quat *)(const void *)frames, e->scratch->turns[lane]);
}

static awt_status add_job(encoding *e, uint32_t index, window *w)
{
    const geom_layout *layout = e->layout;
    const geom_patch *patch = &layout->patches[index];
    w->patches[w->count] = index;
    if (e->def->quantised) {
        const uint16_t *numbers = quantised_patch(e->def->quantised, layout, index);
        w->jobs[w->count++] = (draco_job){.mesh = &layout->meshes[index], .numbers = numbers};
        return AWT_OK;
    }
    const float *points = points_of(e, patch);
    if (layout->kind == GEOM_RIBBON) {
        float *vertices = e->scratch->vertices[w->count];
        if (!ribbon_vertices(&layout->shape, points, patch->strands, vertices, &e->stats.clamped_points)) {
            return refuse_points(e, patch);
        }
        points = vertices;
    }
    draco_job *job = &w->jobs[w->count];
    *job = (draco_job){.mesh = &layout->meshes[index], .positions = points};
    if (layout->kind == GEOM_GUIDES && !add_turns(e, patch, w->count, job)) {
        return refuse_points(e, patch);
    }
    w->count++;
    return AWT_OK;
}

static awt_status fill_window(encoding *e, uint32_t first, window *w)
{
    awt_status status = AWT_OK;
    *w = (window){.first = first, .after = first};
    while (status == AWT_OK && w->after < e->layout->patch_count && (w->count < RANS_LANES || is_kept(e, w->after))) {
        status = is_kept(e, w->after) ? AWT_OK : add_job(e, w->after, w);
        w->after++;
    }
    return status;
}

static awt_status check_jobs(encoding *e, const window *w)
{
    for (int k = 0; k < w->count; k++) {
        const draco_job *job = &w->jobs[k];
        if (!job->found.finite) {
            return refuse_points(e, &e->layout->patches[w->patches[k]]);
        }
        if (job->found.outside && e->layout->kind != GEOM_RIBBON) {
            e->stats.clamped_points += quantise_count_outside(&e->layout->bounds, job->positions, job->mesh->vertices);
        }
    }
    return AWT_OK;
}

static awt_status put_window(encoding *e, const window *w)
{
    awt_status status = AWT_OK;
    for (uint32_t i = w->first, k = 0; i < w->after && status == AWT_OK; i++) {
        if (is_kept(e, i)) {
            status = keep_patch(e, i);
        } else {
            status = put_patch(e, i, &w->jobs[k], (int)k);
            k++;
        }
    }
    return status;
}

static awt_status encode_own(encoding *e)
{
    window w = {.after = 0};
    awt_status status = AWT_OK;
    while (w.after < e->layout->patch_count && status == AWT_OK) {
        status = fill_window(e, w.after, &w);
        if (status == AWT_OK) {
            draco_writer_run(e->scratch->writer, &e->layout->box, &e->layout->bounds, w.jobs, e->def->measure);
            status = check_jobs(e, &w);
        }
        status = status == AWT_OK ? put_window(e, &w) : status;
    }
    return status;
}

/* ---- the stock encoder */

/* Vertices of a patch, set onto the bounds: what our own encoder does while it quantises. */
static awt_status take_vertices(encoding *e, const geom_patch *patch, float *vertices)
{
    const geom_layout *layout = e->layout;
    const float *points = points_of(e, patch);
    const size_t count = (size_t)patch->strands * layout->points_per_strand;
    if (layout->kind == GEOM_RIBBON) {
        bool taken = ribbon_vertices(&layout->shape, points, patch->strands, vertices, &e->stats.clamped_points);
        return taken ? AWT_OK : refuse_points(e, patch);
    }
    for (size_t i = 0; i < 3 * count; i++) {
        if (!isfinite(points[i])) {
            return refuse_points(e, patch);
        }
        vertices[i] = fminf(fmaxf(points[i], layout->bounds.least[i % 3]), layout->bounds.greatest[i % 3]);
    }
    e->stats.clamped_points += quantise_count_outside(&layout->bounds, points, count);
    return AWT_OK;
}

/* The bounds that a decoder will find: rounding to the quantisation grid keeps the order, so that the rounded bounds
 * are the bounds of the rounded positions, exactly. */
static void find_bounds(const draco_box *box, const float *vertices, size_t count, glb_patch *place)
{
    for (int k = 0; k < 3; k++) {
        float least = vertices[k], greatest = vertices[k];
        for (size_t i = 1; i < count; i++) {
            float value = vertices[3 * i + (size_t)k];
            least = value < least ? value : least;
            greatest = value > greatest ? value : greatest;
        }
        place->min[k] = draco_shim_round(box, k, least);
        place->max[k] = draco_shim_round(box, k, greatest);
    }
}

static awt_status encode_stock(encoding *e)
{
    const geom_layout *layout = e->layout;
    float *vertices = e->scratch->vertices[0];
    awt_status status = AWT_OK;
    for (uint32_t i = 0; i < layout->patch_count && status == AWT_OK; i++) {
        const draco_mesh *mesh = &layout->meshes[i];
        glb_patch place = {.offset = e->out->size - layout->frame.size};
        status = take_vertices(e, &layout->patches[i], vertices);
        if (status == AWT_OK) {
            find_bounds(&layout->box, vertices, mesh->vertices, &place);
            status = draco_shim_encode(&layout->box, vertices, mesh->vertices, layout->indices, mesh->triangles, e->out,
                                       e->error);
        }
        if (status == AWT_OK) {
            place.size = e->out->size - layout->frame.size - place.offset;
            glb_template_patch(&layout->frame, i, &place, e->out);
            e->stats.encoded_patches++;
            status = append_zeros(e);
        }
    }
    return status;
}

/* ---- frames */

awt_status geom_encode(const geom_layout *layout, geom_scratch *scratch, const geom_frame_def *def, geom_buffer *out,
                       geom_frame_stats *stats, awt_error *error)
{
    encoding e = {.layout = layout, .scratch = scratch, .def = def, .out = out, .error = error};
    awt_pose head;
    awt_status status = head_pose_take(&def->head, &head, error);
    if (status == AWT_OK && layout->kind == GEOM_GUIDES && !def->frames) {
        status = error_set(error, AWT_BAD_VALUE, "guides have frames");
    }
    if (status == AWT_OK && def->unchanged &&
        (layout->stock || !def->previous || !glb_template_made(&layout->frame, def->previous))) {
        status = error_set(error, AWT_BAD_VALUE, "the previous frame is none of this layout, or of the stock encoder");
    }
    if (status == AWT_OK && def->quantised &&
        (layout->kind != GEOM_STRANDS || !quantised_fits(def->quantised, layout))) {
        status = error_set(error, AWT_BAD_VALUE, "the whole numbers are none of this layout's");
    }
    if (status == AWT_OK) {
        status = glb_template_begin(&layout->frame, &head, def->time_us, out, error);
    }
    if (status == AWT_OK) {
        status = layout->stock ? encode_stock(&e) : encode_own(&e);
    }
    if (status != AWT_OK) {
        return status;
    }
    glb_template_end(&layout->frame, out);
    for (uint32_t i = 0; i < layout->patch_count; i++) {
        e.stats.vertices += layout->meshes[i].vertices;
        e.stats.triangles += layout->meshes[i].triangles;
    }
    if (stats) {
        *stats = e.stats;
    }
    return AWT_OK;
}
