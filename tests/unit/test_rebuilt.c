/* test_rebuilt.c: what a groom says of its strands' distance from those it was built from. */
#include "check.h"

#include <math.h>
#include <stdlib.h>
#include "awt.h"
#include "base/assert.h"
#include "base/trig.h"
#include "fixture.h"
#include "groom/groom.h"
#include "groom_fixture.h"

#define AIM_M 1e-4 /* a tenth of a millimetre */

TEST(rebuilt_strands_of_the_styles_are_where_they_were)
{
    for (size_t i = 0; i < awt_style_count(); i++) {
        awt_rebuilt rebuilt = awt_groom_rebuilt(fixture_groom(awt_style_at(i)->name, 2000));
        CHECK(rebuilt.known);
        CHECK(rebuilt.max_m > 0 && rebuilt.max_m < AIM_M);
        CHECK(rebuilt.mean_m > 0 && rebuilt.mean_m <= rebuilt.max_m);
    }
}

/* The one wisp keeps the strands' order, so that what comes out can be compared here as well. */
TEST(rebuilt_is_the_distance_from_point_to_point)
{
    awt_strands strands = groom_fixture_patch(300);
    awt_groom_def def = awt_groom_def_default();
    def.levels = 1, def.finest_wisps = 1;
    awt_groom *groom = groom_fixture_build(&strands, &def);
    float *rest = groom_fixture_rest(groom);
    double max_m = 0, sum_m = 0;
    for (size_t i = 0; i < strands.point_count; i++) {
        double square = 0;
        for (size_t axis = 0; axis < 3; axis++) {
            double d = (double)rest[3 * i + axis] - (double)strands.positions[3 * i + axis];
            square += d * d;
        }
        max_m = fmax(max_m, sqrt(square));
        sum_m += sqrt(square);
    }
    CHECK(max_m > 0);
    CHECK_NEAR(awt_groom_rebuilt(groom).max_m, max_m, 1e-12);
    CHECK_NEAR(awt_groom_rebuilt(groom).mean_m, sum_m / strands.point_count, 1e-12);
    free(rest);
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
}

/* Strands that are quarters of a circle of 0.2 m, down from the side of the head. */
static awt_strands strands_quarters(uint32_t strand_count, uint32_t points)
{
    awt_strands strands = groom_fixture_strands(strand_count, points);
    for (uint32_t s = 0; s < strand_count; s++) {
        for (uint32_t i = 0; i < points; i++) {
            double sine, cosine;
            trig_sin_cos(0.5 * TRIG_PI * i / (points - 1), &sine, &cosine);
            groom_fixture_put(&strands, s, i, 0.1 + 0.2 * sine, 0.2 * cosine - 0.2, 0.001 * s);
        }
    }
    return strands;
}

/* Chords instead of arcs: points of the file lie off them by as much as the chord cuts off, r (1 - cos(angle / 2)). */
TEST(rebuilt_with_fewer_points_says_what_the_chords_cut_off)
{
    static const uint32_t chords[] = {2, 4, 8, 16};
    for (size_t i = 0; i < sizeof chords / sizeof chords[0]; i++) {
        awt_strands strands = strands_quarters(5, 129);
        awt_groom_def def = awt_groom_def_default();
        def.levels = 1, def.finest_wisps = 1, def.points_per_strand = chords[i] + 1;
        awt_groom *groom = groom_fixture_build(&strands, &def);
        double sine, cosine;
        trig_sin_cos(0.25 * TRIG_PI / chords[i], &sine, &cosine);
        double cut_m = 0.2 * (1 - cosine);
        CHECK_NEAR(awt_groom_rebuilt(groom).max_m, cut_m, 1e-6);
        CHECK_NEAR(awt_groom_rebuilt(groom).mean_m, cut_m * 2 / 3, cut_m * 0.03); /* of a parabola's height */
        awt_groom_destroy(groom);
        awt_strands_fini(&strands);
    }
}

TEST(rebuilt_with_more_points_goes_by_all_of_the_file_s)
{
    awt_strands strands = strands_quarters(5, 9);
    awt_groom_def def = awt_groom_def_default();
    def.levels = 1, def.finest_wisps = 1, def.points_per_strand = 17; /* every second one is the file's */
    awt_groom *groom = groom_fixture_build(&strands, &def);
    CHECK_NEAR(awt_groom_rebuilt(groom).max_m, 0.0, 1e-6);
    awt_groom_destroy(groom);
    def.points_per_strand = 256; /* corners lie between: half a piece away at most, and the corner is blunt */
    groom = groom_fixture_build(&strands, &def);
    CHECK(awt_groom_rebuilt(groom).max_m > 1e-6 && awt_groom_rebuilt(groom).max_m < AIM_M);
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
}

TEST(rebuilt_strands_without_length_are_where_they_were)
{
    awt_strands strands = groom_fixture_strands(3, 5);
    for (uint32_t k = 0; k < 15; k++) {
        groom_fixture_put(&strands, k / 5, k % 5, 0.01 * (k / 5), 0.1, 0);
    }
    awt_groom_def def = awt_groom_def_default();
    def.points_per_strand = 7;
    awt_groom *groom = groom_fixture_build(&strands, &def);
    CHECK_NEAR(awt_groom_rebuilt(groom).max_m, 0.0, 1e-6);
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
}

TEST(rebuilt_strands_of_real_grooms_are_where_they_were)
{
    for (size_t i = 0; i < GROOM_FIXTURE_REAL; i++) {
        const char *path = check_data(groom_fixture_real[i].file);
        if (!path) {
            check_skip("the real strand files are not on this machine");
            return;
        }
        awt_groom *groom = groom_fixture_build_real(&groom_fixture_real[i], path);
        if (groom) {
            CHECK_NEAR(awt_groom_rebuilt(groom).max_m, 0.0, AIM_M);
        }
        awt_groom_destroy(groom);
    }
}
