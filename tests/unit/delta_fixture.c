/* delta_fixture.c: see delta_fixture.h. */
#include "unit/delta_fixture.h"

#include "base/assert.h"
#include "base/trig.h"
#include "check.h"

#include <stdlib.h>
#include <string.h>

static size_t floats_of(const delta_fixture *f)
{
    return (size_t)f->hair.groom.info.strand_count * f->hair.groom.info.points_per_strand * 3;
}

static void quantise(delta_fixture *f, geom_quantised *out)
{
    uint32_t clamped = 0;
    const geom_quantise_def def = {.points = f->hair.points};
    CHECK_INT(geom_quantise(f->hair.layout, &def, out, &clamped, NULL), AWT_OK);
}

void delta_fixture_init(delta_fixture *f, uint32_t strands, uint32_t per_strand, uint32_t trees, int bits)
{
    *f = (delta_fixture){.base_sequence = 41, .time_us = GEOM_FIXTURE_TIME_US};
    geom_fixture_init(&f->hair, strands, per_strand, trees);
    geom_fixture_layout(&f->hair, &(geom_layout_def){.kind = GEOM_STRANDS, .bits = bits});
    f->base_points = malloc(floats_of(f) * sizeof *f->base_points);
    CHECK_INT(geom_quantised_create(f->hair.layout, &f->base, NULL), AWT_OK);
    CHECK_INT(geom_quantised_create(f->hair.layout, &f->now, NULL), AWT_OK);
    CHECK_INT(geom_delta_reader_create(&f->reader, NULL), AWT_OK);
    ASSERT(f->base_points && f->base && f->now && f->reader);
    memcpy(f->base_points, f->hair.points, floats_of(f) * sizeof *f->base_points);
    quantise(f, f->base);
    quantise(f, f->now);
}

void delta_fixture_fini(delta_fixture *f)
{
    geom_quantised_destroy(f->base);
    geom_quantised_destroy(f->now);
    geom_delta_reader_destroy(f->reader);
    geom_buffer_fini(&f->whole);
    geom_buffer_fini(&f->delta);
    free(f->base_points);
    geom_fixture_fini(&f->hair);
    *f = (delta_fixture){0};
}

static void move_strand(delta_fixture *f, uint32_t strand, float reach_m)
{
    const uint32_t per_strand = f->hair.groom.info.points_per_strand;
    float *p = f->hair.points + (size_t)strand * per_strand * 3;
    for (uint32_t i = 1; i < per_strand; i++) {
        double t = (double)i / (double)(per_strand - 1), sine, cosine;
        trig_sin_cos(0.02 * strand + 2 * t + f->moves, &sine, &cosine);
        p[3 * i] += reach_m * (float)(t * sine);
        p[3 * i + 1] += reach_m * (float)(t * t * cosine);
        p[3 * i + 2] += reach_m * (float)(t * cosine);
    }
}

void delta_fixture_move(delta_fixture *f, float reach_m, const bool *still)
{
    geom_quantised *swap = f->base;
    f->base = f->now;
    f->now = swap;
    f->moves++;
    f->time_us += 16667;
    memcpy(f->base_points, f->hair.points, floats_of(f) * sizeof *f->base_points);
    for (uint32_t i = 0; i < geom_layout_patches(f->hair.layout); i++) {
        const geom_patch patch = geom_layout_patch(f->hair.layout, i);
        for (uint32_t s = 0; s < patch.strands && !(still && still[i]); s++) {
            move_strand(f, patch.first_strand + s, reach_m);
        }
    }
    quantise(f, f->now);
}

void delta_fixture_to_base(delta_fixture *f)
{
    memcpy(f->hair.points, f->base_points, floats_of(f) * sizeof *f->base_points);
    quantise(f, f->now);
}

void delta_fixture_encode(delta_fixture *f, geom_frame_stats *stats)
{
    awt_error error = {0};
    const geom_delta_def def = {.base = f->base,
                                .now = f->now,
                                .base_sequence = f->base_sequence,
                                .sequence = f->base_sequence + 1,
                                .head = geom_fixture_head,
                                .time_us = f->time_us};
    CHECK_INT(geom_encode_delta(f->hair.layout, f->hair.scratch, &def, &f->delta, stats, &error), AWT_OK);
    CHECK_TEXT(error.text, "");
}

awt_status delta_fixture_read(delta_fixture *f, const geom_strands *base, geom_strands *out)
{
    awt_error error = {0};
    unsigned char *copy = malloc(f->delta.size);
    ASSERT(copy);
    memcpy(copy, f->delta.bytes, f->delta.size);
    awt_status status = geom_read_delta(f->reader, copy, f->delta.size, base, f->base_sequence, out, &error);
    CHECK((status == AWT_OK) == (error.text[0] == '\0'));
    free(copy);
    return status;
}
