/* test_groom_parts.c: what grooms are built with: strands measured and sampled, items clustered. */
#include "check.h"

#include "base/rng.h"
#include "groom/cluster.h"
#include "groom/polyline.h"

TEST(polyline_keeps_its_own_points_and_spaces_new_ones_evenly)
{
    const float corner[9] = {0, 0, 0, 0.3f, 0, 0, 0.3f, 0.1f, 0};
    polyline line;
    vec3 out[9];
    polyline_measure(&line, corner, 3);
    CHECK_NEAR(polyline_length(&line), 0.4, 1e-7);
    polyline_resample(&line, 3, out);
    CHECK_BYTES(out, corner, sizeof corner);
    polyline_resample(&line, 9, out);
    CHECK_BYTES(&out[8], &corner[6], sizeof(vec3));
    for (int i = 1; i < 9; i++) {
        CHECK_NEAR(vec3_distance(out[i], out[i - 1]), 0.05, 1e-6);
    }
}

TEST(cluster_shares_are_whole_and_never_more_than_a_group_has)
{
    const uint32_t sizes[6] = {1, 1, 90, 3, 1, 4};
    uint32_t shares[6];
    for (uint32_t total = 6; total <= 100; total++) {
        uint32_t sum = 0;
        cluster_share(sizes, 6, total, shares);
        for (int g = 0; g < 6; g++) {
            CHECK(shares[g] >= 1 && shares[g] <= sizes[g]);
            sum += shares[g];
        }
        CHECK_INT(sum, total);
    }
}

TEST(cluster_finds_groups_that_lie_apart)
{
    enum { GROUPS = 5, EACH = 40, ITEMS = GROUPS * EACH };
    static float features[ITEMS][CLUSTER_FEATURES];
    static uint32_t order[ITEMS], part[ITEMS], moved[ITEMS];
    static double nearest[ITEMS];
    rng r = rng_seed(3);
    for (uint32_t i = 0; i < ITEMS; i++) {
        order[i] = i;
        for (int f = 0; f < CLUSTER_FEATURES; f++) {
            features[i][f] = (float)(10.0 * ((i % GROUPS == (uint32_t)f) ? 1.0 : 0.0) + rng_unit(&r));
        }
    }
    cluster_set set = {&features[0][0], order, part, moved, nearest};
    uint32_t sizes[GROUPS];
    cluster_split(&set, 0, ITEMS, GROUPS, sizes);
    for (uint32_t p = 0, place = 0; p < GROUPS; p++) {
        CHECK_INT(sizes[p], EACH);
        for (uint32_t k = 0; k < sizes[p]; k++, place++) {
            CHECK_INT(order[place] % GROUPS, order[place - k] % GROUPS);
            CHECK(k == 0 || order[place] > order[place - 1]);
        }
    }
}

TEST(cluster_deals_out_items_that_coincide)
{
    enum { ITEMS = 5000, PARTS = 3000 };
    static float features[ITEMS][CLUSTER_FEATURES];
    static uint32_t order[ITEMS], part[ITEMS], moved[ITEMS], sizes[PARTS];
    static double nearest[ITEMS];
    for (uint32_t i = 0; i < ITEMS; i++) {
        order[i] = i;
    }
    cluster_set set = {&features[0][0], order, part, moved, nearest};
    cluster_split(&set, 0, ITEMS, PARTS, sizes);
    uint32_t sum = 0;
    for (uint32_t p = 0; p < PARTS; p++) {
        CHECK(sizes[p] >= 1 && sizes[p] <= 2);
        sum += sizes[p];
    }
    CHECK_INT(sum, ITEMS);
}
