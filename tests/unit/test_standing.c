/* test_standing.c: real hair on a head that nobody moves stays as its file drew it: the style springs carry its weight
 * (rest_gravity), and nothing pushes it away from where it lies. */
#include "check.h"
#include "groom_fixture.h"
#include "invariant_fixture.h"

#include <stdio.h>
#include <stdlib.h>

enum { STANDING_S = 3 };

#define MOST_MEAN_M 0.002

/* How far strands are from where they were after so long, mean; < 0: the file cannot be used. */
static double drift_of(const char *path, const awt_placement *known)
{
    size_t size = 0;
    unsigned char *bytes = check_read_file(path, &size);
    awt_strands strands = {0};
    awt_placement placement = *known;
    double mean_m = -1;
    if (bytes && awt_strands_read(bytes, size, &strands, NULL) == AWT_OK &&
        awt_strands_place(&strands, &placement, NULL) == AWT_OK) {
        awt_groom_def def = awt_groom_def_default();
        def.head_radius_m = placement.head_radius_m;
        awt_groom *groom = groom_fixture_build(&strands, &def);
        awt_forest_def start = awt_forest_def_default(groom);
        awt_forest *forest = NULL;
        awt_step_stats stats;
        CHECK(awt_forest_create(groom, &start, &forest, NULL) == AWT_OK);
        strand_points before = strand_points_of(forest);
        CHECK_INT(awt_forest_advance(forest, STANDING_S * INT64_C(1000000), &stats, NULL), AWT_OK);
        strand_points after = strand_points_of(forest);
        mean_m = strand_points_mean(&before, &after) + awt_groom_rebuilt(groom).mean_m;
        printf("     %s: %.3f mm mean, %.2f mm at most from its file after %d s; %u of %u trees asleep\n", path,
               1e3 * mean_m, 1e3 * (strand_points_greatest(&before, &after) + awt_groom_rebuilt(groom).max_m),
               STANDING_S, (unsigned)stats.asleep_trees, (unsigned)groom->info.wisp_count[0]);
        strand_points_fini(&before);
        strand_points_fini(&after);
        awt_forest_destroy(forest);
        awt_groom_destroy(groom);
    }
    awt_strands_fini(&strands);
    free(bytes);
    return mean_m;
}

TEST(standing_real_grooms_stay_as_their_files_drew_them)
{
    static const struct {
        const char *file;
        awt_placement placement; /* where the roots do not show it */
    } grooms[] = {
        {"hair/sintel_16pt.v4.tfx", {.scale = 0}},
        {"hair/ratboy_mohawk.v4.tfx", {.scale = 0}},
        {"hair/yuksel_straight.hair", {.scale = 0}},
        {"hair/ponytail_tail.v3.tfx", {.scale = 0.01, .up = AWT_UP_Y, .head_radius = 10}},
        {"hair/ponytail_front_top.v3.tfx", {.scale = 0.01, .up = AWT_UP_Y, .head_radius = 10}},
    };
    for (size_t i = 0; i < sizeof grooms / sizeof grooms[0]; i++) {
        const char *path = check_data(grooms[i].file);
        if (!path) {
            check_skip("the real strand files are not on this machine (AWT_DATA)");
            return;
        }
        double mean_m = drift_of(path, &grooms[i].placement);
        CHECK(mean_m >= 0 && mean_m <= MOST_MEAN_M);
    }
}
