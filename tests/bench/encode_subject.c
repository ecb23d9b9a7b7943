/* encode_subject.c: see encode_subject.h. */
#include "bench/encode_subject.h"

#include "base/error.h"
#include "geom/draco_shim.h"
#include "geom/glb.h"
#include "geom/topology.h"
#include "quantile.h"

#include <math.h>
#include <stdlib.h>

enum { REPEATS = 3 };

/* Strand points of a frame. */
static size_t points_of(const encode_subject *s)
{
    return (size_t)geom_layout_strands(s->layout) * s->layout->points_per_strand;
}

awt_status encode_subject_share(encode_subject *s, const spread *helpers, awt_error *error)
{
    if (s->layout->patch_count <= RANS_LANES) {
        return AWT_OK;
    }
    s->helpers = helpers;
    return geom_scratch_widen(s->scratch, s->layout, helpers->hands, error);
}

awt_status encode_subject_make(const encode_hair *h, geom_kind kind, geom_level level, uint32_t frames,
                               encode_subject *s, awt_error *error)
{
    awt_status status =
        geom_layout_create(h->groom, &(geom_layout_def){.kind = kind, .level = level}, &s->layout, error);
    if (status == AWT_OK) {
        status = geom_layout_create(h->groom, &(geom_layout_def){.kind = kind, .level = level, .stock = true},
                                    &s->stock_layout, error);
    }
    if (status == AWT_OK) {
        status = geom_scratch_create(s->layout, &s->scratch, error);
    }
    if (status == AWT_OK) {
        status = geom_scratch_create(s->stock_layout, &s->stock_scratch, error);
    }
    if (status != AWT_OK) {
        return status;
    }
    const geom_patch largest = {0, s->layout->largest_patch};
    status =
        draco_reader_create(layout_patch_vertices(s->layout, &largest),
                            topology_triangles(kind, largest.strands, h->info.points_per_strand), &s->reader, error);
    double **times[] = {&s->shared_ms,   &s->stock_ms,  &s->vertices_ms,
                        &s->evaluate_ms, &s->decode_ms, &s->stock_decode_ms};
    bool made = true;
    for (size_t k = 0; k < sizeof times / sizeof times[0]; k++) {
        made = (*times[k] = calloc(frames, sizeof(double))) && made;
    }
    for (size_t k = 0; k < ENCODE_MOVINGS; k++) {
        made = (s->encode_ms[k] = calloc(frames, sizeof(double))) && made;
    }
    s->unchanged = calloc(s->layout->patch_count, sizeof *s->unchanged);
    s->points = calloc(points_of(s), 3 * sizeof(float));
    s->vertices = calloc(points_of(s), 6 * sizeof(float));
    return status == AWT_OK && !(made && s->unchanged && s->points && s->vertices)
               ? error_set(error, AWT_NO_MEMORY, NULL)
               : status;
}

void encode_subject_free(encode_subject *s)
{
    geom_scratch_destroy(s->scratch);
    geom_scratch_destroy(s->stock_scratch);
    geom_layout_destroy(s->layout);
    geom_layout_destroy(s->stock_layout);
    draco_reader_destroy(s->reader);
    geom_buffer *buffers[] = {&s->frame, &s->previous, &s->kept, &s->stock_frame};
    for (size_t k = 0; k < sizeof buffers / sizeof buffers[0]; k++) {
        geom_buffer_fini(buffers[k]);
    }
    for (size_t k = 0; k < ENCODE_MOVINGS; k++) {
        free(s->encode_ms[k]);
    }
    free(s->shared_ms);
    free(s->stock_ms);
    free(s->vertices_ms);
    free(s->evaluate_ms);
    free(s->points);
    free(s->decode_ms);
    free(s->stock_decode_ms);
    free(s->unchanged);
    free(s->vertices);
}

/* ---- one frame */

/* The least of a few times: what else the machine did is in none of them, one hopes. */
static awt_status time_encode(const geom_layout *layout, geom_scratch *scratch, const geom_frame_def *def, int repeats,
                              geom_buffer *out, geom_frame_stats *stats, double *ms, awt_error *error)
{
    awt_status status = AWT_OK;
    *ms = INFINITY;
    for (int n = 0; n < repeats && status == AWT_OK; n++) {
        double begin = bench_now_ms();
        status = geom_encode(layout, scratch, def, out, stats, error);
        *ms = fmin(*ms, bench_now_ms() - begin);
    }
    return status;
}

static awt_status time_own(encode_subject *s, geom_frame_def *def, awt_error *error)
{
    geom_frame_stats stats = {0};
    geom_buffer swap = s->previous;
    s->previous = s->frame;
    s->frame = swap;
    def->measure = true;
    awt_status status = geom_encode(s->layout, s->scratch, def, &s->frame, &stats, error);
    s->entropy_bits += stats.entropy_bits;
    def->measure = false;
    for (int moving = ENCODE_ALL; moving < ENCODE_MOVINGS && status == AWT_OK; moving++) {
        for (uint32_t i = 0; i < s->layout->patch_count; i++) {
            s->unchanged[i] = moving == ENCODE_NONE || i % 4 != 0;
        }
        def->unchanged = moving == ENCODE_ALL ? NULL : s->unchanged;
        def->previous = s->done > 0 ? &s->previous : &s->frame;
        status = time_encode(s->layout, s->scratch, def, REPEATS, moving == ENCODE_ALL ? &s->frame : &s->kept, NULL,
                             &s->encode_ms[moving][s->done], error);
    }
    def->unchanged = NULL;
    if (status == AWT_OK && s->helpers) {
        def->helpers = s->helpers;
        status = time_encode(s->layout, s->scratch, def, REPEATS, &s->kept, NULL, &s->shared_ms[s->done], error);
        def->helpers = NULL;
    }
    s->bytes += (double)s->frame.size;
    if (s->layout->kind == GEOM_RIBBON) {
        uint32_t clamped = 0;
        double begin = bench_now_ms();
        ribbon_vertices(&s->layout->shape, s->points, geom_layout_strands(s->layout), s->vertices, &clamped);
        s->vertices_ms[s->done] = bench_now_ms() - begin;
    }
    return status;
}

/* Where a patch's vertices go. */
static float *vertices_of(encode_subject *s, const glb_patch *patch)
{
    return s->vertices +
           (size_t)patch->first_strand * s->layout->points_per_strand * topology_vertices_a_point(s->layout->kind) * 3;
}

/* Patches number `first` and the next few by our reader. */
static bool decode_own(encode_subject *s, const glb_frame *glb, uint32_t first)
{
    const draco_kind kind = {.indices = s->layout->indices};
    draco_source sources[RANS_LANES] = {{0}};
    for (uint32_t k = 0; k < RANS_LANES && first + k < glb->patch_count; k++) {
        const glb_patch *patch = &glb->patches[first + k];
        sources[k] = (draco_source){.bytes = glb->binary + patch->offset,
                                    .size = patch->size,
                                    .vertices = patch->vertices,
                                    .triangles = patch->triangles,
                                    .positions = vertices_of(s, patch)};
    }
    return draco_read(s->reader, &kind, sources);
}

/* All patches of our frame, by our reader or by libdraco. */
static awt_status time_decode(encode_subject *s, bool stock, double *ms, awt_error *error)
{
    glb_frame glb;
    awt_status status = glb_read(s->frame.bytes, s->frame.size, &glb, error);
    double begin = bench_now_ms();
    for (uint32_t i = 0; status == AWT_OK && i < glb.patch_count; i += stock ? 1 : RANS_LANES) {
        const glb_patch *patch = &glb.patches[i];
        if (stock) {
            status = draco_shim_decode(glb.binary + patch->offset, patch->size, s->layout->indices, patch->vertices,
                                       patch->triangles, vertices_of(s, patch), error);
        } else if (!decode_own(s, &glb, i)) {
            status = error_set(error, AWT_BAD_FORMAT, "our reader refuses what our encoder wrote");
        }
    }
    *ms = bench_now_ms() - begin;
    glb_frame_fini(&glb);
    return status;
}

/* The greatest distance of a decoded point (of a ribbon: the middle of its edges) from the one that went in. */
static double greatest_error(const encode_subject *s)
{
    const size_t points = points_of(s);
    const bool ribbon = s->layout->kind == GEOM_RIBBON;
    double greatest = 0;
    for (size_t i = 0; i < points; i++) {
        double square = 0;
        for (size_t k = 0; k < 3; k++) {
            double at = ribbon ? 0.5 * ((double)s->vertices[6 * i + k] + (double)s->vertices[6 * i + 3 + k])
                               : (double)s->vertices[3 * i + k];
            square += (at - (double)s->points[3 * i + k]) * (at - (double)s->points[3 * i + k]);
        }
        greatest = square > greatest ? square : greatest;
    }
    return sqrt(greatest);
}

awt_status encode_subject_measure(const encode_hair *h, encode_subject *s, int64_t time_us, awt_error *error)
{
    double begin = bench_now_ms();
    geom_layout_evaluate(s->layout, h->groom, NULL, h->centres, h->frames, h->scratch, s->points);
    s->evaluate_ms[s->done] = bench_now_ms() - begin;
    geom_frame_def def = {.points = s->points, .head = awt_forest_head(h->forest), .time_us = time_us};
    awt_status status = time_own(s, &def, error);
    if (status == AWT_OK) {
        status = time_encode(s->stock_layout, s->stock_scratch, &def, 1, &s->stock_frame, NULL, &s->stock_ms[s->done],
                             error);
        s->stock_bytes += (double)s->stock_frame.size;
    }
    if (status == AWT_OK) {
        status = time_decode(s, true, &s->stock_decode_ms[s->done], error);
    }
    if (status == AWT_OK) {
        status = time_decode(s, false, &s->decode_ms[s->done], error);
    }
    if (status == AWT_OK) {
        s->error_m = fmax(s->error_m, greatest_error(s));
        s->done++;
    }
    return status;
}

/* ---- what came of it */

static double median(double *values, uint32_t count)
{
    quantile_sort(values, count);
    return quantile_at(values, count, 0.5);
}

void encode_subject_rows(encode_subject *s, encode_row *rows)
{
    const size_t points = points_of(s);
    const double all = (double)points * s->done;
    encode_row row = {.kind = s->layout->kind,
                      .level = s->layout->level.level,
                      .quantisation_bits = s->layout->box.bits,
                      .patches = s->layout->patch_count,
                      .points = points,
                      .stock_encode_ms = median(s->stock_ms, s->done),
                      .shared_encode_ms = s->helpers ? median(s->shared_ms, s->done) : 0,
                      .evaluate_ms = median(s->evaluate_ms, s->done),
                      .vertices_ms = median(s->vertices_ms, s->done),
                      .bytes_per_point = s->bytes / all,
                      .stock_bytes_per_point = s->stock_bytes / all,
                      .entropy_bits_per_point = s->entropy_bits / all,
                      .max_error_mm = s->error_m * 1e3,
                      .decode_ms = median(s->decode_ms, s->done),
                      .stock_decode_ms = median(s->stock_decode_ms, s->done),
                      .scratch_bytes = geom_scratch_bytes(s->scratch)};
    for (int moving = ENCODE_ALL; moving < ENCODE_MOVINGS; moving++) {
        row.moving = (encode_moving)moving;
        row.encode_ms = median(s->encode_ms[moving], s->done);
        rows[moving] = row;
    }
}
