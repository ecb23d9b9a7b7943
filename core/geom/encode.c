/* encode.c: strands to a frame: patches to vertices to Draco, all of them behind the layout's JSON.
 *
 * Windows of patches (encode_window.h) are encoded by as many hands as there are, and put into the frame in their
 * order. */
#include "geom/encode.h"

#include "base/error.h"
#include "geom/buffer.h"
#include "geom/delta_write.h"
#include "geom/encode_stock.h"
#include "geom/encode_window.h"
#include "geom/glb_template.h"
#include "geom/head_pose.h"
#include "geom/layout.h"
#include "geom/quantised.h"

#include <stdlib.h>

enum { ENCODE_HANDS = 8 }; /* at most */

struct geom_scratch {
    encode_hand *hands[ENCODE_HANDS]; /* [hand_count]; of the own encoder */
    uint32_t hand_count;
    float *stock_vertices; /* of the largest patch; of the stock encoder */
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

/* ---- memory ------------------------------------------------------------------------------------------------------ */

awt_status geom_scratch_create(const geom_layout *layout, geom_scratch **out, awt_error *error)
{
    *out = NULL;
    geom_scratch *scratch = calloc(1, sizeof *scratch);
    if (!scratch) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    scratch->held = sizeof *scratch;
    awt_status status = AWT_OK;
    if (layout->stock) {
        const geom_patch largest = {0, layout->largest_patch};
        const size_t size = 3 * (size_t)layout_patch_vertices(layout, &largest) * sizeof(float);
        scratch->stock_vertices = malloc(size);
        scratch->held += size;
        status = scratch->stock_vertices ? AWT_OK : error_set(error, AWT_NO_MEMORY, NULL);
    } else {
        status = geom_scratch_widen(scratch, layout, 1, error);
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

awt_status geom_scratch_widen(geom_scratch *scratch, const geom_layout *layout, uint32_t hands, awt_error *error)
{
    const uint32_t windows = (layout->patch_count + RANS_LANES - 1) / RANS_LANES; /* where all are encoded */
    uint32_t wanted = hands < windows ? hands : windows;
    wanted = layout->stock ? 0 : wanted < ENCODE_HANDS ? wanted : ENCODE_HANDS;
    awt_status status = AWT_OK;
    while (scratch->hand_count < wanted && status == AWT_OK) {
        status = encode_hand_create(layout, &scratch->hands[scratch->hand_count], error);
        scratch->hand_count += status == AWT_OK;
    }
    return status;
}

void geom_scratch_destroy(geom_scratch *scratch)
{
    if (scratch) {
        for (uint32_t k = 0; k < scratch->hand_count; k++) {
            encode_hand_destroy(scratch->hands[k]);
        }
        free(scratch->stock_vertices);
        delta_scratch_destroy(scratch->delta);
        free(scratch);
    }
}

size_t geom_scratch_bytes(const geom_scratch *scratch)
{
    size_t bytes = scratch->held + (scratch->delta ? delta_scratch_bytes(scratch->delta) : 0);
    for (uint32_t k = 0; k < scratch->hand_count; k++) {
        bytes += encode_hand_bytes(scratch->hands[k]);
    }
    return bytes;
}

delta_scratch *geom_scratch_delta(geom_scratch *scratch)
{
    return scratch->delta;
}

/* ---- patches into the frame -------------------------------------------------------------------------------------- */

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
    return status == AWT_OK ? geom_buffer_align(e->out, e->error) : status;
}

/* What a job of a window made of a patch. */
static awt_status put_patch(encoding *e, const encode_hand *hand, const encode_window *w, int k)
{
    const geom_layout *layout = e->layout;
    const draco_job *job = &w->jobs[k];
    unsigned char *at;
    glb_patch place = {.offset = e->out->size - layout->frame.size, .size = job->size};
    awt_status status = geom_buffer_extend(e->out, job->size, &at, e->error);
    if (status != AWT_OK) {
        return status;
    }
    encode_window_put(hand, layout, w, k, at);
    for (int axis = 0; axis < 3; axis++) {
        place.min[axis] = draco_box_coordinate(&layout->box, axis, job->found.least[axis]);
        place.max[axis] = draco_box_coordinate(&layout->box, axis, job->found.greatest[axis]);
    }
    glb_template_patch(&layout->frame, w->patches[k], &place, e->out);
    e->stats.encoded_patches++;
    e->stats.entropy_bits += job->entropy_bits;
    return geom_buffer_align(e->out, e->error);
}

static awt_status put_window(encoding *e, const encode_hand *hand, const encode_window *w)
{
    awt_status status = w->status;
    if (status != AWT_OK && e->error) {
        *e->error = w->error;
    }
    e->stats.clamped_points += w->clamped_points;
    int k = 0;
    for (uint32_t i = w->first; i < w->after && status == AWT_OK; i++) {
        status = encode_keeps(e->def, i) ? keep_patch(e, i) : put_patch(e, hand, w, k++);
    }
    return status;
}

/* ---- our own encoder --------------------------------------------------------------------------------------------- */

/* Windows in a row, a hand for each. */
typedef struct encode_round {
    const encoding *e;
    encode_window windows[ENCODE_HANDS];
    uint32_t count;
} encode_round;

static void run_window(void *work, uint32_t index)
{
    encode_round *r = work;
    encode_window_run(r->e->scratch->hands[index], r->e->layout, r->e->def, &r->windows[index]);
}

static awt_status encode_own(encoding *e)
{
    encode_round r = {.e = e};
    awt_status status = AWT_OK;
    for (uint32_t first = 0; first < e->layout->patch_count && status == AWT_OK;) {
        for (r.count = 0; r.count < e->scratch->hand_count && first < e->layout->patch_count; r.count++) {
            encode_window_plan(e->layout, e->def, first, &r.windows[r.count]);
            first = r.windows[r.count].after;
        }
        spread_run(e->def->helpers, run_window, &r, r.count);
        for (uint32_t k = 0; k < r.count && status == AWT_OK; k++) {
            status = put_window(e, e->scratch->hands[k], &r.windows[k]);
        }
    }
    return status;
}

/* ---- frames --------------------------------------------------------------------------------------------------------
 */

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
        status =
            layout->stock ? encode_stock(layout, def, scratch->stock_vertices, out, &e.stats, error) : encode_own(&e);
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
