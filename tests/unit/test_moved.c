/* What moved, as the solver tells it: the rest of a frame need be neither evaluated nor encoded again. */
#include "fixture.h"
#include "geom/encode.h"
#include "groom_fixture.h"
#include "base/assert.h"
#include "check.h"

#include <stdlib.h>
#include <string.h>

typedef struct head {
    awt_groom *groom;
    awt_forest *forest;
    awt_groom_info info;
    float *centres, *frames, *scratch, *points;
    bool *moved;
} head;

static head head_make(void)
{
    head h = {.groom = groom_fixture_build_patch(400, 3, 12, 12)};
    awt_groom_get_info(h.groom, &h.info);
    awt_forest_def def = awt_forest_def_default(h.groom);
    ASSERT(awt_forest_create(h.groom, &def, &h.forest, NULL) == AWT_OK);
    h.centres = calloc(h.info.finest_nodes, 3 * sizeof(float));
    h.frames = calloc(h.info.finest_nodes, 4 * sizeof(float));
    h.scratch = calloc(awt_groom_strand_scratch(h.groom), sizeof(float));
    h.points = calloc((size_t)h.info.strand_count * h.info.points_per_strand, 3 * sizeof(float));
    h.moved = calloc(h.info.wisp_count[0], sizeof(bool));
    ASSERT(h.centres && h.frames && h.scratch && h.points && h.moved);
    return h;
}

static void head_free(head *h)
{
    free(h->centres);
    free(h->frames);
    free(h->scratch);
    free(h->points);
    free(h->moved);
    awt_forest_destroy(h->forest);
    awt_groom_destroy(h->groom);
}

/* A jerk of the head at the beginning, and nothing after it. */
static void head_step(head *h, int64_t time_us)
{
    awt_motion m = {.time_us = time_us};
    m.head.orientation[3] = m.body.orientation[3] = 1;
    m.head.position[0] = time_us <= 100000 ? 1e-6 * (double)time_us : 0.1;
    m.body.position[0] = m.head.position[0];
    ASSERT(awt_forest_move(h->forest, &m, NULL) == AWT_OK);
    ASSERT(awt_forest_advance(h->forest, time_us, NULL, NULL) == AWT_OK);
}

TEST(moved_since_the_beginning_is_every_wisp_and_asleep_none)
{
    head h = head_make();
    const uint32_t wisps = h.info.wisp_count[0];
    CHECK_U64(awt_forest_sub_steps(h.forest), 0);
    head_step(&h, AWT_STEP_US);
    CHECK_U64(awt_forest_sub_steps(h.forest), 1);
    CHECK_INT(awt_forest_moved(h.forest, 0, h.moved), wisps);
    CHECK_INT(awt_forest_moved(h.forest, 1, h.moved), 0);
    for (int64_t n = 2; n <= 3000; n++) {
        head_step(&h, n * AWT_STEP_US);
    }
    const uint64_t now = awt_forest_sub_steps(h.forest);
    head_step(&h, 3001 * AWT_STEP_US);
    CHECK_INT(awt_forest_moved(h.forest, now, h.moved), 0);
    head_free(&h);
}

/* Evaluating what moved into the arrays of the frame before gives what evaluating everything gives: exactly where it
 * moved, and where it did not to what rounding leaves of turning a sleeper with its head. */
TEST(moved_wisps_alone_make_the_whole_frame)
{
    head h = head_make();
    const size_t floats = 3 * (size_t)h.info.strand_count * h.info.points_per_strand;
    float *all = calloc(floats, sizeof *all);
    ASSERT(all);
    uint32_t some = 0;
    uint64_t drawn = 0;
    for (int64_t n = 1; n <= 1500; n++) {
        head_step(&h, n * AWT_STEP_US);
        if (n % 7 != 0) {
            continue;
        }
        uint32_t moved = awt_forest_moved(h.forest, n == 7 ? 0 : drawn, h.moved);
        drawn = awt_forest_sub_steps(h.forest);
        some += moved > 0 && moved < h.info.wisp_count[0];
        awt_forest_guides_of(h.forest, h.moved, h.centres, h.frames);
        awt_groom_strands_of(h.groom, h.moved, h.centres, h.frames, h.scratch, h.points);
        float *centres = calloc(h.info.finest_nodes, 3 * sizeof(float));
        float *frames = calloc(h.info.finest_nodes, 4 * sizeof(float));
        ASSERT(centres && frames);
        awt_forest_guides(h.forest, centres, frames);
        awt_groom_strands(h.groom, centres, frames, h.scratch, all);
        free(centres);
        free(frames);
        CHECK(memcmp(all, h.points, floats * sizeof *all) == 0);
    }
    CHECK(some > 0);
    free(all);
    head_free(&h);
}

TEST(moved_wisps_say_which_patches_changed)
{
    head h = head_make();
    const geom_layout_def def = {.kind = GEOM_STRANDS};
    geom_layout *layout;
    ASSERT(geom_layout_create(h.groom, &def, &layout, NULL) == AWT_OK);
    const uint32_t patches = geom_layout_patches(layout), wisps = h.info.wisp_count[0];
    bool *unchanged = calloc(patches, sizeof *unchanged);
    uint32_t changed = 0;
    ASSERT(unchanged);
    for (uint32_t t = 0; t < wisps; t++) {
        memset(h.moved, 0, wisps * sizeof *h.moved);
        geom_layout_unchanged(layout, h.moved, unchanged);
        for (uint32_t i = 0; i < patches; i++) {
            CHECK(unchanged[i]);
        }
        h.moved[t] = true;
        geom_layout_unchanged(layout, h.moved, unchanged);
        uint32_t of_this = 0;
        for (uint32_t i = 0; i < patches; i++) {
            of_this += !unchanged[i];
        }
        CHECK(of_this >= 1);
        changed += of_this;
    }
    CHECK(changed >= wisps);
    free(unchanged);
    geom_layout_destroy(layout);
    head_free(&h);
}
