/* encode_delta.c: every frame becomes whole numbers; from time to time the deltas to the one before and to the third
 * one before are made and read, by us and by libdraco. */
#include "bench/bench.h"
#include "bench/encode_delta.h"

#include "base/error.h"
#include "geom/buffer.h"
#include "geom/cloud_shim.h"
#include "geom/delta_format.h"
#include "geom/delta_glb.h"
#include "geom/layout.h"
#include "quantile.h"

#include <math.h>
#include <stdlib.h>

enum { RING = 4, REPEATS = 3 };

static const uint32_t AGES[ENCODE_BASES] = {1, 3};

/* What was measured of one base and moving. */
typedef struct tally {
    double *encode_ms, *stock_encode_ms, *decode_ms, *stock_decode_ms; /* [frames] */
    double bytes, stock_bytes, entropy_bits, error_m;                  /* sums, and the greatest */
} tally;

struct delta_subject {
    geom_layout *layout;
    geom_scratch *scratch;
    geom_delta_reader *reader;
    geom_quantised *ring[RING], *now;
    uint32_t taken, done;
    bool *unchanged;
    int16_t *numbers; /* of the largest patch */
    geom_buffer whole, delta, stock;
    geom_strands base, out;
    tally tallies[ENCODE_DELTA_ROWS];
};

static bool make_arrays(delta_subject *s, uint32_t frames)
{
    bool made = true;
    for (int row = 0; row < ENCODE_DELTA_ROWS; row++) {
        tally *t = &s->tallies[row];
        double **times[] = {&t->encode_ms, &t->stock_encode_ms, &t->decode_ms, &t->stock_decode_ms};
        for (size_t k = 0; k < sizeof times / sizeof times[0]; k++) {
            made = (*times[k] = calloc(frames, sizeof(double))) && made;
        }
    }
    s->unchanged = calloc(s->layout->patch_count, sizeof *s->unchanged);
    s->numbers = calloc((size_t)s->layout->largest_patch * s->layout->points_per_strand, 3 * sizeof *s->numbers);
    return made && s->unchanged && s->numbers;
}

awt_status delta_subject_create(const awt_groom *groom, uint32_t frames, delta_subject **out, awt_error *error)
{
    delta_subject *s = calloc(1, sizeof *s);
    *out = s;
    if (!s) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    awt_status status = geom_layout_create(groom, &(geom_layout_def){.kind = GEOM_STRANDS}, &s->layout, error);
    if (status == AWT_OK) {
        status = geom_scratch_create(s->layout, &s->scratch, error);
    }
    for (int k = 0; k <= RING && status == AWT_OK; k++) {
        status = geom_quantised_create(s->layout, k < RING ? &s->ring[k] : &s->now, error);
    }
    if (status == AWT_OK) {
        status = geom_delta_reader_create(&s->reader, error);
    }
    return status == AWT_OK && !make_arrays(s, frames) ? error_set(error, AWT_NO_MEMORY, NULL) : status;
}

void delta_subject_destroy(delta_subject *s)
{
    if (!s) {
        return;
    }
    for (int row = 0; row < ENCODE_DELTA_ROWS; row++) {
        free(s->tallies[row].encode_ms);
        free(s->tallies[row].stock_encode_ms);
        free(s->tallies[row].decode_ms);
        free(s->tallies[row].stock_decode_ms);
    }
    for (int k = 0; k < RING; k++) {
        geom_quantised_destroy(s->ring[k]);
    }
    geom_quantised_destroy(s->now);
    geom_delta_reader_destroy(s->reader);
    geom_scratch_destroy(s->scratch);
    geom_layout_destroy(s->layout);
    geom_buffer_fini(&s->whole);
    geom_buffer_fini(&s->delta);
    geom_buffer_fini(&s->stock);
    geom_strands_fini(&s->base);
    geom_strands_fini(&s->out);
    free(s->unchanged);
    free(s->numbers);
    free(s);
}

/* ---- one delta */

/* Points to GLB, the least of a few times. */
static awt_status time_own(delta_subject *s, const geom_quantise_def *quantise, geom_delta_def *def, tally *t,
                           awt_error *error)
{
    double best = INFINITY;
    geom_frame_stats stats = {0};
    awt_status status = AWT_OK;
    for (int n = 0; n <= REPEATS && status == AWT_OK; n++) {
        uint32_t clamped = 0;
        double begin = bench_now_ms();
        def->measure = n == REPEATS; /* not timed */
        status = geom_quantise(s->layout, quantise, s->now, &clamped, error);
        if (status == AWT_OK) {
            status = geom_encode_delta(s->layout, s->scratch, def, &s->delta, &stats, error);
        }
        best = n < REPEATS ? fmin(best, bench_now_ms() - begin) : best;
    }
    t->encode_ms[s->done] = best;
    t->bytes += (double)s->delta.size;
    t->entropy_bits += stats.entropy_bits;
    return status;
}

/* The clouds of the delta into libdraco, and the numbers in them back into clouds. */
static awt_status time_stock(delta_subject *s, tally *t, awt_error *error)
{
    delta_glb glb;
    delta_header header = {0};
    awt_status status = delta_glb_read(s->delta.bytes, s->delta.size, &glb, error);
    if (status != AWT_OK) {
        return status;
    }
    codec block = codec_reading(glb.block, glb.size);
    delta_header_walk(&block, &header);
    size_t cloud = block.at + (size_t)header.patches * DELTA_ENTRY_BYTES;
    double encode_ms = 0, decode_ms = 0;
    for (uint32_t i = 0; i < header.patches && status == AWT_OK; i++) {
        delta_entry entry = {0};
        delta_entry_walk(&block, &entry);
        const uint32_t points = entry.strands * header.points_per_strand;
        s->stock.size = 0;
        double begin = bench_now_ms();
        status = cloud_shim_decode(glb.block + cloud, entry.size, points, 3, s->numbers, error);
        double middle = bench_now_ms();
        if (status == AWT_OK) {
            status = cloud_shim_encode(s->numbers, points, 3, &s->stock, error);
        }
        encode_ms += bench_now_ms() - middle;
        decode_ms += middle - begin;
        t->stock_bytes += (double)s->stock.size;
        cloud += entry.size;
    }
    t->stock_encode_ms[s->done] = encode_ms;
    t->stock_decode_ms[s->done] = decode_ms;
    return status;
}

static double greatest_error(const delta_subject *s, const float *points)
{
    double greatest = 0;
    for (size_t i = 0; i < (size_t)s->layout->strands * s->layout->points_per_strand; i++) {
        double square = 0;
        for (size_t k = 0; k < 3; k++) {
            double off = (double)s->out.positions[3 * i + k] - (double)points[3 * i + k];
            square += off * off;
        }
        greatest = square > greatest ? square : greatest;
    }
    return sqrt(greatest);
}

static awt_status measure_delta(delta_subject *s, const geom_quantise_def *quantise, geom_delta_def *def, int base,
                                int moving, awt_error *error)
{
    tally *t = &s->tallies[base * ENCODE_MOVINGS + moving];
    awt_status status = time_own(s, quantise, def, t, error);
    if (status == AWT_OK) {
        status = time_stock(s, t, error);
    }
    if (status == AWT_OK) {
        double begin = bench_now_ms();
        status = geom_read_delta(s->reader, s->delta.bytes, s->delta.size, &s->base, 0, &s->out, error);
        t->decode_ms[s->done] = bench_now_ms() - begin;
    }
    if (status == AWT_OK && moving == ENCODE_ALL) {
        t->error_m = fmax(t->error_m, greatest_error(s, quantise->points));
    }
    return status;
}

/* What a receiver has that the base came to whole. */
static awt_status make_base(delta_subject *s, const geom_delta_def *def, awt_error *error)
{
    const geom_frame_def whole = {.quantised = def->base, .head = def->head};
    geom_strands_fini(&s->base);
    awt_status status = geom_encode(s->layout, s->scratch, &whole, &s->whole, NULL, error);
    return status == AWT_OK ? geom_read_frame(s->whole.bytes, s->whole.size, &s->base, error) : status;
}

awt_status delta_subject_frame(delta_subject *s, const float *points, const awt_pose *head, int64_t time_us,
                               bool measure, awt_error *error)
{
    awt_status status = AWT_OK;
    const bool measured = measure && s->taken >= AGES[ENCODE_BASES - 1];
    for (int base = 0; base < ENCODE_BASES && measured; base++) {
        geom_quantise_def quantise = {.points = points, .previous = s->ring[(s->taken - AGES[base]) % RING]};
        geom_delta_def def = {.base = quantise.previous, .now = s->now, .head = *head, .time_us = time_us};
        status = make_base(s, &def, error);
        for (int moving = ENCODE_ALL; moving < ENCODE_MOVINGS && status == AWT_OK; moving++) {
            for (uint32_t i = 0; i < s->layout->patch_count; i++) {
                s->unchanged[i] = moving == ENCODE_NONE || i % 4 != 0;
            }
            quantise.unchanged = moving == ENCODE_ALL ? NULL : s->unchanged;
            status = measure_delta(s, &quantise, &def, base, moving, error);
        }
        if (status != AWT_OK) {
            return status;
        }
    }
    s->done += measured;
    uint32_t clamped = 0;
    const geom_quantise_def quantise = {.points = points};
    return geom_quantise(s->layout, &quantise, s->ring[s->taken++ % RING], &clamped, error);
}

/* ---- all of them */

static double median(double *values, uint32_t count)
{
    quantile_sort(values, count);
    return quantile_at(values, count, 0.5);
}

void delta_subject_rows(delta_subject *s, encode_row rows[ENCODE_DELTA_ROWS])
{
    const size_t points = (size_t)s->layout->strands * s->layout->points_per_strand;
    const double all = (double)points * (s->done > 0 ? s->done : 1);
    for (int row = 0; row < ENCODE_DELTA_ROWS; row++) {
        tally *t = &s->tallies[row];
        rows[row] = (encode_row){.kind = GEOM_STRANDS,
                                 .moving = (encode_moving)(row % ENCODE_MOVINGS),
                                 .base_age = AGES[row / ENCODE_MOVINGS],
                                 .quantisation_bits = s->layout->box.bits,
                                 .patches = s->layout->patch_count,
                                 .points = points,
                                 .encode_ms = median(t->encode_ms, s->done),
                                 .stock_encode_ms = median(t->stock_encode_ms, s->done),
                                 .bytes_per_point = t->bytes / all,
                                 .stock_bytes_per_point = t->stock_bytes / all,
                                 .entropy_bits_per_point = t->entropy_bits / all,
                                 .max_error_mm = s->tallies[row - row % ENCODE_MOVINGS].error_m * 1e3,
                                 .decode_ms = median(t->decode_ms, s->done),
                                 .stock_decode_ms = median(t->stock_decode_ms, s->done),
                                 .scratch_bytes = geom_scratch_bytes(s->scratch)};
    }
}
