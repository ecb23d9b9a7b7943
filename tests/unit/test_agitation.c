/* test_agitation.c: contact between wisps and the air as reasons to split (AWT 5.3), beside the acceleration. */
#include "check.h"
#include "invariant_fixture.h"

#include "base/assert.h"
#include "sim/state.h"

#include <stdlib.h>

typedef struct played {
    uint32_t splits, merges, contacts, active, asleep; /* the last two: at the end */
    uint64_t hash;
} played;

/* So much of a head that moves with `vigour`, then of one that is still. */
static played play(const awt_groom *groom, const awt_params *params, double vigour, int moving, int still)
{
    awt_forest *f = small_forest(groom, params);
    wild w = wild_make(11, vigour);
    played p = {0};
    for (int n = 1; n <= moving + still; n++) {
        awt_step_stats stats;
        if (n <= moving) {
            wild_advance(f, &w, (int64_t)n * AWT_STEP_US, &stats);
        } else {
            ASSERT(awt_forest_advance(f, (int64_t)n * AWT_STEP_US, &stats, NULL) == AWT_OK);
        }
        p.splits += stats.splits;
        p.merges += stats.merges;
        p.contacts += stats.contacts;
        p.active = stats.active_nodes;
        p.asleep = stats.asleep_trees;
    }
    p.hash = awt_forest_hash(f);
    awt_forest_destroy(f);
    return p;
}

TEST(contacts_split_wisps_that_stay_whole_without_their_weight_and_merge_when_they_end)
{
    awt_groom *groom = small_groom("long", 3);
    awt_params params = small_params("long");
    params.contact = 1;
    params.split_threshold = 0.8f;
    played whole = play(groom, &params, 0.6, 100, 0);
    CHECK_INT(whole.splits, 0);
    CHECK(whole.contacts > 1000);
    params.split_contact = 5;
    played torn = play(groom, &params, 0.6, 100, 2500);
    CHECK(torn.splits > 20);
    CHECK_INT(torn.merges, torn.splits);
    CHECK_INT(torn.active, groom->info.coarse_nodes);
    CHECK_INT(torn.asleep, groom->info.wisp_count[0]);

    params.contact = 0; /* what touches nothing is not split by it, to the bit */
    played alone = play(groom, &params, 0.6, 100, 0);
    params.split_contact = 0;
    CHECK_U64(play(groom, &params, 0.6, 100, 0).hash, alone.hash);
    awt_groom_destroy(groom);
}

/* 5 m/s of wind, its gusts a share of it. */
static awt_params windy_params(float gust)
{
    awt_params params = small_params("long");
    params.wind_x = 3.0f, params.wind_z = -4.0f;
    params.wind_gust = gust;
    params.gust_period = 2.0f;
    params.split_threshold = 0.8f;
    return params;
}

TEST(gusts_split_wisps_that_stay_whole_without_their_weight_and_merge_when_they_end)
{
    awt_groom *groom = small_groom("long", 3);
    awt_params params = windy_params(0.8f);
    CHECK_INT(play(groom, &params, 0, 0, 500).splits, 0);
    params.split_wind = 10;
    played torn = play(groom, &params, 0, 0, 500);
    CHECK(torn.splits > 20);

    awt_forest *f = small_forest(groom, &params);
    awt_step_stats stats;
    uint32_t most = 0;
    for (int n = 1; n <= 100; n++) {
        ASSERT(awt_forest_advance(f, (int64_t)n * 50000, &stats, NULL) == AWT_OK);
        most = stats.active_nodes > most ? stats.active_nodes : most;
    }
    CHECK(most > groom->info.coarse_nodes + 20);
    params.wind_gust = 0; /* the wind goes on, steadily */
    ASSERT(awt_forest_set_params(f, &params, NULL) == AWT_OK);
    ASSERT(awt_forest_advance(f, 30000000, &stats, NULL) == AWT_OK);
    CHECK_INT(stats.active_nodes, groom->info.coarse_nodes);
    CHECK_INT(stats.asleep_trees, groom->info.wisp_count[0]);
    awt_forest_destroy(f);
    awt_groom_destroy(groom);
}

/* In still air it is the hair's own motion through it that counts. */
TEST(hair_that_is_swept_through_the_air_splits_by_it)
{
    awt_groom *groom = small_groom("long", 3);
    awt_params params = small_params("long");
    params.split_threshold = 1.0f;
    params.drag = 8.0f;
    CHECK_INT(play(groom, &params, 0.6, 100, 0).splits, 0);
    params.split_wind = 10;
    CHECK(play(groom, &params, 0.6, 100, 0).splits > 20);
    params.drag = 0; /* there is no air, and the weight weighs nothing, to the bit */
    played airless = play(groom, &params, 0.6, 100, 0);
    params.split_wind = 0;
    CHECK_U64(play(groom, &params, 0.6, 100, 0).hash, airless.hash);
    awt_groom_destroy(groom);
}

static double greatest_agitation(const awt_forest *f)
{
    float greatest = 0;
    for (uint32_t n = 0; n < f->groom->gc_count * f->groom->info.sections; n++) {
        greatest = f->agitation[n] > greatest ? f->agitation[n] : greatest;
    }
    return (double)greatest;
}

TEST(agitation_goes_with_its_weights)
{
    awt_groom *groom = small_groom("long", 3);
    awt_params params = windy_params(0.8f);
    params.contact = 1;
    params.split_wind = params.split_contact = 1;
    awt_forest *f = small_forest(groom, &params);
    ASSERT(awt_forest_advance(f, 1000000, NULL, NULL) == AWT_OK);
    CHECK(greatest_agitation(f) > 1.0);
    params.split_wind = params.split_contact = 0;
    ASSERT(awt_forest_set_params(f, &params, NULL) == AWT_OK);
    CHECK_NEAR(greatest_agitation(f), 0, 0);
    ASSERT(awt_forest_advance(f, 2000000, NULL, NULL) == AWT_OK);
    CHECK_NEAR(greatest_agitation(f), 0, 0);
    awt_forest_destroy(f);
    awt_groom_destroy(groom);
}

TEST(agitation_is_part_of_a_snapshot)
{
    awt_groom *groom = small_groom("long", 3), *again;
    awt_params params = windy_params(0.8f);
    params.contact = 1;
    params.split_wind = 10, params.split_contact = 1;
    awt_forest *f = small_forest(groom, &params);
    ASSERT(awt_forest_advance(f, 1000000, NULL, NULL) == AWT_OK);
    awt_forest *restored = small_restored(f, &again);
    awt_step_stats stats = {0};
    uint32_t splits = 0;
    for (int n = 101; n <= 300; n++) {
        ASSERT(awt_forest_advance(f, (int64_t)n * AWT_STEP_US, &stats, NULL) == AWT_OK);
        ASSERT(awt_forest_advance(restored, (int64_t)n * AWT_STEP_US, NULL, NULL) == AWT_OK);
        CHECK_U64(awt_forest_hash(restored), awt_forest_hash(f));
        splits += stats.splits;
    }
    CHECK(splits > 10);
    awt_forest_destroy(restored);
    awt_groom_destroy(again);
    awt_forest_destroy(f);
    awt_groom_destroy(groom);
}
