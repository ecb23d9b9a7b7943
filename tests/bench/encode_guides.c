/* encode_guides.c: see encode_guides.h. */
#include "bench/encode_guides.h"

#include "base/error.h"
#include "bench/bench.h"
#include "geom/layout.h"
#include "quantile.h"

#include <math.h>
#include <stdlib.h>

static const char *const KINDS[GUIDES_KINDS] = {"guides", "guides bound", "nodes"};

awt_status guides_subject_init(guides_subject *s, const awt_groom *groom, uint32_t frames, awt_error *error)
{
    awt_groom_info info;
    *s = (guides_subject){0};
    awt_groom_get_info(groom, &info);
    awt_status status = geom_binding_write(groom, NULL, 0, &s->binding_bytes, error);
    for (int form = 0; form < 2 && status == AWT_OK; form++) {
        const geom_layout_def def = {.kind = GEOM_GUIDES, .bound = form == GUIDES_BOUND};
        status = geom_layout_create(groom, &def, &s->layouts[form], error);
        status = status == AWT_OK ? geom_scratch_create(s->layouts[form], &s->scratches[form], error) : status;
    }
    if (status != AWT_OK) {
        return status;
    }
    unsigned char *bytes = malloc(s->binding_bytes);
    s->nodes = calloc(info.finest_nodes, sizeof *s->nodes);
    bool made = bytes && s->nodes;
    for (int k = 0; k < GUIDES_KINDS; k++) {
        s->encode_ms[k] = calloc(frames, sizeof(double));
        s->receive_ms[k] = calloc(frames, sizeof(double));
        made = made && s->encode_ms[k] && s->receive_ms[k];
    }
    status = made ? geom_binding_write(groom, bytes, s->binding_bytes, &s->binding_bytes, error)
                  : error_set(error, AWT_NO_MEMORY, NULL);
    if (status == AWT_OK) {
        status = geom_binding_read(bytes, s->binding_bytes, &s->binding, error);
    }
    free(bytes);
    return status;
}

void guides_subject_fini(guides_subject *s)
{
    for (int form = 0; form < 2; form++) {
        geom_scratch_destroy(s->scratches[form]);
        geom_layout_destroy(s->layouts[form]);
    }
    geom_binding_destroy(s->binding);
    geom_buffer_fini(&s->frame);
    free(s->nodes);
    for (int k = 0; k < GUIDES_KINDS; k++) {
        free(s->encode_ms[k]);
        free(s->receive_ms[k]);
    }
}

static void compare(const geom_strands *got, const float *points, guides_row *sum)
{
    const size_t count = (size_t)got->strand_count * got->points_per_strand;
    double total = 0;
    for (size_t i = 0; i < 3 * count; i += 3) {
        double square = 0;
        for (size_t k = i; k < i + 3; k++) {
            const double way = (double)got->positions[k] - (double)points[k];
            square += way * way;
        }
        total += sqrt(square);
        sum->max_error_mm = fmax(sum->max_error_mm, sqrt(square) * 1e3);
    }
    sum->mean_error_mm += total / (double)count * 1e3;
}

static awt_status measure_form(guides_subject *s, int form, geom_frame_def *def, const float *points, awt_error *error)
{
    geom_frame_stats stats;
    geom_strands got = {0};
    guides_row *sum = &s->sums[form];
    def->measure = true;
    awt_status status = geom_encode(s->layouts[form], s->scratches[form], def, &s->frame, &stats, error);
    sum->entropy_bits += status == AWT_OK ? stats.entropy_bits / stats.vertices : 0;
    def->measure = false;
    double begin = bench_now_ms();
    if (status == AWT_OK) {
        status = geom_encode(s->layouts[form], s->scratches[form], def, &s->frame, &stats, error);
    }
    s->encode_ms[form][s->done] = bench_now_ms() - begin;
    begin = bench_now_ms();
    if (status == AWT_OK) {
        status = geom_receive_frame(s->binding, s->frame.bytes, s->frame.size, &got, error);
    }
    s->receive_ms[form][s->done] = bench_now_ms() - begin;
    if (status == AWT_OK) {
        sum->nodes += stats.vertices;
        sum->bytes += (double)s->frame.size;
        compare(&got, points, sum);
        geom_strands_fini(&got);
    }
    return status;
}

static awt_status measure_nodes(guides_subject *s, const awt_forest *forest, const geom_frame_def *def,
                                awt_error *error)
{
    geom_nodes got = {0};
    double begin = bench_now_ms();
    const uint32_t count = awt_forest_nodes(forest, s->nodes);
    awt_status status = geom_encode_nodes(s->nodes, count, &def->head, def->time_us, &s->frame, error);
    s->encode_ms[GUIDES_NODES][s->done] = bench_now_ms() - begin;
    begin = bench_now_ms();
    if (status == AWT_OK) {
        status = geom_read_nodes(s->frame.bytes, s->frame.size, &got, error);
    }
    s->receive_ms[GUIDES_NODES][s->done] = bench_now_ms() - begin;
    s->sums[GUIDES_NODES].nodes += count;
    s->sums[GUIDES_NODES].bytes += (double)s->frame.size;
    geom_nodes_fini(&got);
    return status;
}

awt_status guides_measure(guides_subject *s, const awt_forest *forest, const float *centres, const float *frames,
                          const float *points, awt_error *error)
{
    geom_frame_def def = {
        .points = centres, .frames = frames, .head = awt_forest_head(forest), .time_us = awt_forest_time(forest)};
    awt_status status = measure_form(s, GUIDES_WHOLE, &def, points, error);
    if (status == AWT_OK) {
        status = measure_form(s, GUIDES_BOUND, &def, points, error);
    }
    if (status == AWT_OK) {
        status = measure_nodes(s, forest, &def, error);
    }
    s->done += status == AWT_OK;
    return status;
}

static double median(double *values, uint32_t count)
{
    quantile_sort(values, count);
    return quantile_at(values, count, 0.5);
}

void guides_rows(guides_subject *s, guides_row rows[GUIDES_KINDS])
{
    for (int k = 0; k < GUIDES_KINDS; k++) {
        guides_row *row = &rows[k];
        *row = s->sums[k];
        row->kind = KINDS[k];
        row->position_bits = k == GUIDES_NODES ? 0 : (uint32_t)s->layouts[k]->box.bits;
        row->turn_bits = k == GUIDES_NODES ? 0 : (uint32_t)s->layouts[k]->attributes.turn_bits;
        row->nodes /= s->done;
        row->bytes /= s->done;
        row->entropy_bits /= s->done;
        row->mean_error_mm /= s->done;
        row->encode_ms = median(s->encode_ms[k], s->done);
        row->receive_ms = median(s->receive_ms[k], s->done);
    }
}
