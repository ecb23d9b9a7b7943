/* test_server_loops.c: the small parts of the I/O threads: deadlines, homes and their bells. */
#include "check.h"
#include "base/rng.h"
#include "deadlines.h"
#include "limits.h"
#include "unit/server_fixture.h"
#include "home.h"

#include <poll.h>
#include <unistd.h>

TEST(server_deadlines_come_in_their_order_however_they_are_moved)
{
    enum { COUNT = 200 };
    deadlines all = {0};
    deadline list[COUNT] = {0};
    rng r = rng_seed(3);
    CHECK(deadlines_reserve(&all, COUNT));
    CHECK(deadlines_first(&all) == NULL);
    for (int n = 0; n < 20 * COUNT; n++) { /* set, move and take out, at random */
        bool out = rng_u32(&r) % 4 == 0;
        deadlines_set(&all, &list[rng_u32(&r) % COUNT], out ? INT64_MAX : (int64_t)(rng_u32(&r) % 1000));
    }
    uint32_t there = 0, came = 0;
    for (int i = 0; i < COUNT; i++) {
        there += list[i].place != 0;
    }
    CHECK(there > COUNT / 2 && there < COUNT);
    CHECK_INT(all.count, there);
    int64_t last_us = 0;
    for (deadline *d = deadlines_first(&all); d; d = deadlines_first(&all)) {
        CHECK(d->at_us >= last_us);
        last_us = d->at_us;
        deadlines_set(&all, d, INT64_MAX);
        CHECK_INT(d->place, 0);
        came++;
    }
    CHECK_INT(came, there);
    deadlines_fini(&all);
}

/* Bytes in a bell. */
static int rings(home *h)
{
    int count = 0;
    for (struct pollfd p = {.fd = h->bell.ends[0], .events = POLLIN}; poll(&p, 1, 0) == 1; count++) {
        char byte;
        if (read(p.fd, &byte, 1) != 1) {
            break;
        }
    }
    return count;
}

TEST(server_a_loop_that_sleeps_is_rung_once_however_many_have_work_for_it)
{
    service shared;
    homes all;
    int who[3] = {0};
    home_link links[3] = {{.owner = &who[0]}, {.owner = &who[1]}, {.owner = &who[2]}};
    CHECK(fake_service_init(&shared, 0, 1, false));
    CHECK(homes_init(&all, 2));
    home *h = &all.list[0];

    service_lock(&shared);
    home_tell(h, &shared, &links[0]); /* it is awake, and looks into its list before it sleeps */
    service_unlock(&shared);
    CHECK_INT(rings(h), 0);
    CHECK(home_take(h) == &who[0]);
    CHECK(home_take(h) == NULL);

    home_falls_asleep(h);
    for (int round = 0; round < 2; round++) {
        service_lock(&shared);
        home_tell(h, &shared, &links[round]);
        home_tell(h, &shared, &links[round]); /* stands there once */
        home_tell(h, &shared, &links[2]);
        service_unlock(&shared);
    }
    CHECK_INT(rings(h), 1);
    CHECK_INT(rings(&all.list[1]), 0);
    CHECK_INT(h->told, 3);
    home_wakes(h);
    CHECK(home_take(h) == &who[0]);
    CHECK(home_take(h) == &who[2]);
    CHECK(home_take(h) == &who[1]);
    home_falls_asleep(h);
    service_lock(&shared);
    home_ring(h, &shared);
    service_unlock(&shared);
    CHECK_INT(rings(h), 1);
    homes_fini(&all);
    service_fini(&shared);
}

TEST(server_hot_homes_fill_one_after_the_other_and_then_evenly)
{
    homes all;
    CHECK(homes_init(&all, 3));
    CHECK(homes_cold(&all)->is_cold);
    for (int n = 0; n < 3 * LIMIT_HOT_SET; n++) {
        home *h = homes_hot(&all);
        CHECK(h == &all.list[n / LIMIT_HOT_SET]);
        h->count++;
    }
    for (int n = 0; n < 30; n++) {
        homes_hot(&all)->count++;
    }
    for (int i = 0; i < 3; i++) {
        CHECK_INT(all.list[i].count, LIMIT_HOT_SET + 10);
    }
    CHECK_INT(homes_cold(&all)->count, 0);
    homes_fini(&all);
}
