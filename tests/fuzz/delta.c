/* delta.c: deltas of strands to a frame that is always the same, grown where it is first asked for. Its numbers are
 * checked twice (proto/DELTAS.md); what is taken for right must be finite, and no farther away than hair. */
#include "fuzz/fuzz.h"

#include "awt.h"
#include "base/assert.h"
#include "geom/encode.h"
#include "geom/read.h"

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
    float *centres = malloc(7 * (size_t)info.finest_nodes * sizeof(float));
    float *scratch = malloc((awt_groom_strand_scratch(groom) + 1) * sizeof(float));
    hair.points = malloc(3 * hair.count * sizeof(float));
    ASSERT(centres && scratch && hair.points && awt_forest_create(groom, &def, &forest, NULL) == AWT_OK);
    float *frames = centres + 3 * (size_t)info.finest_nodes;
    awt_forest_guides(forest, centres, frames);
    awt_groom_strands(groom, centres, frames, scratch, hair.points);
    awt_forest_destroy(forest);
    free(centres);
    free(scratch);
}

static void quantise(geom_quantised *out)
{
    uint32_t clamped = 0;
    const geom_quantise_def def = {.points = hair.points};
    ASSERT(geom_quantise(hair.layout, &def, out, &clamped, NULL) == AWT_OK);
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
    awt_groom_destroy(groom);
    ASSERT(geom_scratch_create(hair.layout, &hair.scratch, NULL) == AWT_OK);
    ASSERT(geom_quantised_create(hair.layout, &hair.base, NULL) == AWT_OK);
    ASSERT(geom_quantised_create(hair.layout, &hair.now, NULL) == AWT_OK);
    ASSERT(geom_delta_reader_create(&hair.reader, NULL) == AWT_OK);
    quantise(hair.base);
    const geom_frame_def def = {.quantised = hair.base, .head = HEAD};
    ASSERT(geom_encode(hair.layout, hair.scratch, &def, &whole, NULL, NULL) == AWT_OK);
    ASSERT(geom_read_frame(whole.bytes, whole.size, &hair.frame, NULL) == AWT_OK);
    geom_buffer_fini(&whole);
}

void fuzz_run_delta(const uint8_t *bytes, size_t size)
{
    make_hair();
    if (geom_read_delta(hair.reader, bytes, size, &hair.frame, SEQUENCE, &hair.out, NULL) == AWT_OK) {
        for (size_t i = 0; i < 3 * hair.count; i++) {
            ASSERT(isfinite(hair.out.positions[i]) && fabsf(hair.out.positions[i]) < 10);
        }
    }
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
        for (size_t i = from; i < 3 * hair.count; i++) {
            hair.points[i] -= reaches[n] * (float)(i % 8) * 0.125f;
        }
    }
    geom_buffer_fini(&delta);
}
