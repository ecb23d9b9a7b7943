/* test_rest.c: what happens after the motion: every tree merges back and sleeps, the style is kept, and what moves
 * wakes it. */
#include "check.h"
#include "fixture.h"

#include "base/trig.h"
#include "sim/state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double zero[3] = {0, 0, 0};
enum { STRANDS = 2000 };

/* Finest centres in the head frame; heap. */
static float *centres_of(const awt_forest *f)
{
    size_t nodes = f->groom->info.finest_nodes;
    float *centres = malloc(nodes * 3 * sizeof *centres), *frames = malloc(nodes * 4 * sizeof *frames);
    awt_forest_guides(f, centres, frames);
    free(frames);
    return centres;
}

/* 1 - mean |x - x_rest| / |x_rest - root|, against the settled pose. */
static double style_kept(const awt_forest *f, const float *settled, const float *now)
{
    const uint32_t sections = f->groom->info.sections;
    double sum = 0;
    size_t count = 0;
    for (uint32_t n = 0; n < f->groom->info.finest_nodes; n++) {
        const float *s = settled + 3 * (size_t)n, *x = now + 3 * (size_t)n,
                    *root = settled + 3 * (size_t)(n - n % sections);
        if (n % sections == 0) {
            continue;
        }
        vec3 moved = {x[0] - s[0], x[1] - s[1], x[2] - s[2]}, arm = {s[0] - root[0], s[1] - root[1], s[2] - root[2]};
        sum += (double)(vec3_length(moved) / vec3_length(arm));
        count++;
    }
    return 1.0 - sum / (double)count;
}

/* A lean, a long rest, and what must hold then. */
static void check_rest_after_lean(bool with_body, double least_kept)
{
    for (size_t s = 0; s < awt_style_count(); s++) {
        const char *style = awt_style_at(s)->name;
        awt_forest *f = fixture_forest(fixture_groom(style, STRANDS), style, zero, zero);
        f->collider_count = with_body ? f->collider_count : 2; /* the first two are the head's */
        awt_step_stats stats;
        awt_forest_advance(f, 500000, NULL, NULL);
        float *settled = centres_of(f);
        for (int n = 51; n <= 1000; n++) {
            fixture_advance(f, fixture_clip("lean"), (int64_t)n * AWT_STEP_US, zero, zero, &stats);
        }
        awt_forest_advance(f, 25000000, &stats, NULL);
        float *now = centres_of(f);
        CHECK_INT(stats.asleep_trees, f->groom->info.wisp_count[0]);
        CHECK_INT(stats.active_nodes, f->groom->info.coarse_nodes);
        CHECK_NEAR(stats.kinetic_energy_j, 0, 0);
        CHECK(style_kept(f, settled, now) > least_kept);
        free(settled);
        free(now);
        awt_forest_destroy(f);
    }
}

TEST(after_a_lean_every_tree_sleeps_without_energy_and_in_style)
{
    check_rest_after_lean(false, 0.97);
}

TEST(after_a_lean_over_the_shoulders_hair_comes_to_lie_as_it_lay)
{
    check_rest_after_lean(true, 0.97);
}

static awt_motion turned(int64_t time_us, double yaw)
{
    awt_motion m = {.time_us = time_us};
    double s, c;
    trig_sin_cos(yaw / 2, &s, &c);
    m.head.orientation[1] = m.body.orientation[1] = s;
    m.head.orientation[3] = m.body.orientation[3] = c;
    return m;
}

TEST(a_sleeping_tree_wakes_when_the_head_moves_or_a_parameter_changes)
{
    awt_forest *f = fixture_forest(fixture_groom("short", STRANDS), "short", zero, zero);
    awt_step_stats stats;
    awt_forest_advance(f, 3000000, &stats, NULL);
    CHECK_INT(stats.asleep_trees, f->groom->info.wisp_count[0]);
    awt_motion m = turned(3100000, 0.3);
    awt_forest_move(f, &m, NULL);
    awt_forest_advance(f, 3100000, &stats, NULL);
    CHECK_INT(stats.asleep_trees, 0);
    CHECK(stats.kinetic_energy_j > 0);
    awt_forest_advance(f, 8000000, &stats, NULL);
    CHECK_INT(stats.asleep_trees, f->groom->info.wisp_count[0]);
    awt_params params = awt_forest_params(f);
    params.wind_x = 5;
    awt_forest_set_params(f, &params, NULL);
    awt_forest_advance(f, 8200000, &stats, NULL);
    CHECK_INT(stats.asleep_trees, 0);
    CHECK(stats.kinetic_energy_j > 0);
    awt_forest_destroy(f);
}

TEST(a_head_that_turns_ever_so_slowly_still_turns_its_sleeping_hair)
{
    awt_forest *f = fixture_forest(fixture_groom("long", STRANDS), "long", zero, zero);
    awt_forest_advance(f, 3000000, NULL, NULL);
    float *settled = centres_of(f);
    for (int n = 1; n <= 400; n++) { /* 0.01 rad/s for 40 s */
        awt_motion m = turned(3000000 + (int64_t)n * 100000, 0.001 * n);
        awt_forest_move(f, &m, NULL);
        awt_forest_advance(f, m.time_us, NULL, NULL);
    }
    float *now = centres_of(f);
    CHECK(style_kept(f, settled, now) > 0.99);
    free(settled);
    free(now);
    awt_forest_destroy(f);
}

TEST(half_a_turn_of_the_head_leaves_no_twist)
{
    const awt_groom *groom = fixture_groom("long", STRANDS);
    awt_forest *f = fixture_forest(groom, "long", zero, zero);
    size_t nodes = groom->info.finest_nodes;
    float *centres = malloc(nodes * 3 * sizeof *centres), *before = malloc(nodes * 4 * sizeof *before);
    float *after = malloc(nodes * 4 * sizeof *after);
    awt_forest_guides(f, centres, before);
    for (int n = 1; n <= 100; n++) {
        awt_motion m = turned((int64_t)n * AWT_STEP_US, TRIG_PI * n / 100);
        awt_forest_move(f, &m, NULL);
        awt_forest_advance(f, m.time_us, NULL, NULL);
    }
    awt_forest_advance(f, 16000000, NULL, NULL);
    awt_forest_guides(f, centres, after);
    double cosine = 0; /* of half the turn between the frames, mean */
    for (size_t n = 0; n < nodes; n++) {
        double dot = 0;
        for (size_t k = 0; k < 4; k++) {
            dot += (double)before[4 * n + k] * (double)after[4 * n + k];
        }
        cosine += fabs(dot) / (double)nodes;
    }
    CHECK(cosine > cos(10.0 * TRIG_PI / 180)); /* under 20 degrees */
    free(centres);
    free(before);
    free(after);
    awt_forest_destroy(f);
}
