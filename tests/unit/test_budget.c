/* test_budget.c: the budget of splits of a step: it is kept, it is nobody's loss for long, and merges know nothing of
 * it. */
#include "check.h"
#include "invariant_fixture.h"

#include "base/assert.h"
#include "sim/state.h"

#include <stdlib.h>

/* Sections by which the GCs of a tree are split, all together. */
static uint32_t open_sections(const awt_forest *f, uint32_t t)
{
    uint32_t open = 0;
    for (uint32_t g = 0; g < f->groom->gc_count; g++) {
        open += f->groom->gc_tree[g] == t ? f->groom->info.sections - f->first_split[g] : 0;
    }
    return open;
}

typedef struct played {
    uint32_t most_splits, most_merges, splits, merges; /* the first two: in one step */
    uint32_t greatest_active, active;
    uint64_t hash;
} played;

/* A second of motion and three of rest. */
static played play(const awt_groom *groom, float budget)
{
    awt_params params = small_params("long");
    params.split_threshold = 0.1f;
    params.split_budget = budget;
    awt_forest *f = small_forest(groom, &params);
    wild w = wild_make(7, 1.0);
    played p = {0};
    for (int n = 1; n <= 400; n++) {
        awt_step_stats stats;
        if (n <= 100) {
            wild_advance(f, &w, (int64_t)n * AWT_STEP_US, &stats);
        } else {
            ASSERT(awt_forest_advance(f, (int64_t)n * AWT_STEP_US, &stats, NULL) == AWT_OK);
        }
        p.splits += stats.splits;
        p.merges += stats.merges;
        p.most_splits = stats.splits > p.most_splits ? stats.splits : p.most_splits;
        p.most_merges = stats.merges > p.most_merges ? stats.merges : p.most_merges;
        p.greatest_active = stats.active_nodes > p.greatest_active ? stats.active_nodes : p.greatest_active;
        p.active = stats.active_nodes;
    }
    p.hash = awt_forest_hash(f);
    awt_forest_destroy(f);
    return p;
}

TEST(a_step_splits_no_more_than_its_budget_and_merges_what_it_likes)
{
    awt_groom *groom = small_groom("long", 3);
    played free_of_it = play(groom, 0), thrifty = play(groom, 2.5f);
    CHECK(free_of_it.most_splits > 10);
    CHECK_INT(thrifty.most_splits, 3); /* 2.5 rounded up */
    CHECK(thrifty.most_merges > 3);
    CHECK(thrifty.splits > 50);
    CHECK(thrifty.greatest_active > groom->info.coarse_nodes + 50);
    CHECK_INT(thrifty.active, groom->info.coarse_nodes);
    awt_groom_destroy(groom);
}

TEST(a_budget_that_is_never_spent_changes_no_bit)
{
    awt_groom *groom = small_groom("long", 3);
    played free_of_it = play(groom, 0), rich = play(groom, (float)free_of_it.most_splits + 1);
    CHECK_U64(rich.hash, free_of_it.hash);
    CHECK_INT(rich.splits, free_of_it.splits);
    awt_groom_destroy(groom);
}

/* Every tree wants more than its share in every step. */
TEST(no_tree_starves_on_a_small_budget)
{
    awt_groom *groom = small_groom("long", 3);
    awt_params params = small_params("long");
    params.split_threshold = params.residence = 0;
    params.split_budget = 1;
    awt_forest *f = small_forest(groom, &params);
    const uint32_t trees = groom->info.wisp_count[0];
    wild w = wild_make(7, 1.0);
    int n = 0;
    for (uint32_t round = 1; round <= 4; round++) {
        for (uint32_t k = 0; k < trees; k++) {
            awt_step_stats stats;
            n++;
            wild_advance(f, &w, (int64_t)n * AWT_STEP_US, &stats);
            CHECK_INT(stats.splits, 1);
        }
        uint32_t least = UINT32_MAX, most = 0;
        for (uint32_t t = 0; t < trees; t++) {
            uint32_t open = open_sections(f, t);
            least = open < least ? open : least;
            most = open > most ? open : most;
        }
        CHECK_INT(least, round);
        CHECK_INT(most, round);
    }
    awt_forest_destroy(f);
    awt_groom_destroy(groom);
}

TEST(whose_turn_it_is_to_split_is_part_of_a_snapshot)
{
    awt_groom *groom = small_groom("long", 3), *again;
    awt_params params = small_params("long");
    params.split_threshold = 0.05f;
    params.split_budget = 2;
    awt_forest *f = small_forest(groom, &params);
    wild w = wild_make(7, 1.0);
    int n = 0;
    while (f->split_from == 0) {
        ASSERT(++n < 100);
        wild_advance(f, &w, (int64_t)n * AWT_STEP_US, NULL);
    }
    awt_forest *restored = small_restored(f, &again);
    CHECK_INT(restored->split_from, f->split_from);
    for (int last = n + 50; n < last; n++) {
        wild_advance(f, &w, (int64_t)(n + 1) * AWT_STEP_US, NULL);
        wild_advance(restored, &w, (int64_t)(n + 1) * AWT_STEP_US, NULL);
        CHECK_U64(awt_forest_hash(restored), awt_forest_hash(f));
    }
    awt_forest_destroy(restored);
    awt_groom_destroy(again);
    awt_forest_destroy(f);
    awt_groom_destroy(groom);
}
