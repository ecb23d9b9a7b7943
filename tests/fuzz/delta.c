/* delta.c: deltas of strands and of guides to frames that are always the same, grown where they are first asked for.
 * Their numbers are checked twice (proto/DELTAS.md); what is taken for right must be finite, and no farther away than
 * hair. */
#include "fuzz/fuzz.h"

#include "awt.h"
#include "base/assert.h"
#include "geom/encode.h"
#include "geom/receive.h"

#include <math.h>
#include <stdlib.h>

enum { STRANDS = 60, POINTS = 8, SEEDS = 4, SEQUENCE = 7 };
#define HEAD ((awt_pose){.orientation = {0, 0, 0, 1}})

/* The frame that is always the same. */
static struct {
    float *points;
    size_t count; /* strand points */
    geom_layout *layout;
    geom_scratch *scratch;
    geom_quantised *base, *now;
    geom_delta_reader *reader;
    geom_strands frame, out;
} hair;

/* The same as sections. */
static struct {
    float *centres, *frames;
    size_t count; /* sections */
    geom_layout *layout;
    geom_scratch *scratch;
    geom_quantised *base, *now;
    geom_binding *binding;
    geom_guides frame, out;
} guides;

static awt_groom *grow(void)
{
    const awt_style *style = awt_style_find("long");
    awt_groom_def def = awt_groom_def_of_style(style);
    awt_strands strands;
    awt_groom *groom = NULL;
    def.points_per_strand = POINTS;
    ASSERT(awt_style_grow(style, STRANDS, 1, &strands, NULL) == AWT_OK);
    ASSERT(awt_groom_build(&strands, &def, NULL, NULL, &groom, NULL) == AWT_OK);
    awt_strands_fini(&strands);
    return groom;
}

/* The points of hair as it was grown. */
static void place(const awt_groom *groom)
{
    awt_groom_info info;
    awt_forest *forest = NULL;
    const awt_forest_def def = awt_forest_def_default(groom);
    awt_groom_get_info(groom, &info);
    hair.count = (size_t)info.strand_count * info.points_per_strand;
    guides.count = info.finest_nodes;
    guides.centres = malloc(3 * guides.count * sizeof(float));
    guides.frames = malloc(4 * guides.count * sizeof(float));
    float *scratch = malloc((awt_groom_strand_scratch(groom) + 1) * sizeof(float));
    hair.points = malloc(3 * hair.count * sizeof(float));
    ASSERT(guides.centres && guides.frames && scratch && hair.points);
    ASSERT(awt_forest_create(groom, &def, &forest, NULL) == AWT_OK);
    awt_forest_guides(forest, guides.centres, guides.frames);
    awt_groom_strands(groom, guides.centres, guides.frames, scratch, hair.points);
    awt_forest_destroy(forest);
    free(scratch);
}

static void quantise(geom_quantised *out)
{
    uint32_t clamped = 0;
    const geom_quantise_def def = {.points = hair.points};
    ASSERT(geom_quantise(hair.layout, &def, out, &clamped, NULL) == AWT_OK);
}

static void quantise_guides(geom_quantised *out)
{
    uint32_t clamped = 0;
    const geom_quantise_def def = {.points = guides.centres, .frames = guides.frames};
    ASSERT(geom_quantise(guides.layout, &def, out, &clamped, NULL) == AWT_OK);
}

/* Sections go apart, some or all of them, and come back. */
static void shift(float reach_m, size_t from)
{
    for (size_t i = from; i < 3 * guides.count; i++) {
        guides.centres[i] += reach_m * (float)(i % 8) * 0.125f;
    }
}

/* The base is no hair at rest, of which all numbers are 0. */
static void make_guides(const awt_groom *groom)
{
    size_t size;
    ASSERT(geom_binding_write(groom, NULL, 0, &size, NULL) == AWT_OK);
    unsigned char *bytes = malloc(size);
    ASSERT(bytes && geom_binding_write(groom, bytes, size, &size, NULL) == AWT_OK);
    ASSERT(geom_binding_read(bytes, size, &guides.binding, NULL) == AWT_OK);
    free(bytes);
    ASSERT(geom_layout_create(groom, &(geom_layout_def){.kind = GEOM_GUIDES}, &guides.layout, NULL) == AWT_OK);
    ASSERT(geom_scratch_create(guides.layout, &guides.scratch, NULL) == AWT_OK);
    ASSERT(geom_quantised_create(guides.layout, &guides.base, NULL) == AWT_OK);
    ASSERT(geom_quantised_create(guides.layout, &guides.now, NULL) == AWT_OK);
    shift(0.01f, 0);
    quantise_guides(guides.base);
    const geom_delta_def whole = {.now = guides.base, .sequence = SEQUENCE, .head = HEAD};
    geom_buffer frame = {0};
    ASSERT(geom_encode_delta(guides.layout, guides.scratch, &whole, &frame, NULL, NULL) == AWT_OK);
    ASSERT(geom_read_guides_delta(hair.reader, guides.binding, frame.bytes, frame.size, NULL, 0, &guides.frame, NULL) ==
           AWT_OK);
    geom_buffer_fini(&frame);
}

static void make_hair(void)
{
    geom_buffer whole = {0};
    if (hair.points) {
        return;
    }
    awt_groom *groom = grow();
    place(groom);
    ASSERT(geom_layout_create(groom, &(geom_layout_def){.kind = GEOM_STRANDS}, &hair.layout, NULL) == AWT_OK);
    ASSERT(geom_scratch_create(hair.layout, &hair.scratch, NULL) == AWT_OK);
    ASSERT(geom_quantised_create(hair.layout, &hair.base, NULL) == AWT_OK);
    ASSERT(geom_quantised_create(hair.layout, &hair.now, NULL) == AWT_OK);
    ASSERT(geom_delta_reader_create(&hair.reader, NULL) == AWT_OK);
    quantise(hair.base);
    const geom_frame_def def = {.quantised = hair.base, .head = HEAD};
    ASSERT(geom_encode(hair.layout, hair.scratch, &def, &whole, NULL, NULL) == AWT_OK);
    ASSERT(geom_read_frame(whole.bytes, whole.size, &hair.frame, NULL) == AWT_OK);
    geom_buffer_fini(&whole);
    make_guides(groom);
    awt_groom_destroy(groom);
}

void fuzz_run_delta(const uint8_t *bytes, size_t size)
{
    make_hair();
    if (geom_read_delta(hair.reader, bytes, size, &hair.frame, SEQUENCE, &hair.out, NULL) == AWT_OK) {
        for (size_t i = 0; i < 3 * hair.count; i++) {
            ASSERT(isfinite(hair.out.positions[i]) && fabsf(hair.out.positions[i]) < 10);
        }
    }
    if (geom_read_guides_delta(hair.reader, guides.binding, bytes, size, &guides.frame, SEQUENCE, &guides.out, NULL) ==
        AWT_OK) {
        ASSERT(geom_guides_strands(guides.binding, &guides.out, &hair.out, NULL) == AWT_OK);
        for (size_t i = 0; i < 3 * hair.count; i++) {
            ASSERT(isfinite(hair.out.positions[i]) && fabsf(hair.out.positions[i]) < 10);
        }
    }
}

/* Whole, and to the base. */
static void seed_guides(float reach_m, size_t from, void (*give)(const void *bytes, size_t size))
{
    geom_buffer frame = {0};
    shift(reach_m, from);
    quantise_guides(guides.now);
    shift(-reach_m, from);
    for (int whole = 0; whole < 2; whole++) {
        const geom_delta_def def = {.base = whole ? NULL : guides.base,
                                    .now = guides.now,
                                    .base_sequence = whole ? 0 : SEQUENCE,
                                    .sequence = SEQUENCE + 1,
                                    .head = HEAD,
                                    .time_us = 16667};
        ASSERT(geom_encode_delta(guides.layout, guides.scratch, &def, &frame, NULL, NULL) == AWT_OK);
        give(frame.bytes, frame.size);
    }
    geom_buffer_fini(&frame);
}

/* All of it moved, some, nothing, and far. */
void fuzz_seed_delta(void (*give)(const void *bytes, size_t size))
{
    const float reaches[SEEDS] = {0.002f, 0.002f, 0, 0.3f};
    geom_buffer delta = {0};
    make_hair();
    for (int n = 0; n < SEEDS; n++) {
        const size_t from = n == 1 ? 3 * hair.count / 2 : 0;
        for (size_t i = from; i < 3 * hair.count; i++) {
            hair.points[i] += reaches[n] * (float)(i % 8) * 0.125f;
        }
        quantise(hair.now);
        const geom_delta_def def = {.base = hair.base,
                                    .now = hair.now,
                                    .base_sequence = SEQUENCE,
                                    .sequence = SEQUENCE + 1,
                                    .head = HEAD,
                                    .time_us = 16667};
        ASSERT(geom_encode_delta(hair.layout, hair.scratch, &def, &delta, NULL, NULL) == AWT_OK);
        give(delta.bytes, delta.size);
        seed_guides(reaches[n], n == 1 ? 3 * guides.count / 2 : 0, give);
        for (size_t i = from; i < 3 * hair.count; i++) {
            hair.points[i] -= reaches[n] * (float)(i % 8) * 0.125f;
        }
    }
    geom_buffer_fini(&delta);
}
