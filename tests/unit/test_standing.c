/* test_standing.c: real hair on a head that nobody moves stays as its file drew it: the style springs carry its weight
 * (rest_gravity), and nothing pushes it away from where it lies. */
#include "check.h"
#include "groom_fixture.h"
#include "invariant_fixture.h"

#include <stdio.h>
#include <stdlib.h>

enum { STANDING_S = 3 };

#define MOST_MEAN_M 0.002

/* How far the strands of a groom, that of `path`, are from its file after so long, mean. */
static double drift_of(const awt_groom *groom, const char *path)
{
    awt_forest_def start = awt_forest_def_default(groom);
    awt_forest *forest = NULL;
    awt_step_stats stats;
    CHECK(awt_forest_create(groom, &start, &forest, NULL) == AWT_OK);
    strand_points before = strand_points_of(forest);
    CHECK_INT(awt_forest_advance(forest, STANDING_S * INT64_C(1000000), &stats, NULL), AWT_OK);
    strand_points after = strand_points_of(forest);
    const double mean_m = strand_points_mean(&before, &after) + awt_groom_rebuilt(groom).mean_m;
    printf("     %s: %.3f mm mean, %.2f mm at most from its file after %d s; %u of %u trees asleep\n", path,
           1e3 * mean_m, 1e3 * (strand_points_greatest(&before, &after) + awt_groom_rebuilt(groom).max_m), STANDING_S,
           (unsigned)stats.asleep_trees, (unsigned)groom->info.wisp_count[0]);
    strand_points_fini(&before);
    strand_points_fini(&after);
    awt_forest_destroy(forest);
    return mean_m;
}

TEST(standing_real_grooms_stay_as_their_files_drew_them)
{
    for (size_t i = 0; i < GROOM_FIXTURE_REAL; i++) {
        const char *path = check_data(groom_fixture_real[i].file);
        if (!path) {
            check_skip("the real strand files are not on this machine (AWT_DATA)");
            return;
        }
        awt_groom *groom = groom_fixture_build_real(&groom_fixture_real[i], path);
        if (groom) {
            const double mean_m = drift_of(groom, path);
            CHECK(mean_m >= 0 && mean_m <= MOST_MEAN_M);
        }
        awt_groom_destroy(groom);
    }
}
