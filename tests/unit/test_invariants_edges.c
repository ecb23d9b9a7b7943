/* test_invariants_edges.c: invariant 12: hair that is hardly hair, driven as badly as the door lets through: nothing
 * that is not a number, nothing that grows, and rest at the end. */
#include "check.h"
#include "groom_fixture.h"
#include "invariant_fixture.h"

#include "base/assert.h"
#include "base/rng.h"
#include "base/trig.h"

#include <stdlib.h>

enum { HAIRS = 60, POINTS = 9 };

/* ---- hair that is hardly hair ----------------------------------------------------------------------------------- */

static awt_strands zero_length_strands(void)
{
    awt_strands strands = groom_fixture_strands(HAIRS, POINTS);
    for (uint32_t s = 0; s < HAIRS; s++) {
        for (uint32_t i = 0; i < POINTS; i++) {
            groom_fixture_put(&strands, s, i, 0.001 * s, 0.095, 0.0);
        }
    }
    return strands;
}

/* Every third one has no length, among such as have. */
static awt_strands some_zero_length_strands(void)
{
    awt_strands strands = groom_fixture_patch(HAIRS);
    for (uint32_t s = 0; s < HAIRS; s += 3) {
        const float *root = strands.positions + 3 * (size_t)strands.first_point[s];
        for (uint32_t i = 1; i < GROOM_FIXTURE_POINTS; i++) {
            groom_fixture_put(&strands, s, i, (double)root[0], (double)root[1], (double)root[2]);
        }
    }
    return strands;
}

/* All from one point, to all sides. */
static awt_strands coincident_roots(void)
{
    awt_strands strands = groom_fixture_strands(HAIRS, POINTS);
    for (uint32_t s = 0; s < HAIRS; s++) {
        double sine, cosine;
        trig_sin_cos(2 * TRIG_PI * s / HAIRS, &sine, &cosine);
        for (uint32_t i = 0; i < POINTS; i++) {
            groom_fixture_put(&strands, s, i, 0.02 * i * sine, 0.095 + 0.004 * i, 0.02 * i * cosine);
        }
    }
    return strands;
}

/* Up, and straight back down along themselves. */
static awt_strands antiparallel_strands(void)
{
    awt_strands strands = groom_fixture_strands(HAIRS, POINTS);
    for (uint32_t s = 0; s < HAIRS; s++) {
        for (uint32_t i = 0; i < POINTS; i++) {
            uint32_t up = i <= POINTS / 2 ? i : POINTS - 1 - i;
            groom_fixture_put(&strands, s, i, 0.001 * (s % 8), 0.095 + 0.03 * up, 0.001 * (s / 8));
        }
    }
    return strands;
}

/* All the same strand. */
static awt_strands coincident_strands(void)
{
    awt_strands strands = groom_fixture_strands(HAIRS, POINTS);
    for (uint32_t s = 0; s < HAIRS; s++) {
        for (uint32_t i = 0; i < POINTS; i++) {
            groom_fixture_put(&strands, s, i, 0.0, 0.095 + 0.02 * i, 0.0);
        }
    }
    return strands;
}

/* ---- motion that is hardly motion ---------------------------------------------------------------------------------
 */

typedef struct findings {
    uint32_t not_finite, outside; /* strand points, over all frames */
    float energy_at_end, greatest_energy;
    uint32_t awake_at_end;
} findings;

static void look(const awt_forest *f, strand_points *now, findings *found)
{
    awt_groom_info info;
    awt_groom_get_info(awt_forest_groom(f), &info);
    strand_points_read(now, f);
    for (size_t p = 0; p < now->count; p++) {
        bool finite = true, inside = true;
        for (size_t axis = 0; axis < 3; axis++) {
            float x = now->points[3 * p + axis];
            finite = finite && isfinite(x);
            inside = inside && x >= info.box_min[axis] && x <= info.box_max[axis];
        }
        found->not_finite += !finite;
        found->outside += finite && !inside;
    }
}

/* 6 s of poses 0.1 to 0.3 s apart, some of them 5 m away (which is a teleport, said so or not), then 25 s of rest. */
static findings drive(const awt_groom *groom, bool springs, bool contact, uint64_t seed)
{
    awt_params params = awt_params_default();
    params.links = springs ? 1.0f : 0.0f;
    params.contact = contact ? 1.0f : 0.0f;
    params.split_threshold = 0.1f;
    awt_forest *f = small_forest(groom, &params);
    strand_points now = strand_points_of(f);
    findings found = {0};
    wild w = wild_make(seed, 2.0);
    rng r = rng_seed(seed);
    double away = 0;
    int64_t time_us = 0;
    awt_step_stats stats;
    for (int n = 0; time_us < 6000000; n++) {
        time_us += (int64_t)rng_between(&r, 100000, 300000);
        awt_motion m = wild_at(&w, time_us);
        away += n % 5 == 3 ? 5.0 : 0.0;
        m.head.position[0] += away;
        m.body.position[0] += away;
        m.teleport = n % 10 == 3;
        ASSERT(awt_forest_move(f, &m, NULL) == AWT_OK);
        ASSERT(awt_forest_advance(f, time_us, &stats, NULL) == AWT_OK);
        look(f, &now, &found);
        found.greatest_energy =
            stats.kinetic_energy_j <= found.greatest_energy ? found.greatest_energy : stats.kinetic_energy_j;
    }
    ASSERT(awt_forest_advance(f, time_us + 25000000, &stats, NULL) == AWT_OK);
    look(f, &now, &found);
    awt_groom_info info;
    awt_groom_get_info(groom, &info);
    found.energy_at_end = stats.kinetic_energy_j;
    found.awake_at_end = info.wisp_count[0] - stats.asleep_trees;
    strand_points_fini(&now);
    awt_forest_destroy(f);
    return found;
}

static void check_driven(awt_strands strands)
{
    awt_groom_def def = awt_groom_def_default();
    def.levels = 3, def.top_wisps = 3, def.finest_wisps = 12, def.sections = 8;
    awt_groom *groom = groom_fixture_build(&strands, &def);
    awt_groom_info info;
    awt_groom_get_info(groom, &info);
    for (int k = 0; k < 4; k++) {
        bool springs = k % 2, contact = k / 2;
        findings found = drive(groom, springs, contact, 40 + (uint64_t)k);
        CHECK_INT(found.not_finite, 0);
        CHECK_INT(found.outside, 0);
        /* none of it goes faster than the speed limit, and what the motion gave is gone at the end */
        double limit = (double)awt_params_default().speed_limit;
        CHECK((double)found.greatest_energy <= 0.5 * info.mass_kg * limit * limit);
        CHECK(found.energy_at_end <= 0.001f * found.greatest_energy);
        if (!contact) {
            CHECK_INT(found.awake_at_end, 0);
            CHECK_NEAR(found.energy_at_end, 0, 0);
        }
    }
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
}

TEST(strands_without_length_come_to_nothing_worse)
{
    check_driven(zero_length_strands());
    check_driven(some_zero_length_strands());
}

TEST(coincident_roots_and_strands_come_to_nothing_worse)
{
    check_driven(coincident_roots());
    check_driven(coincident_strands());
}

TEST(strands_that_turn_straight_back_come_to_nothing_worse)
{
    check_driven(antiparallel_strands());
}

TEST(ordinary_hair_survives_rare_poses_and_teleports)
{
    check_driven(groom_fixture_patch(HAIRS));
    awt_groom *groom = small_groom("long", 6);
    findings found = drive(groom, false, false, 50);
    CHECK_INT(found.not_finite, 0);
    CHECK_INT(found.outside, 0);
    CHECK(found.greatest_energy > 0.001f);
    awt_groom_destroy(groom);
}

/* Greatest distance, over the next 0.3 s, between hair whose head jumps within 10 ms and hair whose head does not; both
 * are still swinging. */
static double jump_effect_m(double jump_m, bool said)
{
    awt_groom *groom = small_groom("long", 6);
    awt_params params = small_params("long");
    awt_forest *jumping = small_forest(groom, &params), *staying = small_forest(groom, &params);
    wild w = wild_make(51, 1.0);
    for (int n = 1; n <= 50; n++) {
        wild_advance(jumping, &w, (int64_t)n * AWT_STEP_US, NULL);
        wild_advance(staying, &w, (int64_t)n * AWT_STEP_US, NULL);
    }
    awt_motion m = wild_at(&w, 50 * AWT_STEP_US);
    for (int n = 51; n <= 70; n++) { /* the head has come to rest */
        m.time_us = (int64_t)n * AWT_STEP_US;
        ASSERT(awt_forest_move(staying, &m, NULL) == AWT_OK);
        ASSERT(awt_forest_advance(staying, m.time_us, NULL, NULL) == AWT_OK);
        if (n < 70) {
            ASSERT(awt_forest_move(jumping, &m, NULL) == AWT_OK);
            ASSERT(awt_forest_advance(jumping, m.time_us, NULL, NULL) == AWT_OK);
        }
    }
    m.head.position[0] += jump_m, m.body.position[0] += jump_m;
    m.teleport = said;
    ASSERT(awt_forest_move(jumping, &m, NULL) == AWT_OK);
    strand_points a = strand_points_of(jumping), b = strand_points_of(staying);
    double worst = 0;
    for (int n = 0; n < 30; n++) {
        ASSERT(awt_forest_advance(jumping, m.time_us + (int64_t)n * AWT_STEP_US, NULL, NULL) == AWT_OK);
        ASSERT(awt_forest_advance(staying, m.time_us + (int64_t)n * AWT_STEP_US, NULL, NULL) == AWT_OK);
        strand_points_read(&a, jumping);
        strand_points_read(&b, staying);
        double distance = strand_points_greatest(&a, &b);
        worst = distance > worst ? distance : worst;
    }
    strand_points_fini(&a), strand_points_fini(&b);
    awt_forest_destroy(jumping), awt_forest_destroy(staying);
    awt_groom_destroy(groom);
    return worst;
}

TEST(a_teleport_said_or_not_does_nothing_to_swinging_hair)
{
    CHECK_NEAR(jump_effect_m(5.0, true), 0, 1e-4);
    CHECK_NEAR(jump_effect_m(5.0, false), 0, 1e-4); /* 500 m/s in one step is none that a head makes */
    CHECK_NEAR(jump_effect_m(0.1, true), 0, 1e-4);
    CHECK(jump_effect_m(0.1, false) > 0.01); /* 10 m/s might be */
}

/* Invariant 10 with contact: what rests overlapping and crossing must come to rest too. */
TEST(hair_that_touches_comes_to_rest_and_sleeps)
{
    for (size_t s = 0; s < awt_style_count(); s++) {
        const char *style = awt_style_at(s)->name;
        awt_groom *groom = small_groom(style, 2);
        awt_params params = small_params(style);
        params.contact = 1;
        awt_forest *f = small_forest(groom, &params);
        wild w = wild_make(7, 1.0);
        awt_step_stats stats;
        for (int n = 1; n <= 150; n++) {
            wild_advance(f, &w, (int64_t)n * AWT_STEP_US, &stats);
        }
        CHECK_INT(awt_forest_advance(f, 26500000, &stats, NULL), AWT_OK);
        awt_groom_info info;
        awt_groom_get_info(groom, &info);
        CHECK_INT(stats.active_nodes, info.coarse_nodes);
        CHECK_INT(stats.asleep_trees, info.wisp_count[0]);
        CHECK_NEAR(stats.kinetic_energy_j, 0, 0);
        awt_forest_destroy(f);
        awt_groom_destroy(groom);
    }
}
