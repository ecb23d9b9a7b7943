/* test_wind.c: gusts: what they are on their own, and what hair in them does. */
#include "check.h"
#include "invariant_fixture.h"

#include "base/assert.h"
#include "sim/state.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>

/* ---- the air alone ---------------------------------------------------------------------------------------------- */

static awt_params gusty_params(const char *style)
{
    awt_params params = small_params(style);
    params.wind_x = 3.0f, params.wind_z = -4.0f; /* 5 m/s */
    params.wind_gust = 0.6f;
    params.gust_period = 2.0f;
    return params;
}

static const dvec3 origin = {0, 0, 0};
static const vec3 centre = {0, 0, 0};

TEST(gusts_come_to_the_wind_over_a_long_time_and_reach_their_share)
{
    const awt_params params = gusty_params("long");
    double sum = 0, least = 0, most = 0;
    const int count = 400000; /* 4000 s */
    for (int n = 0; n < count; n++) {
        wind_field w = wind_blow(&params, (int64_t)n * AWT_STEP_US, origin);
        double gust = (double)wind_gust_at(&w, centre);
        sum += gust;
        least = gust < least ? gust : least;
        most = gust > most ? gust : most;
    }
    CHECK_NEAR(sum / count, 0, 1e-3);
    CHECK(most > 0.57 && most <= 0.6);
    CHECK(least < -0.57 && least >= -0.6);
    wind_field w = wind_blow(&params, 700000, origin);
    float gust = wind_gust_at(&w, centre);
    vec3 air = wind_at(&w, centre);
    CHECK(gust > 0.1f);
    CHECK_NEAR(air.x, 3.0f * (1.0f + gust), 1e-5);
    CHECK_NEAR(air.y, 0, 0);
    CHECK_NEAR(air.z, -4.0f * (1.0f + gust), 1e-5);
}

/* What blows here is 5 m farther on after a second; across the wind it is everywhere the same. A node's place counts
 * like its head's. */
TEST(gusts_travel_with_the_wind)
{
    const awt_params params = gusty_params("long");
    double differ = 0;
    for (int n = 0; n < 100; n++) {
        const int64_t t = (int64_t)n * 130000;
        wind_field here = wind_blow(&params, t, origin), later = wind_blow(&params, t + 1000000, (dvec3){3, 0, -4});
        wind_field across = wind_blow(&params, t, (dvec3){8, -7, 6}),
                   on = wind_blow(&params, t, (dvec3){0.3, 0.2, -0.4});
        double gust = (double)wind_gust_at(&here, centre);
        CHECK_NEAR(wind_gust_at(&later, centre), gust, 1e-6);
        CHECK_NEAR(wind_gust_at(&across, centre), gust, 1e-6);
        CHECK_NEAR(wind_gust_at(&on, centre), wind_gust_at(&here, (vec3){0.3f, 0.2f, -0.4f}), 1e-6);
        double there = fabs((double)wind_gust_at(&on, centre) - gust);
        differ = there > differ ? there : differ;
    }
    CHECK(differ > 0.05);
}

/* No jump from one millisecond to the next, and motion in all of them. */
TEST(gusts_are_as_smooth_after_decades_and_100_km_from_zero)
{
    const awt_params params = gusty_params("long");
    const int64_t late = AWT_MAX_TIME_US - 10000000;
    const dvec3 far_away = {1e5, 0, -1e5};
    double before = NAN, most = 0;
    for (int n = 0; n < 10000; n++) { /* a millisecond each */
        wind_field w = wind_blow(&params, late + (int64_t)n * 1000, far_away);
        double gust = (double)wind_gust_at(&w, centre);
        if (n > 0) {
            double step = fabs(gust - before);
            most = step > most ? step : most;
        }
        before = gust;
    }
    /* the steepest that three waves can be: 0.6 * 2 pi / 2 s * (0.5 + 0.3 / 0.618 + 0.2 / 1.732) a second */
    CHECK(most < 1e-3 * 2.08);
    CHECK(most > 1e-3 * 1.0);
    wind_field negative = wind_blow(&params, -AWT_MAX_TIME_US, far_away);
    CHECK(fabs((double)wind_gust_at(&negative, centre)) <= 0.6);
}

/* ---- hair in it ----------------------------------------------------------------------------------------------------
 */

/* A second of sway and two of rest, the head's world moved by `shift_m` along x. */
static uint64_t play(const awt_groom *groom, const awt_params *params, double shift_m, awt_step_stats *last)
{
    awt_forest_def def = awt_forest_def_default(groom);
    def.params = *params;
    def.start.head.position[0] = def.start.body.position[0] = shift_m;
    awt_forest *f;
    ASSERT(awt_forest_create(groom, &def, &f, NULL) == AWT_OK);
    wild w = wild_make(5, 1.0);
    for (int n = 1; n <= 300; n++) {
        awt_motion m = wild_at(&w, (int64_t)(n < 100 ? n : 100) * AWT_STEP_US);
        m.time_us = (int64_t)n * AWT_STEP_US;
        m.head.position[0] += shift_m;
        m.body.position[0] += shift_m;
        ASSERT(awt_forest_move(f, &m, NULL) == AWT_OK);
        ASSERT(awt_forest_advance(f, m.time_us, last, NULL) == AWT_OK);
    }
    uint64_t hash = awt_forest_hash(f);
    awt_forest_destroy(f);
    return hash;
}

TEST(gusts_differ_from_place_to_place_and_without_a_share_there_are_none)
{
    awt_groom *groom = small_groom("long", 3);
    awt_params params = gusty_params("long");
    awt_step_stats stats;
    const uint64_t here = play(groom, &params, 0, &stats), there = play(groom, &params, 4, &stats);
    CHECK(here != there);
    params.gust_period = 3.0f;
    CHECK(play(groom, &params, 0, &stats) != here);
    params.wind_gust = 0;
    const uint64_t calm = play(groom, &params, 0, &stats);
    CHECK(calm != here);
    params.gust_period = 0.1f; /* of no gust */
    CHECK_U64(play(groom, &params, 0, &stats), calm);
    awt_groom_destroy(groom);
}

/* Nothing sleeps in a gusty wind, sleepers wake when it begins, and sleep again when it is over. */
TEST(the_world_is_not_still_while_the_wind_gusts)
{
    awt_groom *groom = small_groom("short", 3);
    awt_params params = gusty_params("short"), calm = params;
    calm.wind_gust = 0;
    awt_forest *f = small_forest(groom, &calm);
    awt_step_stats stats;
    ASSERT(awt_forest_advance(f, 8000000, &stats, NULL) == AWT_OK);
    CHECK_INT(stats.asleep_trees, groom->info.wisp_count[0]);
    ASSERT(awt_forest_set_params(f, &params, NULL) == AWT_OK);
    for (int n = 1; n <= 10; n++) {
        ASSERT(awt_forest_advance(f, 8000000 + (int64_t)n * 1000000, &stats, NULL) == AWT_OK);
        CHECK_INT(stats.asleep_trees, 0);
        CHECK(stats.kinetic_energy_j > 0);
    }
    ASSERT(awt_forest_set_params(f, &calm, NULL) == AWT_OK);
    ASSERT(awt_forest_advance(f, 26000000, &stats, NULL) == AWT_OK);
    CHECK_INT(stats.asleep_trees, groom->info.wisp_count[0]);
    params.wind_x = params.wind_z = 0; /* gusts of no wind are none */
    ASSERT(awt_forest_set_params(f, &params, NULL) == AWT_OK);
    ASSERT(awt_forest_advance(f, 32000000, &stats, NULL) == AWT_OK);
    CHECK_INT(stats.asleep_trees, groom->info.wisp_count[0]);
    awt_forest_destroy(f);
    awt_groom_destroy(groom);
}

/* A share of gusts bends hair to and fro about where the steady wind holds it, the more the larger it is. */
TEST(hair_sways_with_the_gusts)
{
    awt_groom *groom = small_groom("long", 3);
    double energy[3];
    for (int k = 0; k < 3; k++) {
        awt_params params = gusty_params("long");
        params.wind_gust = 0.3f * (float)k;
        awt_forest *f = small_forest(groom, &params);
        energy[k] = 0;
        ASSERT(awt_forest_advance(f, 3000000, NULL, NULL) == AWT_OK);
        for (int n = 1; n <= 400; n++) {
            awt_step_stats stats;
            ASSERT(awt_forest_advance(f, 3000000 + (int64_t)n * AWT_STEP_US, &stats, NULL) == AWT_OK);
            energy[k] += (double)stats.kinetic_energy_j / 400;
        }
        awt_forest_destroy(f);
    }
    CHECK(energy[1] > 2 * energy[0]);
    CHECK_NEAR(energy[2] / energy[1], 4, 1); /* amplitude squared */
    awt_groom_destroy(groom);
}

typedef struct lone {
    const awt_groom *groom;
    const awt_params *params;
    uint64_t hash;
} lone;

static void *lone_run(void *argument)
{
    lone *l = argument;
    awt_step_stats stats;
    l->hash = play(l->groom, l->params, 1, &stats);
    return NULL;
}

TEST(gusts_give_the_same_bits_on_one_worker_and_on_two)
{
    awt_groom *groom = small_groom("long", 3);
    const awt_params params = gusty_params("long");
    lone alone = {groom, &params, 0}, beside[2] = {alone, alone};
    lone_run(&alone);
    pthread_t threads[2];
    for (int k = 0; k < 2; k++) {
        ASSERT(pthread_create(&threads[k], NULL, lone_run, &beside[k]) == 0);
    }
    for (int k = 0; k < 2; k++) {
        ASSERT(pthread_join(threads[k], NULL) == 0);
        CHECK_U64(beside[k].hash, alone.hash);
    }
    awt_groom_destroy(groom);
}

TEST(a_snapshot_in_a_gust_goes_on_to_the_bit)
{
    awt_groom *groom = small_groom("long", 3), *again;
    const awt_params params = gusty_params("long");
    awt_forest *f = small_forest(groom, &params);
    ASSERT(awt_forest_advance(f, 1234567, NULL, NULL) == AWT_OK);
    awt_forest *restored = small_restored(f, &again);
    const uint64_t then = awt_forest_hash(f);
    ASSERT(awt_forest_advance(f, 3000000, NULL, NULL) == AWT_OK);
    ASSERT(awt_forest_advance(restored, 3000000, NULL, NULL) == AWT_OK);
    CHECK(awt_forest_hash(f) != then);
    CHECK_U64(awt_forest_hash(restored), awt_forest_hash(f));
    awt_forest_destroy(restored);
    awt_groom_destroy(again);
    awt_forest_destroy(f);
    awt_groom_destroy(groom);
}

/* The ends of all ranges, winds too light to have a wavelength, and heads where no head is. */
TEST(gusts_of_extreme_parameters_stay_finite)
{
    static const struct {
        float wind, gust, period, drag;
        double place;
    } extremes[] = {{100, 10, 0.1f, 100, 0},       {100, 10, 600, 100, 1e5},    {1e-45f, 10, 0.1f, 100, 1e5},
                    {1e-38f, 10, 0.1f, 0.6f, 1e9}, {1e-3f, 10, 0.1f, 100, 1e5}, {-100, 1e-45f, 0.1f, 1e-45f, -1e5}};
    awt_groom *groom = small_groom("long", 3);
    for (size_t k = 0; k < sizeof extremes / sizeof extremes[0]; k++) {
        awt_params params = gusty_params("long");
        params.wind_x = params.wind_y = params.wind_z = extremes[k].wind;
        params.wind_gust = extremes[k].gust;
        params.gust_period = extremes[k].period;
        params.drag = extremes[k].drag;
        awt_forest_def def = awt_forest_def_default(groom);
        def.params = params;
        def.start.head.position[2] = def.start.body.position[2] = extremes[k].place;
        awt_forest *f;
        ASSERT(awt_forest_create(groom, &def, &f, NULL) == AWT_OK);
        awt_step_stats stats;
        ASSERT(awt_forest_advance(f, 500000, &stats, NULL) == AWT_OK);
        CHECK(isfinite(stats.kinetic_energy_j));
        strand_points points = strand_points_of(f);
        CHECK(isfinite(strand_points_greatest(&points, &points)));
        strand_points_fini(&points);
        awt_forest_destroy(f);
    }
    awt_params params = gusty_params("long");
    params.wind_x = params.wind_z = 1e-45f;
    wind_field w = wind_blow(&params, 1, (dvec3){1e300, 0, 1e300});
    CHECK(isfinite(wind_gust_at(&w, centre)));
    awt_groom_destroy(groom);
}
