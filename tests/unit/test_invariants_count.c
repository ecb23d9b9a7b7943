/* test_invariants_count.c: invariants 6 and 13: how many nodes are active follows from the threshold, the motion and
 * the hair, and from nothing that was written down before. */
#include "check.h"
#include "fixture.h"
#include "invariant_fixture.h"

#include "base/assert.h"
#include "sim/tree.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

/* ---- the threshold (invariant 6) -------------------------------------------------------------------------------- */

static double mean_active_in_lean(const awt_groom *groom, float threshold)
{
    const double zero[3] = {0, 0, 0};
    enum { STEPS = 400 };
    awt_params params = small_params("long");
    params.split_threshold = threshold;
    awt_forest *f = small_forest(groom, &params);
    double sum = 0;
    for (int n = 1; n <= STEPS; n++) {
        awt_step_stats stats;
        fixture_advance(f, fixture_clip("lean"), (int64_t)n * AWT_STEP_US, zero, zero, &stats);
        sum += stats.active_nodes;
    }
    awt_forest_destroy(f);
    return sum / STEPS;
}

TEST(mean_active_count_falls_as_the_threshold_rises)
{
    static const float thresholds[] = {0.1f, 0.2f, 0.4f, 0.8f};
    double mean[4] = {0}, coarse = 0;
    for (uint64_t seed = 1; seed <= 4; seed++) {
        awt_groom *groom = small_groom("long", seed);
        for (size_t k = 0; k < 4; k++) {
            mean[k] += mean_active_in_lean(groom, thresholds[k]) / 4;
        }
        awt_groom_info info;
        awt_groom_get_info(groom, &info);
        coarse += info.coarse_nodes / 4.0;
        awt_groom_destroy(groom);
    }
    for (size_t k = 1; k < 4; k++) {
        CHECK(mean[k] < mean[k - 1] - 0.01 * coarse);
    }
    CHECK(mean[0] > 1.5 * coarse); /* there is much to fall from */
    CHECK(mean[3] >= coarse);
}

/* Active nodes that are neither finest nor roots. */
static uint32_t nodes_between(const awt_forest *f)
{
    const awt_groom *groom = f->groom;
    uint32_t between = 0;
    for (uint32_t t = 0; t < groom->info.wisp_count[0]; t++) {
        for (uint32_t k = f->trees[t].first + 1; k < f->trees[t].first + f->trees[t].count; k++) {
            between += f->active_node[k] / groom->info.sections < groom_finest_first(groom);
        }
    }
    return between;
}

TEST(a_threshold_of_nothing_is_the_single_level_method_and_one_without_end_never_splits)
{
    awt_groom *groom = small_groom("long", 2);
    awt_params params = small_params("long");
    wild w = wild_make(5, 1.0);
    params.residence = 0;
    params.split_threshold = 0;
    awt_forest *single = small_forest(groom, &params);
    params.split_threshold = 1e-3f;
    awt_forest *nearly = small_forest(groom, &params);
    params.split_threshold = 1e9f;
    awt_forest *coarse = small_forest(groom, &params);
    uint32_t all = 0;
    for (uint32_t t = 0; t < groom->info.wisp_count[0]; t++) {
        all += tree_capacity(groom, t); /* the root and the finest of every other section */
    }
    strand_points of_single = strand_points_of(single), of_other = strand_points_of(single);
    double nearly_m = 0, coarse_m = 0;
    for (int n = 1; n <= 120; n++) {
        awt_step_stats stats[3];
        wild_advance(single, &w, (int64_t)n * AWT_STEP_US, &stats[0]);
        wild_advance(nearly, &w, (int64_t)n * AWT_STEP_US, &stats[1]);
        wild_advance(coarse, &w, (int64_t)n * AWT_STEP_US, &stats[2]);
        CHECK_INT(stats[2].active_nodes, groom->info.coarse_nodes);
        CHECK_INT(stats[2].splits, 0);
        if (n > (int)(groom->info.sections + groom->info.levels)) { /* a section a step, then level by level */
            CHECK_INT(stats[0].active_nodes, all);
            CHECK_INT(nodes_between(single), 0);
            CHECK_INT(stats[0].merges, 0);
            CHECK(stats[1].active_nodes > 0.95 * all);
        }
        strand_points_read(&of_single, single);
        strand_points_read(&of_other, nearly);
        nearly_m += strand_points_mean(&of_single, &of_other) / 120;
        strand_points_read(&of_other, coarse);
        coarse_m += strand_points_mean(&of_single, &of_other) / 120;
    }
    CHECK(nearly_m < 0.25 * coarse_m); /* so do the strands */
    CHECK(coarse_m > 0.001);
    strand_points_fini(&of_single), strand_points_fini(&of_other);
    awt_forest_destroy(single), awt_forest_destroy(nearly), awt_forest_destroy(coarse);
    awt_groom_destroy(groom);
}

/* ---- what has never been seen before (invariant 13) ----------------------------------------------------------------
 */

enum { MOVING = 150 };

typedef struct counts {
    double mean; /* while moving */
    uint32_t most, last;
    uint32_t active[MOVING];
} counts;

/* 1.5 s of a motion, `pace` times as fast; then 25 s of rest. */
static counts counts_of(const awt_groom *groom, const wild *w, double pace)
{
    awt_params params = small_params("long");
    params.split_threshold = 0.2f;
    awt_forest *f = small_forest(groom, &params);
    wild paced = *w;
    for (int axis = 0; axis < 3; axis++) {
        paced.sway_rate[axis] *= pace;
        paced.turn_rate[axis] *= pace;
    }
    counts c = {0};
    awt_step_stats stats;
    for (int n = 0; n < MOVING; n++) {
        wild_advance(f, &paced, (int64_t)(n + 1) * AWT_STEP_US, &stats);
        c.active[n] = stats.active_nodes;
        c.mean += stats.active_nodes / (double)MOVING;
        c.most = stats.active_nodes > c.most ? stats.active_nodes : c.most;
    }
    ASSERT(awt_forest_advance(f, awt_forest_time(f) + 25000000, &stats, NULL) == AWT_OK);
    c.last = stats.active_nodes;
    awt_forest_destroy(f);
    return c;
}

static bool counts_differ(const counts *a, const counts *b)
{
    uint32_t differ = 0;
    for (int n = 0; n < MOVING; n++) {
        differ += a->active[n] != b->active[n];
    }
    return differ > MOVING / 4;
}

/* AWT_SEED, or one that nobody has seen: the clock's. */
static uint64_t fresh_seed(void)
{
    const char *given = getenv("AWT_SEED");
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    return given ? strtoull(given, NULL, 10) : (uint64_t)now.tv_sec * 1000 + (uint64_t)now.tv_nsec / 1000000;
}

TEST(a_motion_and_hair_never_seen_before_change_the_active_count_as_they_should)
{
    const uint64_t seed = fresh_seed();
    awt_groom *groom = small_groom("long", seed), *other = small_groom("long", seed + 1);
    const uint32_t coarse = groom->info.coarse_nodes;
    wild still = wild_make(seed, 0), gentle = wild_make(seed, 0.3), firm = wild_make(seed, 1),
         hard = wild_make(seed, 2);
    wild another = wild_make(seed + 1, 1);
    counts at_rest = counts_of(groom, &still, 1), of_gentle = counts_of(groom, &gentle, 1);
    counts of_firm = counts_of(groom, &firm, 1), of_hard = counts_of(groom, &hard, 1);
    counts slow = counts_of(groom, &firm, 0.4), again = counts_of(groom, &firm, 1);
    counts of_another = counts_of(groom, &another, 1), of_other_hair = counts_of(other, &firm, 1);
    bool rises = of_gentle.mean < of_firm.mean - 0.05 * coarse && of_firm.mean < of_hard.mean - 0.05 * coarse &&
                 slow.mean < of_firm.mean - 0.05 * coarse && of_hard.most > of_firm.mean;
    bool returns = at_rest.most == coarse && of_hard.last < 1.05 * coarse && of_firm.last < 1.05 * coarse;
    bool its_own = counts_differ(&of_firm, &of_another) && counts_differ(&of_firm, &of_other_hair);
    CHECK(rises);
    CHECK(returns);
    CHECK(its_own);
    CHECK(!counts_differ(&of_firm, &again)); /* the same again is the same */
    if (!rises || !returns || !its_own) {
        printf("AWT_SEED=%" PRIu64 ": %u active at rest; mean %.1f gentle, %.1f slow, %.1f firm, %.1f hard; last %u\n",
               seed, at_rest.most, of_gentle.mean, slow.mean, of_firm.mean, of_hard.mean, of_hard.last);
    }
    awt_groom_destroy(groom);
    awt_groom_destroy(other);
}
