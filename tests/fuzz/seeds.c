/* seeds.c: inputs that are right, small, made here: what the fuzzer begins from. */
#include "fuzz/fuzz.h"

#include "awt.h"
#include "base/assert.h"
#include "base/bytes.h"
#include "geom/encode.h"
#include "unit/proto_fill.h"

#include <stdlib.h>
#include <string.h>

enum { SEED_STRANDS = 24, SEED_POINTS = 6 };

/* ---- strand files: strands from a ball, in each layout ---- */

/* Writes floats of strand points; `width` 3, or 4 with w. Bytes written. */
static size_t put_strands(unsigned char *to, size_t width)
{
    awt_strands grown;
    size_t at = 0;
    ASSERT(awt_style_grow(awt_style_find("short"), SEED_STRANDS, 1, &grown, NULL) == AWT_OK);
    for (uint32_t s = 0; s < SEED_STRANDS; s++) {
        for (uint32_t p = 0; p < SEED_POINTS; p++) {
            const float *from = grown.positions + 3 * (size_t)(grown.first_point[s] + p);
            for (size_t k = 0; k < width; k++, at += 4) {
                store_f32(to + at, k < 3 ? from[k] : p == 0 ? 0.0f : 1.0f);
            }
        }
    }
    awt_strands_fini(&grown);
    return at;
}

void fuzz_seed_strands(void (*give)(const void *bytes, size_t size))
{
    unsigned char bytes[512 + SEED_STRANDS * SEED_POINTS * 16] = "HAIR";
    store_u32(bytes + 4, SEED_STRANDS);
    store_u32(bytes + 8, SEED_STRANDS * SEED_POINTS);
    store_u32(bytes + 12, 2);
    store_u32(bytes + 16, SEED_POINTS - 1);
    give(bytes, 128 + put_strands(bytes + 128, 3));
    for (int version = 3; version <= 4; version++) {
        const size_t header = version == 4 ? 160 : 296;
        memset(bytes, 0, sizeof bytes);
        store_f32(bytes, (float)version);
        store_u32(bytes + 4, SEED_STRANDS);
        store_u32(bytes + 8, SEED_POINTS);
        store_u32(bytes + (version == 4 ? 12 : 144), (uint32_t)header);
        give(bytes, header + put_strands(bytes + header, version == 4 ? 4 : 3));
    }
}

/* ---- text ---- */

static void give_text(void (*give)(const void *bytes, size_t size), const char *text)
{
    give(text, strlen(text));
}

void fuzz_seed_hierarchy(void (*give)(const void *bytes, size_t size))
{
    give_text(give, "# wisps\n0 0 0\n0 0 1\n0,1,2\n1;2;3\n\t1 2 4 # last\n");
}

void fuzz_seed_motion(void (*give)(const void *bytes, size_t size))
{
    give_text(give,
              "HIERARCHY\nROOT Hips\n{\n OFFSET 0 90 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation "
              "Xrotation Yrotation\n JOINT Head\n {\n  OFFSET 0 60 0\n  CHANNELS 3 Zrotation Xrotation Yrotation\n"
              "  End Site\n  {\n   OFFSET 0 10 0\n  }\n }\n}\nMOTION\nFrames: 3\nFrame Time: 0.0166667\n"
              "0 90 0 0 0 0 0 0 0\n1 90 0 0 5 0 0 9 0\n2 91 0 0 9 0 -3 12 1e1\n");
    give_text(give,
              "timestamp,x,y,z,qx,qy,qz,qw\n0,0,1.6,0,0,0,0,1\n10,0.01,1.6,0,0,0.02,0,1\n20,0.03,1.6,0,0,0.05,0,1\n");
    give_text(give,
              "ViewIndex,Timestamp,PositionX,PositionY,PositionZ,QuaternionX,QuaternionY,QuaternionZ,QuaternionW\n"
              "0,1000,0,1.6,0,0,0,0,1\n1,1000,0.06,1.6,0,0,0,0,1\n0,1011,0.1,1.6,0,0,0.1,0,0.99\n"
              "1,1011,0.16,1.6,0,0,0.1,0,0.99\n");
}

void fuzz_seed_json(void (*give)(const void *bytes, size_t size))
{
    give_text(give, "{\"a\":[1,-2.5e-3,true,null,{\"b\":\"\\u00e9\\\"\"}],\"c\":{\"d\":[]},\"e\":\"\"}");
}

/* ---- messages: two of every type ---- */

void fuzz_seed_message(void (*give)(const void *bytes, size_t size))
{
    static proto_message message;
    rng random = rng_seed(1);
    for (size_t i = 0; proto_layout_at(i); i++) {
        for (uint32_t room = 0; room <= 5; room += 5) {
            proto_fill(&message, proto_layout_at(i), (fill_sizes){room, room, room}, &random);
            const size_t size = proto_encoded_size(&message);
            unsigned char *bytes = malloc(size);
            ASSERT(bytes && proto_encode(&message, bytes, size) == size);
            give(bytes, size);
            free(bytes);
        }
    }
}

/* ---- state and frames of a small head ---- */

static awt_groom *seed_groom(const char *style_name)
{
    const awt_style *style = awt_style_find(style_name);
    awt_groom_def def = awt_groom_def_of_style(style);
    awt_strands grown;
    awt_groom *groom;
    def.finest_wisps = 8;
    def.top_wisps = 2;
    def.points_per_strand = SEED_POINTS;
    ASSERT(awt_style_grow(style, SEED_STRANDS, 1, &grown, NULL) == AWT_OK);
    ASSERT(awt_groom_build(&grown, &def, NULL, NULL, &groom, NULL) == AWT_OK);
    awt_strands_fini(&grown);
    return groom;
}

static awt_forest *seed_forest(const awt_groom *groom, const char *style_name)
{
    awt_forest_def def = awt_forest_def_default(groom);
    awt_forest *forest;
    def.params = awt_style_find(style_name)->params;
    def.params.split_threshold = 0.01f;
    ASSERT(awt_forest_create(groom, &def, &forest, NULL) == AWT_OK);
    for (int n = 1; n <= 20; n++) {
        awt_motion m = {
            .time_us = n * AWT_STEP_US, .head = {.orientation = {0, 0, 0, 1}}, .body = {.orientation = {0, 0, 0, 1}}};
        m.head.position[0] = 0.002 * n * n;
        ASSERT(awt_forest_move(forest, &m, NULL) == AWT_OK);
        ASSERT(n > 18 || awt_forest_advance(forest, m.time_us, NULL, NULL) == AWT_OK); /* two wait */
    }
    return forest;
}

void fuzz_seed_snapshot(void (*give)(const void *bytes, size_t size))
{
    static const char *const styles[] = {"short", "long-curly"};
    for (size_t k = 0; k < sizeof styles / sizeof styles[0]; k++) {
        awt_groom *groom = seed_groom(styles[k]);
        awt_forest *forest = seed_forest(groom, styles[k]);
        size_t size;
        awt_forest_snapshot(forest, NULL, 0, &size, NULL);
        unsigned char *bytes = malloc(size);
        ASSERT(bytes && awt_forest_snapshot(forest, bytes, size, &size, NULL) == AWT_OK);
        give(bytes, size);
        free(bytes);
        awt_forest_destroy(forest);
        awt_groom_destroy(groom);
    }
}

static void give_frame(void (*give)(const void *bytes, size_t size), const awt_groom *groom,
                       const geom_layout_def *kind, const float *points)
{
    const geom_frame_def def = {.points = points, .head = {.orientation = {0, 0, 0, 1}}};
    geom_layout *layout;
    geom_scratch *scratch;
    geom_buffer frame = {0};
    geom_frame_stats stats;
    ASSERT(geom_layout_create(groom, kind, &layout, NULL) == AWT_OK);
    ASSERT(geom_scratch_create(layout, &scratch, NULL) == AWT_OK);
    ASSERT(geom_encode(layout, scratch, &def, &frame, &stats, NULL) == AWT_OK);
    give(frame.bytes, frame.size);
    geom_buffer_fini(&frame);
    geom_scratch_destroy(scratch);
    geom_layout_destroy(layout);
}

void fuzz_seed_frame(void (*give)(const void *bytes, size_t size))
{
    awt_groom *groom = seed_groom("long");
    awt_forest *forest = seed_forest(groom, "long");
    awt_groom_info info;
    awt_groom_get_info(groom, &info);
    float *centres = malloc(7 * (size_t)info.finest_nodes * sizeof(float)), *frames = centres + 3 * info.finest_nodes;
    float *scratch = malloc((awt_groom_strand_scratch(groom) + 1) * sizeof(float));
    float *points = malloc(3 * (size_t)info.strand_count * info.points_per_strand * sizeof(float));
    ASSERT(centres && scratch && points);
    awt_forest_guides(forest, centres, frames);
    awt_groom_strands(groom, centres, frames, scratch, points);
    for (int k = 0; k < 4; k++) {
        give_frame(give, groom, &(geom_layout_def){.kind = k % 2 ? GEOM_STRANDS : GEOM_RIBBON, .stock = k > 1}, points);
    }
    free(centres);
    free(scratch);
    free(points);
    awt_forest_destroy(forest);
    awt_groom_destroy(groom);
}
