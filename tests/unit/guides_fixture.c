/* guides_fixture.c: see guides_fixture.h. */
#include "unit/guides_fixture.h"

#include "base/assert.h"
#include "check.h"
#include "unit/fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double nowhere[3] = {0, 0, 0};

static void take(guides_fixture *f)
{
    awt_forest_guides(f->forest, f->centres, f->frames);
    awt_groom_strands(f->groom, f->centres, f->frames, f->scratch, f->points);
}

/* The hair as it is becomes the base. */
static void receive_base(guides_fixture *f)
{
    geom_strands strands = {0};
    guides_fixture_encode(f, GUIDES_WHOLE, NULL);
    CHECK_INT(guides_fixture_receive(f, GUIDES_WHOLE, &strands, NULL), AWT_OK);
    geom_strands_fini(&strands);
    guides_fixture_keep(f);
}

void guides_fixture_init(guides_fixture *f, const awt_groom *groom, const char *style)
{
    *f = (guides_fixture){.groom = groom};
    awt_groom_get_info(groom, &f->info);
    if (style) {
        f->forest = fixture_forest(groom, style, nowhere, nowhere);
    } else {
        awt_forest_def def = awt_forest_def_default(groom);
        CHECK_INT(awt_forest_create(groom, &def, &f->forest, NULL), AWT_OK);
    }
    f->centres = calloc(f->info.finest_nodes, 3 * sizeof(float));
    f->frames = calloc(f->info.finest_nodes, 4 * sizeof(float));
    f->scratch = calloc(awt_groom_strand_scratch(groom), sizeof(float));
    f->points = calloc((size_t)f->info.strand_count * f->info.points_per_strand, 3 * sizeof(float));
    CHECK_INT(geom_binding_write(groom, NULL, 0, &f->binding_size, NULL), AWT_OK);
    f->binding_bytes = malloc(f->binding_size);
    ASSERT(f->forest && f->centres && f->frames && f->scratch && f->points && f->binding_bytes);
    CHECK_INT(geom_binding_write(groom, f->binding_bytes, f->binding_size, &f->binding_size, NULL), AWT_OK);
    CHECK_INT(geom_binding_read(f->binding_bytes, f->binding_size, &f->binding, NULL), AWT_OK);
    ASSERT(f->binding);
    CHECK_INT(geom_layout_create(groom, &(geom_layout_def){.kind = GEOM_GUIDES}, &f->layout, NULL), AWT_OK);
    ASSERT(f->layout);
    CHECK_INT(geom_scratch_create(f->layout, &f->encoder, NULL), AWT_OK);
    CHECK_INT(geom_quantised_create(f->layout, &f->base, NULL), AWT_OK);
    CHECK_INT(geom_quantised_create(f->layout, &f->now, NULL), AWT_OK);
    CHECK_INT(geom_delta_reader_create(&f->reader, NULL), AWT_OK);
    ASSERT(f->encoder && f->base && f->now && f->reader);
    take(f);
    receive_base(f);
}

void guides_fixture_fini(guides_fixture *f)
{
    awt_forest_destroy(f->forest);
    free(f->centres);
    free(f->frames);
    free(f->scratch);
    free(f->points);
    free(f->binding_bytes);
    geom_binding_destroy(f->binding);
    geom_scratch_destroy(f->encoder);
    geom_layout_destroy(f->layout);
    geom_quantised_destroy(f->base);
    geom_quantised_destroy(f->now);
    geom_delta_reader_destroy(f->reader);
    geom_guides_fini(&f->base_got);
    geom_guides_fini(&f->got);
    geom_buffer_fini(&f->frame);
    *f = (guides_fixture){0};
}

void guides_fixture_move(guides_fixture *f, const char *clip, int64_t time_us)
{
    fixture_advance(f->forest, fixture_clip(clip), time_us, nowhere, nowhere, NULL);
    take(f);
}

static awt_status encode_numbers(guides_fixture *f, int form, geom_frame_stats *stats, awt_error *error)
{
    const geom_quantise_def quantise = {.points = f->centres, .frames = f->frames};
    const geom_delta_def def = {.base = form == GUIDES_DELTA ? f->base : NULL,
                                .now = f->now,
                                .base_sequence = form == GUIDES_DELTA ? f->base_sequence : 0,
                                .sequence = f->base_sequence + 1,
                                .head = awt_forest_head(f->forest),
                                .time_us = awt_forest_time(f->forest)};
    geom_frame_stats made = {0};
    uint32_t clamped = 0;
    awt_status status = geom_quantise(f->layout, &quantise, f->now, &clamped, error);
    if (status == AWT_OK) {
        status = geom_encode_delta(f->layout, f->encoder, &def, &f->frame, &made, error);
    }
    made.clamped_points = clamped;
    if (stats) {
        *stats = made;
    }
    return status;
}

void guides_fixture_encode(guides_fixture *f, int form, geom_frame_stats *stats)
{
    awt_error error = {0};
    const geom_frame_def def = {.points = f->centres,
                                .frames = f->frames,
                                .head = awt_forest_head(f->forest),
                                .time_us = awt_forest_time(f->forest)};
    if (form == GUIDES_MESHES) {
        CHECK_INT(geom_encode(f->layout, f->encoder, &def, &f->frame, stats, &error), AWT_OK);
    } else {
        CHECK_INT(encode_numbers(f, form, stats, &error), AWT_OK);
    }
    CHECK_TEXT(error.text, "");
}

awt_status guides_fixture_receive(guides_fixture *f, int form, geom_strands *out, awt_error *error)
{
    unsigned char *copy = malloc(f->frame.size);
    ASSERT(copy);
    memcpy(copy, f->frame.bytes, f->frame.size);
    awt_status status;
    if (form == GUIDES_MESHES) {
        status = geom_receive_frame(f->binding, copy, f->frame.size, out, error);
    } else {
        const geom_guides *base = form == GUIDES_DELTA ? &f->base_got : NULL;
        status =
            geom_read_guides_delta(f->reader, f->binding, copy, f->frame.size, base, f->base_sequence, &f->got, error);
        status = status == AWT_OK ? geom_guides_strands(f->binding, &f->got, out, error) : status;
    }
    free(copy);
    return status;
}

void guides_fixture_keep(guides_fixture *f)
{
    geom_quantised *numbers = f->base;
    geom_guides got = f->base_got;
    f->base = f->now;
    f->now = numbers;
    f->base_got = f->got;
    f->got = got;
    f->base_sequence++;
}

void guides_fixture_compare(guides_fixture *f, int form, double *greatest_m, double *mean_m)
{
    const size_t points = (size_t)f->info.strand_count * f->info.points_per_strand;
    geom_strands back = {0};
    awt_error error = {0};
    *greatest_m = *mean_m = INFINITY;
    CHECK_INT(guides_fixture_receive(f, form, &back, &error), AWT_OK);
    CHECK_TEXT(error.text, "");
    CHECK_INT(back.strand_count, f->info.strand_count);
    CHECK_INT(back.points_per_strand, f->info.points_per_strand);
    if (back.positions) {
        double greatest = 0, sum = 0;
        for (size_t i = 0; i < 3 * points; i += 3) {
            double square = 0;
            for (size_t k = i; k < i + 3; k++) {
                const double way = (double)back.positions[k] - (double)f->points[k];
                square += way * way;
            }
            greatest = fmax(greatest, sqrt(square));
            sum += sqrt(square);
        }
        *greatest_m = greatest;
        *mean_m = sum / (double)points;
    }
    geom_strands_fini(&back);
}
