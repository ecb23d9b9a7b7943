/* test_geom_nodes.c: the AWT itself as a frame. */
#include "check.h"

#include "base/rng.h"
#include "geom/encode.h"
#include "geom/receive.h"
#include "unit/fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double nowhere[3] = {0, 0, 0};

typedef struct nodes_fixture {
    awt_forest *forest;
    awt_groom_info info;
    awt_node *nodes;
    uint32_t count;
    awt_step_stats stats;
    geom_buffer frame;
} nodes_fixture;

static void init(nodes_fixture *f, const char *style, int64_t time_us)
{
    const awt_groom *groom = fixture_groom(style, 2000);
    *f = (nodes_fixture){.forest = fixture_forest(groom, style, nowhere, nowhere)};
    awt_groom_get_info(groom, &f->info);
    f->nodes = calloc(f->info.finest_nodes, sizeof *f->nodes);
    for (int64_t t = 50000; t <= time_us; t += 50000) {
        fixture_advance(f->forest, fixture_clip("lean"), t, nowhere, nowhere, &f->stats);
    }
    f->count = awt_forest_nodes(f->forest, f->nodes);
    const awt_pose head = awt_forest_head(f->forest);
    CHECK_INT(geom_encode_nodes(f->nodes, f->count, &head, time_us, &f->frame, NULL), AWT_OK);
}

static void fini(nodes_fixture *f)
{
    awt_forest_destroy(f->forest);
    free(f->nodes);
    geom_buffer_fini(&f->frame);
}

TEST(forest_nodes_are_the_active_ones_parents_first)
{
    nodes_fixture f;
    uint32_t roots = 0, deeper = 0;
    init(&f, "long", 2000000);
    CHECK_INT(f.count, f.stats.active_nodes);
    CHECK(f.count > f.info.coarse_nodes); /* something has split */
    for (uint32_t i = 0; i < f.count; i++) {
        const awt_node *node = &f.nodes[i];
        roots += node->parent == i;
        deeper += node->level > 0;
        CHECK(node->parent <= i && node->level < f.info.levels && node->radius_m >= 0);
        CHECK(node->level >= f.nodes[node->parent].level); /* a tree only branches towards the tips (2.3) */
        for (int k = 0; k < 3; k++) {
            CHECK(node->position[k] >= f.info.box_min[k] && node->position[k] <= f.info.box_max[k]);
        }
    }
    CHECK_INT(roots, f.info.wisp_count[0]);
    CHECK(deeper > 0);
    fini(&f);
}

TEST(geom_nodes_come_back_to_the_bit)
{
    nodes_fixture f;
    geom_nodes back = {0};
    init(&f, "long-curly", 2000000);
    CHECK_INT(geom_read_nodes(f.frame.bytes, f.frame.size, &back, NULL), AWT_OK);
    CHECK_INT(back.count, f.count);
    if (back.count == f.count) {
        CHECK_BYTES(back.nodes, f.nodes, f.count * sizeof *f.nodes);
    }
    const awt_pose head = awt_forest_head(f.forest);
    for (int k = 0; k < 3; k++) {
        CHECK(back.head.position[k] == head.position[k]);
        CHECK_NEAR(back.head.orientation[k], head.orientation[k], 1e-15);
    }
    CHECK(back.time_us == 2000000);
    geom_nodes_fini(&back);
    fini(&f);
}

TEST(geom_nodes_that_are_none_are_refused)
{
    nodes_fixture f;
    init(&f, "long", 100000);
    awt_pose head = awt_forest_head(f.forest);
    CHECK_INT(geom_encode_nodes(f.nodes, 0, &head, 0, &f.frame, NULL), AWT_BAD_VALUE);
    f.nodes[7].radius_m = NAN;
    CHECK_INT(geom_encode_nodes(f.nodes, f.count, &head, 0, &f.frame, NULL), AWT_BAD_VALUE);
    f.nodes[7].radius_m = 0;
    head.orientation[0] = 2;
    CHECK_INT(geom_encode_nodes(f.nodes, f.count, &head, 0, &f.frame, NULL), AWT_BAD_VALUE);
    fini(&f);
}

TEST(geom_nodes_cut_short_or_damaged_do_no_harm)
{
    nodes_fixture f;
    rng random = rng_seed(51);
    int read = 0;
    init(&f, "short", 100000);
    const awt_pose head = awt_forest_head(f.forest);
    CHECK_INT(geom_encode_nodes(f.nodes, 12, &head, 0, &f.frame, NULL), AWT_OK);
    for (size_t size = 12; size < f.frame.size; size++) { /* with a header that agrees */
        uint32_t length = (uint32_t)size;
        geom_nodes nodes = {0};
        unsigned char *cut = malloc(size);
        memcpy(cut, f.frame.bytes, size);
        memcpy(cut + 8, &length, 4);
        CHECK(geom_read_nodes(cut, size, &nodes, NULL) != AWT_OK);
        free(cut);
    }
    unsigned char *copy = malloc(f.frame.size);
    for (int round = 0; round < 6000; round++) {
        geom_nodes nodes = {0};
        memcpy(copy, f.frame.bytes, f.frame.size);
        for (uint32_t flips = 1 + rng_u32(&random) % 4; flips > 0; flips--) {
            copy[rng_u32(&random) % f.frame.size] = (unsigned char)rng_u32(&random);
        }
        if (geom_read_nodes(copy, f.frame.size, &nodes, NULL) == AWT_OK) {
            for (uint32_t i = 0; i < nodes.count; i++) {
                const awt_node *node = &nodes.nodes[i];
                CHECK(node->parent <= i && node->level < AWT_MAX_LEVELS && node->radius_m >= 0);
                CHECK(isfinite(node->position[0]) && isfinite(node->position[1]) && isfinite(node->position[2]));
            }
            read++;
        }
        geom_nodes_fini(&nodes);
    }
    CHECK(read > 0 && read < 6000);
    free(copy);
    fini(&f);
}

TEST(geom_nodes_for_other_readers)
{
    const char *folder = getenv("AWT_FRAMES");
    const char *const styles[] = {"short", "short-curly", "long", "long-curly"};
    if (!folder) {
        check_skip("AWT_FRAMES names no folder to write frames to, for tests/node/check_nodes.mjs");
        return;
    }
    for (size_t s = 0; s < 4; s++) {
        nodes_fixture f;
        char name[32];
        init(&f, styles[s], 2000000);
        snprintf(name, sizeof name, "nodes-%s", styles[s]);
        check_write_file(folder, name, ".glb", f.frame.bytes, f.frame.size);
        fini(&f);
    }
}
