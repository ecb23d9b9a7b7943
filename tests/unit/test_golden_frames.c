/* test_golden_frames.c: the very bytes of every kind of frame of hair in a known motion, whatever compiler,
 * optimisation or vectors. A change of these numbers is a change of the bytes that go out, and is made on purpose. */
#include "check.h"
#include "fixture.h"

#include "base/assert.h"
#include "base/hash.h"
#include "geom/encode.h"

#include <stdlib.h>

enum { STRANDS = 1500, FRAMES = 12, FRAME_US = 36000 };

/* Hair and what frames are made of. */
typedef struct bowing {
    const awt_groom *groom;
    awt_forest *forest;
    float *centres, *frames, *scratch, *points;
    awt_node *nodes;
    geom_buffer frame;
    uint64_t hash; /* of all frames so far */
    int at;
} bowing;

static bowing begin(const char *style)
{
    static const double nowhere[3] = {0, 0, 0};
    bowing b = {.groom = fixture_groom(style, STRANDS), .hash = HASH_SEED};
    awt_groom_info info;
    awt_groom_get_info(b.groom, &info);
    b.forest = fixture_forest(b.groom, style, nowhere, nowhere);
    b.centres = calloc(info.finest_nodes, 3 * sizeof(float));
    b.frames = calloc(info.finest_nodes, 4 * sizeof(float));
    b.scratch = calloc(awt_groom_strand_scratch(b.groom), sizeof(float));
    b.points = calloc((size_t)info.strand_count * info.points_per_strand, 3 * sizeof(float));
    b.nodes = calloc(info.finest_nodes, sizeof *b.nodes);
    ASSERT(b.centres && b.frames && b.scratch && b.points && b.nodes);
    return b;
}

/* To the next frame, up to FRAMES of them. */
static bool move_on(bowing *b)
{
    const awt_motion m = fixture_bow((int64_t)++b->at * FRAME_US);
    CHECK_INT(awt_forest_move(b->forest, &m, NULL), AWT_OK);
    CHECK_INT(awt_forest_advance(b->forest, m.time_us, NULL, NULL), AWT_OK);
    awt_forest_guides(b->forest, b->centres, b->frames);
    return b->at <= FRAMES;
}

static void add_frame(bowing *b)
{
    CHECK(b->frame.size > 500);
    b->hash = hash_words(b->hash, b->frame.bytes, b->frame.size / 4);
}

static uint64_t end(bowing *b)
{
    const uint64_t hash = b->hash;
    awt_forest_destroy(b->forest);
    free(b->centres);
    free(b->frames);
    free(b->scratch);
    free(b->points);
    free(b->nodes);
    geom_buffer_fini(&b->frame);
    return hash;
}

static geom_layout *make_layout(const bowing *b, const geom_layout_def *def, geom_scratch **scratch)
{
    geom_layout *layout = NULL;
    CHECK_INT(geom_layout_create(b->groom, def, &layout, NULL), AWT_OK);
    ASSERT(layout);
    CHECK_INT(geom_scratch_create(layout, scratch, NULL), AWT_OK);
    ASSERT(*scratch);
    return layout;
}

/* Of guides their sections, else strands. */
static const float *take_points(bowing *b, const geom_layout *layout, geom_kind kind)
{
    if (kind != GEOM_GUIDES) {
        geom_layout_evaluate(layout, b->groom, NULL, b->centres, b->frames, b->scratch, b->points);
    }
    return kind == GEOM_GUIDES ? b->centres : b->points;
}

static uint64_t hash_whole(const char *style, const geom_layout_def *def)
{
    bowing b = begin(style);
    geom_scratch *scratch = NULL;
    geom_layout *layout = make_layout(&b, def, &scratch);
    while (move_on(&b)) {
        const geom_frame_def frame = {.points = take_points(&b, layout, def->kind),
                                      .frames = b.frames,
                                      .head = awt_forest_head(b.forest),
                                      .time_us = awt_forest_time(b.forest)};
        geom_frame_stats stats;
        CHECK_INT(geom_encode(layout, scratch, &frame, &b.frame, &stats, NULL), AWT_OK);
        CHECK_INT(stats.clamped_points, 0);
        add_frame(&b);
    }
    geom_scratch_destroy(scratch);
    geom_layout_destroy(layout);
    return end(&b);
}

/* Frames against the one before; of guides the first one against nothing. */
static uint64_t hash_deltas(const char *style, geom_kind kind)
{
    bowing b = begin(style);
    geom_scratch *scratch = NULL;
    geom_layout *layout = make_layout(&b, &(geom_layout_def){.kind = kind}, &scratch);
    geom_quantised *base = NULL, *now = NULL;
    CHECK_INT(geom_quantised_create(layout, &base, NULL), AWT_OK);
    CHECK_INT(geom_quantised_create(layout, &now, NULL), AWT_OK);
    ASSERT(base && now);
    while (move_on(&b)) {
        const geom_quantise_def quantise = {.points = take_points(&b, layout, kind), .frames = b.frames};
        const geom_delta_def delta = {.base = b.at > 1 ? base : NULL,
                                      .now = now,
                                      .base_sequence = (uint64_t)b.at - 1,
                                      .sequence = (uint64_t)b.at,
                                      .head = awt_forest_head(b.forest),
                                      .time_us = awt_forest_time(b.forest)};
        uint32_t clamped = 0;
        CHECK_INT(geom_quantise(layout, &quantise, now, &clamped, NULL), AWT_OK);
        if (b.at > 1 || kind == GEOM_GUIDES) {
            CHECK_INT(geom_encode_delta(layout, scratch, &delta, &b.frame, NULL, NULL), AWT_OK);
            add_frame(&b);
        }
        geom_quantised *before = base;
        base = now;
        now = before;
    }
    geom_quantised_destroy(base);
    geom_quantised_destroy(now);
    geom_scratch_destroy(scratch);
    geom_layout_destroy(layout);
    return end(&b);
}

static uint64_t hash_nodes(const char *style)
{
    bowing b = begin(style);
    while (move_on(&b)) {
        const awt_pose head = awt_forest_head(b.forest);
        const uint32_t count = awt_forest_nodes(b.forest, b.nodes);
        CHECK_INT(geom_encode_nodes(b.nodes, count, &head, awt_forest_time(b.forest), &b.frame, NULL), AWT_OK);
        add_frame(&b);
    }
    return end(&b);
}

static uint64_t hash_binding(const char *style)
{
    const awt_groom *groom = fixture_groom(style, STRANDS);
    size_t size = 0;
    CHECK_INT(geom_binding_write(groom, NULL, 0, &size, NULL), AWT_OK);
    unsigned char *bytes = malloc(size);
    ASSERT(bytes);
    CHECK_INT(geom_binding_write(groom, bytes, size, &size, NULL), AWT_OK);
    const uint64_t hash = hash_words(HASH_SEED, bytes, size / 4);
    free(bytes);
    return hash;
}

/* What goes out in one style. */
typedef struct golden_style {
    const char *style;
    uint64_t ribbon, ribbon_fifth, strands, strands_guides, guides, strands_delta, guides_delta, nodes, binding;
} golden_style;

static void check_style(const golden_style *g)
{
    const geom_layout_def ribbon = {.kind = GEOM_RIBBON, .attributes = GEOM_ATTRIBUTES_ALL};
    const geom_layout_def ribbon_fifth = {.kind = GEOM_RIBBON, .level = GEOM_LEVEL_FIFTH};
    const geom_layout_def strands = {.kind = GEOM_STRANDS, .attributes = GEOM_ATTRIBUTES_ALL};
    const geom_layout_def strands_guides = {.kind = GEOM_STRANDS, .level = GEOM_LEVEL_GUIDES};
    const geom_layout_def guides = {.kind = GEOM_GUIDES};
    CHECK_U64(hash_whole(g->style, &ribbon), g->ribbon);
    CHECK_U64(hash_whole(g->style, &ribbon_fifth), g->ribbon_fifth);
    CHECK_U64(hash_whole(g->style, &strands), g->strands);
    CHECK_U64(hash_whole(g->style, &strands_guides), g->strands_guides);
    CHECK_U64(hash_whole(g->style, &guides), g->guides);
    CHECK_U64(hash_deltas(g->style, GEOM_STRANDS), g->strands_delta);
    CHECK_U64(hash_deltas(g->style, GEOM_GUIDES), g->guides_delta);
    CHECK_U64(hash_nodes(g->style), g->nodes);
    CHECK_U64(hash_binding(g->style), g->binding);
}

TEST(golden_bytes_of_every_kind_of_frame)
{
    static const golden_style golden[] = {
        {.style = "long",
         .ribbon = UINT64_C(0x1c791d2454dc4790),
         .ribbon_fifth = UINT64_C(0x23efc0c3399aad9f),
         .strands = UINT64_C(0xc47b3b431090cfe7),
         .strands_guides = UINT64_C(0x8e968c0e96ada53b),
         .guides = UINT64_C(0x77b1281d059b5b32),
         .strands_delta = UINT64_C(0x455c5b96fa303c04),
         .guides_delta = UINT64_C(0xeafa935732808d62),
         .nodes = UINT64_C(0xe307dca4111a26ba),
         .binding = UINT64_C(0x9b60c939a0f81b94)},
        {.style = "short-curly",
         .ribbon = UINT64_C(0x76d476df2e7bb7ae),
         .ribbon_fifth = UINT64_C(0x257335311f7028a9),
         .strands = UINT64_C(0x50ed01beed349af7),
         .strands_guides = UINT64_C(0x994ba2f6fca2c675),
         .guides = UINT64_C(0x87c5da6c0e6311f1),
         .strands_delta = UINT64_C(0x60ad0d35c9bdd0a7),
         .guides_delta = UINT64_C(0x2f5c79d9b45a6e40),
         .nodes = UINT64_C(0x47204c30f004e9b1),
         .binding = UINT64_C(0x6ce9099d2897f74f)},
    };
    for (size_t k = 0; k < sizeof golden / sizeof golden[0]; k++) {
        check_style(&golden[k]);
    }
}
