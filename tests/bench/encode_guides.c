/* encode_guides.c: see encode_guides.h. */
#include "bench/encode_guides.h"

#include "base/error.h"
#include "bench/bench.h"
#include "geom/layout.h"
#include "quantile.h"

#include <math.h>
#include <stdlib.h>

static const guides_row ROWS[GUIDES_KINDS] = {{.name = "guides", .kind = "guides"},
                                              {.name = "guides whole", .kind = "guides"},
                                              {.name = "guides delta", .kind = "guides", .delta = true},
                                              {.name = "nodes", .kind = "nodes"}};

awt_status guides_subject_init(guides_subject *s, const awt_groom *groom, uint32_t frames, awt_error *error)
{
    awt_groom_info info;
    *s = (guides_subject){0};
    awt_groom_get_info(groom, &info);
    awt_status status = geom_binding_write(groom, NULL, 0, &s->binding_bytes, error);
    status = status == AWT_OK ? geom_layout_create(groom, &(geom_layout_def){.kind = GEOM_GUIDES}, &s->layout, error)
                              : status;
    status = status == AWT_OK ? geom_scratch_create(s->layout, &s->scratch, error) : status;
    status = status == AWT_OK ? geom_quantised_create(s->layout, &s->base, error) : status;
    status = status == AWT_OK ? geom_quantised_create(s->layout, &s->now, error) : status;
    status = status == AWT_OK ? geom_delta_reader_create(&s->reader, error) : status;
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
    geom_scratch_destroy(s->scratch);
    geom_layout_destroy(s->layout);
    geom_quantised_destroy(s->base);
    geom_quantised_destroy(s->now);
    geom_delta_reader_destroy(s->reader);
    geom_guides_fini(&s->base_got);
    geom_guides_fini(&s->got);
    geom_strands_fini(&s->strands);
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

static void take(guides_subject *s, int kind, const geom_frame_stats *stats, const float *points)
{
    guides_row *sum = &s->sums[kind];
    sum->nodes += s->layout->strands * (double)s->layout->points_per_strand;
    sum->entropy_bits += stats->entropy_bits / (s->layout->strands * (double)s->layout->points_per_strand);
    sum->bytes += (double)s->frame.size;
    compare(&s->strands, points, sum);
}

static awt_status measure_keyframe(guides_subject *s, geom_frame_def *def, const float *points, awt_error *error)
{
    geom_frame_stats stats;
    def->measure = true;
    awt_status status = geom_encode(s->layout, s->scratch, def, &s->frame, &stats, error);
    def->measure = false;
    double begin = bench_now_ms();
    if (status == AWT_OK) {
        status = geom_encode(s->layout, s->scratch, def, &s->frame, NULL, error);
    }
    s->encode_ms[GUIDES_KEYFRAME][s->done] = bench_now_ms() - begin;
    geom_strands_fini(&s->strands);
    begin = bench_now_ms();
    if (status == AWT_OK) {
        status = geom_receive_frame(s->binding, s->frame.bytes, s->frame.size, &s->strands, error);
    }
    s->receive_ms[GUIDES_KEYFRAME][s->done] = bench_now_ms() - begin;
    if (status == AWT_OK) {
        take(s, GUIDES_KEYFRAME, &stats, points);
    }
    return status;
}

/* Against nothing, or against the frame before; `now` is made again, which takes its time. */
static awt_status measure_numbers(guides_subject *s, int kind, const geom_frame_def *frame, const float *points,
                                  awt_error *error)
{
    const geom_quantise_def quantise = {.points = frame->points, .frames = frame->frames};
    geom_delta_def def = {.base = kind == GUIDES_DELTA ? s->base : NULL,
                          .now = s->now,
                          .base_sequence = kind == GUIDES_DELTA ? s->taken : 0,
                          .sequence = s->taken + 1,
                          .head = frame->head,
                          .time_us = frame->time_us,
                          .measure = true};
    geom_frame_stats stats;
    uint32_t clamped = 0;
    awt_status status = geom_encode_delta(s->layout, s->scratch, &def, &s->frame, &stats, error);
    def.measure = false;
    double begin = bench_now_ms();
    if (status == AWT_OK) {
        status = geom_quantise(s->layout, &quantise, s->now, &clamped, error);
    }
    if (status == AWT_OK) {
        status = geom_encode_delta(s->layout, s->scratch, &def, &s->frame, NULL, error);
    }
    s->encode_ms[kind][s->done] = bench_now_ms() - begin;
    begin = bench_now_ms();
    if (status == AWT_OK) {
        status = geom_read_guides_delta(s->reader, s->binding, s->frame.bytes, s->frame.size, &s->base_got, s->taken,
                                        &s->got, error);
    }
    if (status == AWT_OK) {
        status = geom_guides_strands(s->binding, &s->got, &s->strands, error);
    }
    s->receive_ms[kind][s->done] = bench_now_ms() - begin;
    if (status == AWT_OK) {
        take(s, kind, &stats, points);
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

/* This frame's numbers become the base, here and at the receiver, who has them whole. */
static awt_status keep(guides_subject *s, const geom_frame_def *frame, awt_error *error)
{
    const geom_delta_def def = {.now = s->now, .sequence = s->taken + 1, .head = frame->head};
    awt_status status = geom_encode_delta(s->layout, s->scratch, &def, &s->frame, NULL, error);
    if (status == AWT_OK) {
        status =
            geom_read_guides_delta(s->reader, s->binding, s->frame.bytes, s->frame.size, NULL, 0, &s->base_got, error);
    }
    geom_quantised *swap = s->base;
    s->base = s->now;
    s->now = swap;
    s->taken++;
    return status;
}

awt_status guides_measure(guides_subject *s, const awt_forest *forest, const float *centres, const float *frames,
                          const float *points, bool measured, awt_error *error)
{
    geom_frame_def def = {
        .points = centres, .frames = frames, .head = awt_forest_head(forest), .time_us = awt_forest_time(forest)};
    const geom_quantise_def quantise = {.points = centres, .frames = frames};
    uint32_t clamped = 0;
    awt_status status = geom_quantise(s->layout, &quantise, s->now, &clamped, error);
    if (measured && status == AWT_OK) {
        status = measure_keyframe(s, &def, points, error);
    }
    for (int kind = GUIDES_WHOLE; kind <= GUIDES_DELTA && measured && status == AWT_OK; kind++) {
        status = kind == GUIDES_DELTA && s->taken == 0 ? AWT_OK : measure_numbers(s, kind, &def, points, error);
    }
    if (measured && status == AWT_OK) {
        status = measure_nodes(s, forest, &def, error);
    }
    s->done += measured && status == AWT_OK;
    return status == AWT_OK ? keep(s, &def, error) : status;
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
        row->name = ROWS[k].name;
        row->kind = ROWS[k].kind;
        row->delta = ROWS[k].delta;
        row->position_bits = k == GUIDES_NODES ? 0 : (uint32_t)s->layout->box.bits;
        row->turn_bits = k == GUIDES_NODES ? 0 : (uint32_t)s->layout->attributes.turn_bits;
        row->nodes /= s->done;
        row->bytes /= s->done;
        row->entropy_bits /= s->done;
        row->mean_error_mm /= s->done;
        row->encode_ms = median(s->encode_ms[k], s->done);
        row->receive_ms = median(s->receive_ms[k], s->done);
    }
}
