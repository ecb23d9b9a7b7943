/* test_relay.c: the bad line that tests put between client and daemon does what it says, in simulated time. */
#include "check.h"
#include "relay/lane.h"

#include <string.h>

static bool put(lane *line, unsigned char value, size_t size, int64_t now_us)
{
    unsigned char *room = lane_room(line);
    if (room) {
        memset(room, value, size);
        lane_put(line, size, now_us);
    }
    return room != NULL;
}

TEST(relay_holds_each_piece_for_the_delay_and_keeps_the_order_under_jitter)
{
    const lane_rules rules = {.delay_us = 50000, .jitter_us = 30000, .queue = 100 * LANE_PIECE};
    lane line;
    size_t size;
    CHECK(lane_init(&line, &rules, 1));
    CHECK_INT(lane_next_us(&line), INT64_MAX);
    int64_t least_us = INT64_MAX, greatest_us = 0, last_us = 0;
    for (int i = 0; i < 100; i++) {
        const int64_t put_us = (int64_t)i * 100000;
        CHECK(put(&line, (unsigned char)i, 1, put_us));
        const int64_t way_us = lane_next_us(&line) - put_us;
        least_us = way_us < least_us ? way_us : least_us;
        greatest_us = way_us > greatest_us ? way_us : greatest_us;
        CHECK(!lane_due(&line, put_us + 49999, &size) && size == 0);
        CHECK(lane_due(&line, put_us + 80000, &size) && size == 1);
        lane_sent(&line, 1);
    }
    CHECK(least_us >= 50000 && least_us < 55000 && greatest_us <= 80000 && greatest_us > 75000);
    for (int i = 0; i < 100; i++) { /* all at once: jitter must not turn any around */
        CHECK(put(&line, (unsigned char)i, 1, 20000000 + i));
    }
    for (int i = 0; i < 100; i++) {
        CHECK(lane_next_us(&line) >= last_us);
        last_us = lane_next_us(&line);
        const unsigned char *bytes = lane_due(&line, last_us, &size);
        CHECK_INT(bytes ? *bytes : -1, i);
        lane_sent(&line, size);
    }
    lane_fini(&line);
}

TEST(relay_lets_no_more_bytes_through_than_its_rate)
{
    const lane_rules rules = {.delay_us = 1000, .rate = 100000, .queue = 4 * LANE_PIECE};
    lane line;
    CHECK(lane_init(&line, &rules, 1));
    for (int i = 0; i < 4; i++) {
        CHECK(put(&line, 7, 1000, 0));
    }
    CHECK(!put(&line, 7, 1000, 0)); /* full: the sender's socket has to wait */
    for (int i = 0; i < 4; i++) {
        CHECK_INT(lane_next_us(&line), 1000 + 10000 * (i + 1));
        lane_sent(&line, 600);
        lane_sent(&line, 400);
    }
    lane_fini(&line);
}
