/* test_groom_edges.c: strands and definitions at the edge of what a groom can be built from, and beyond it. */
#include "check.h"

#include <math.h>
#include <string.h>
#include "awt.h"
#include "groom/groom.h"
#include "groom_fixture.h"

TEST(groom_of_one_strand)
{
    awt_strands strands = groom_fixture_patch(1);
    awt_groom_def def = awt_groom_def_default();
    awt_groom *groom = groom_fixture_build(&strands, &def);
    CHECK_INT(groom->info.finest_nodes, groom->info.sections);
    groom_fixture_check_sound(groom);
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
}

TEST(groom_of_two_point_strands)
{
    awt_strands strands = groom_fixture_strands(40, 2);
    for (uint32_t s = 0; s < 40; s++) {
        groom_fixture_put(&strands, s, 0, 0.001 * s, 0.095, 0.0);
        groom_fixture_put(&strands, s, 1, 0.001 * s, 0.195, 0.0);
    }
    awt_groom_def def = awt_groom_def_default();
    def.finest_wisps = 4;
    awt_groom *groom = groom_fixture_build(&strands, &def);
    CHECK_INT(groom->info.sections, 6);
    CHECK_NEAR(groom->info.longest_strand_m, 0.1, 1e-6);
    groom_fixture_check_sound(groom);
    groom_fixture_check_strands(&strands, groom, 1e-6);
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
}

TEST(groom_of_coincident_strands)
{
    awt_strands strands = groom_fixture_strands(50, 4);
    for (uint32_t s = 0; s < 50; s++) {
        for (uint32_t i = 0; i < 4; i++) {
            groom_fixture_put(&strands, s, i, 0.0, 0.095 + 0.01 * i, 0.0);
        }
    }
    awt_groom_def def = awt_groom_def_default();
    def.finest_wisps = 20, def.top_wisps = 3;
    awt_groom *groom = groom_fixture_build(&strands, &def);
    CHECK_INT(groom->info.wisp_count[2], 20);
    groom_fixture_check_sound(groom);
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
}

TEST(groom_of_strands_without_length)
{
    awt_strands strands = groom_fixture_strands(30, 5);
    for (uint32_t s = 0; s < 30; s++) {
        for (uint32_t i = 0; i < 5; i++) {
            groom_fixture_put(&strands, s, i, 0.001 * s, 0.095, 0.0);
        }
    }
    awt_groom_def def = awt_groom_def_default();
    def.finest_wisps = 5;
    awt_groom *groom = groom_fixture_build(&strands, &def);
    groom_fixture_check_sound(groom);
    groom_fixture_check_strands(&strands, groom, 1e-6);
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
}

TEST(groom_of_strands_that_turn_straight_back)
{
    awt_strands strands = groom_fixture_strands(20, 9);
    for (uint32_t s = 0; s < 20; s++) {
        for (uint32_t i = 0; i < 9; i++) {
            uint32_t up = i <= 4 ? i : 8 - i;
            groom_fixture_put(&strands, s, i, 0.0005 * s, 0.095 + 0.02 * up, i == 4 ? 0.02 : 0.0);
        }
    }
    awt_groom_def def = awt_groom_def_default();
    def.finest_wisps = 2, def.sections = 9;
    awt_groom *groom = groom_fixture_build(&strands, &def);
    groom_fixture_check_sound(groom);
    groom_fixture_check_strands(&strands, groom, 1e-6);
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
}

TEST(groom_resamples_strands_of_uneven_counts)
{
    awt_strands strands = groom_fixture_patch(60);
    /* strand 0 keeps only its first three points: the later ones go to nobody */
    memmove(strands.positions + 9, strands.positions + 3 * GROOM_FIXTURE_POINTS,
            (size_t)(strands.point_count - GROOM_FIXTURE_POINTS) * 3 * sizeof(float));
    for (uint32_t s = 1; s <= 60; s++) {
        strands.first_point[s] -= GROOM_FIXTURE_POINTS - 3;
    }
    strands.point_count -= GROOM_FIXTURE_POINTS - 3;
    awt_groom_def def = awt_groom_def_default();
    awt_groom *groom = groom_fixture_build(&strands, &def);
    CHECK_INT(groom->info.points_per_strand, GROOM_FIXTURE_POINTS);
    groom_fixture_check_sound(groom);
    awt_groom_destroy(groom);
    def.points_per_strand = 5;
    groom = groom_fixture_build(&strands, &def);
    CHECK_INT(groom->info.points_per_strand, 5);
    groom_fixture_check_sound(groom);
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
}

static void check_refused(const awt_strands *strands, const awt_groom_def *def, awt_status expected)
{
    awt_groom *groom = (awt_groom *)(void *)&groom;
    awt_error error = {AWT_OK, ""};
    CHECK_TEXT(awt_status_text(awt_groom_build(strands, def, NULL, NULL, &groom, &error)), awt_status_text(expected));
    CHECK(groom == NULL);
    CHECK_INT(error.status, expected);
    CHECK(error.text[0] != 0);
}

TEST(groom_refuses_definitions_outside_the_limits)
{
    awt_strands strands = groom_fixture_patch(20);
    const awt_groom_def good = awt_groom_def_default();
    awt_groom_def def = good;
    def.levels = 0;
    check_refused(&strands, &def, AWT_BAD_VALUE);
    def.levels = AWT_MAX_LEVELS + 1;
    check_refused(&strands, &def, AWT_BAD_VALUE);
    def = good, def.sections = 1;
    check_refused(&strands, &def, AWT_BAD_VALUE);
    def.sections = AWT_MAX_SECTIONS + 1;
    check_refused(&strands, &def, AWT_BAD_VALUE);
    def = good, def.points_per_strand = 1;
    check_refused(&strands, &def, AWT_BAD_VALUE);
    def.points_per_strand = UINT32_MAX;
    check_refused(&strands, &def, AWT_BAD_VALUE);
    def = good, def.head_radius_m = (double)NAN;
    check_refused(&strands, &def, AWT_BAD_VALUE);
    def.head_radius_m = 0.0;
    check_refused(&strands, &def, AWT_BAD_VALUE);
    def = good, def.top_wisps = 9, def.finest_wisps = 8;
    check_refused(&strands, &def, AWT_BAD_VALUE);
    awt_strands_fini(&strands);
}

TEST(groom_refuses_strands_that_are_none)
{
    const awt_groom_def def = awt_groom_def_default();
    awt_strands none = {0};
    check_refused(&none, &def, AWT_NO_STRANDS);
    static const float wrong[] = {NAN, INFINITY, -INFINITY, 1e30f};
    for (int i = 0; i < 4; i++) {
        awt_strands strands = groom_fixture_patch(20);
        strands.positions[100] = wrong[i];
        check_refused(&strands, &def, AWT_BAD_VALUE);
        awt_strands_fini(&strands);
    }
    awt_strands strands = groom_fixture_patch(20);
    strands.first_point[3] = strands.first_point[2] + 1;
    check_refused(&strands, &def, AWT_BAD_VALUE);
    strands.first_point[3] = UINT32_MAX;
    check_refused(&strands, &def, AWT_BAD_VALUE);
    awt_strands_fini(&strands);
}

TEST(groom_refuses_sizes_beyond_the_limits)
{
    awt_groom_def def = awt_groom_def_default();
    awt_strands strands = groom_fixture_strands(80000, 2);
    def.points_per_strand = AWT_MAX_POINTS_PER_STRAND;
    check_refused(&strands, &def, AWT_LIMIT);
    def.points_per_strand = 0, def.finest_wisps = 80000, def.sections = AWT_MAX_SECTIONS;
    check_refused(&strands, &def, AWT_LIMIT);
    strands.strand_count = AWT_MAX_STRANDS + 1;
    check_refused(&strands, &def, AWT_LIMIT);
    strands.strand_count = 80000;
    awt_strands_fini(&strands);
}
