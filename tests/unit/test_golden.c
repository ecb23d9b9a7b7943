/* test_golden.c: the very bits that a known motion gives, whatever compiler, optimisation or machine. A change of these
 * numbers is a change of the physics, and is made on purpose. */
#include "check.h"
#include "fixture.h"

/* Requests of a bow, and of the rest after it: two sub-steps each, and not of 10 ms. */
enum { BOW_REQUESTS = 200, REST_REQUESTS = 350, REQUEST_US = 12000 };

/* The bow that stops where it is. */
static awt_motion bow(int64_t time_us)
{
    const int64_t bowing_us = (int64_t)BOW_REQUESTS * REQUEST_US;
    awt_motion m = fixture_bow(time_us < bowing_us ? time_us : bowing_us);
    m.time_us = time_us;
    return m;
}

static uint64_t hash_of_bow(const char *style, uint32_t *splits)
{
    const double zero[3] = {0, 0, 0};
    awt_forest *f = fixture_forest(fixture_groom(style, 1000), style, zero, zero);
    awt_step_stats stats = {0};
    for (int n = 1; n <= BOW_REQUESTS + REST_REQUESTS; n++) {
        awt_motion m = bow((int64_t)n * REQUEST_US);
        CHECK_INT(awt_forest_move(f, &m, NULL), AWT_OK);
        CHECK_INT(awt_forest_advance(f, m.time_us, &stats, NULL), AWT_OK);
        *splits += stats.splits;
    }
    CHECK(stats.asleep_trees > 0); /* whose offsets still relax: part of the hash too */
    uint64_t hash = awt_forest_hash(f);
    awt_forest_destroy(f);
    return hash;
}

TEST(golden_bits_of_a_known_motion)
{
    static const struct {
        const char *style;
        uint64_t hash;
    } golden[] = {
        {"short", UINT64_C(0x184a0cc01bc351f9)},
        {"short-curly", UINT64_C(0x55a734f4c6f24a7d)},
        {"long", UINT64_C(0x5733c46fa079bcc8)},
        {"long-curly", UINT64_C(0x853978f7172da0d9)},
    };
    for (size_t k = 0; k < sizeof golden / sizeof golden[0]; k++) {
        uint32_t splits = 0;
        CHECK_U64(hash_of_bow(golden[k].style, &splits), golden[k].hash);
        CHECK(splits > 10);
    }
}
