/* test_lead.c: a game that predicts its head, at the end of an uneven line, in simulated time: how far ahead it asks
 * (awtlead.h), how much it has on the way (awtclock.h), and that what it shows goes on as evenly as its ticks. The line
 * is the relay's own (relay/lane.h), the daemon one that answers in no time as long as it has credit. */
#include "check.h"
#include "awtclock.h"
#include "awtlead.h"
#include "framemix.h"
#include "relay/lane.h"

#include <stdlib.h>
#include <string.h>

enum { UP, DOWN, RATE = 60, STEP_US = 1000000 / RATE, OLDEST_US = 250000, WARM_UP_US = 10000000 };

typedef enum word_type { WORD_MOTION, WORD_PING, WORD_CREDIT, WORD_FRAME, WORD_PONG } word_type;

typedef struct word {
    word_type type;
    int64_t time_us; /* simulated, or when a ping was sent; of CREDIT: how much */
} word;

/* What was seen since the beginning of the second that counts. */
typedef struct seen {
    uint64_t ticks, between, asked, frames;
    int64_t stall_us, longest_stall_us, uneven_us; /* as engine_measure.h; the greatest difference of a step shown */
    int64_t greatest_lead_us;
} seen;

typedef struct game {
    lane lanes[2];
    awtclock clock;
    awtlead lead;
    framemix mix;
    uint32_t daemon_credit, under_way;
    int64_t daemon_pause_us, daemon_free_us, shown_us;
    seen seen;
} game;

static void say(game *g, int way, word_type type, int64_t time_us, int64_t now_us)
{
    const word said = {type, time_us};
    unsigned char *room = lane_room(&g->lanes[way]);
    CHECK(room != NULL);
    if (room) {
        memcpy(room, &said, sizeof said);
        lane_put(&g->lanes[way], sizeof said, now_us);
    }
}

static bool hear(game *g, int way, int64_t now_us, word *heard)
{
    size_t size;
    const unsigned char *bytes = lane_due(&g->lanes[way], now_us, &size);
    if (bytes) {
        memcpy(heard, bytes, sizeof *heard);
        lane_sent(&g->lanes[way], size);
    }
    return bytes != NULL;
}

static void run_daemon(game *g, int64_t now_us)
{
    word heard;
    if (now_us < g->daemon_free_us) {
        return;
    }
    while (hear(g, UP, now_us, &heard)) {
        g->daemon_credit += heard.type == WORD_CREDIT ? (uint32_t)heard.time_us : 0;
        if (heard.type == WORD_PING) {
            say(g, DOWN, WORD_PONG, heard.time_us, now_us);
        } else if (heard.type == WORD_MOTION && g->daemon_credit > 0) {
            g->daemon_credit--;
            say(g, DOWN, WORD_FRAME, heard.time_us, now_us);
        }
    }
}

static void add_frame(game *g, int64_t time_us)
{
    float positions[6] = {0}, widths[2] = {0};
    geom_strands strands = {.strand_count = 1, .points_per_strand = 2, .positions = positions, .time_us = time_us};
    strands.widths = widths;
    strands.head.orientation[3] = 1;
    CHECK(framemix_add(&g->mix, &strands));
}

static void run_client(game *g, int64_t now_us)
{
    word heard;
    while (hear(g, DOWN, now_us, &heard)) {
        if (heard.type == WORD_PONG) {
            CHECK(awtclock_add(&g->clock, heard.time_us, now_us, now_us, now_us));
            continue;
        }
        add_frame(g, heard.time_us);
        awtlead_came(&g->lead, now_us, heard.time_us);
        g->seen.frames++;
        g->under_way -= g->under_way > 0;
    }
    const uint32_t window = awtclock_credit(&g->clock, RATE, OLDEST_US);
    if (g->under_way < window) {
        say(g, UP, WORD_CREDIT, window - g->under_way, now_us);
        g->under_way = window;
    }
}

static void show(game *g, int64_t now_us, int64_t tick_us)
{
    awtframes_shown shown;
    int64_t at_us;
    if (awtlead_ask(&g->lead, now_us, &at_us)) {
        say(g, UP, WORD_MOTION, at_us, now_us);
        g->seen.asked++;
    }
    if (!framemix_show(&g->mix, now_us, &shown)) {
        return;
    }
    seen *s = &g->seen;
    const int64_t went_us = shown.time_us - g->shown_us,
                  off_us = went_us > tick_us ? went_us - tick_us : tick_us - went_us;
    CHECK(went_us >= 0);
    s->ticks++;
    s->between += shown.way == AWTFRAMES_BETWEEN;
    s->stall_us = 2 * went_us < tick_us ? s->stall_us + tick_us : 0;
    s->longest_stall_us = s->stall_us > s->longest_stall_us ? s->stall_us : s->longest_stall_us;
    s->uneven_us = off_us > s->uneven_us ? off_us : s->uneven_us;
    s->greatest_lead_us = awtlead_us(&g->lead) > s->greatest_lead_us ? awtlead_us(&g->lead) : s->greatest_lead_us;
    g->shown_us = shown.time_us;
}

/* A minute of a game, of which the first seconds do not count. In its middle the daemon stands still for `pause_us`. */
static seen play(int rate, int64_t delay_us, int64_t jitter_us, int64_t pause_us, uint64_t seed)
{
    static game g;
    const lane_rules rules = {.delay_us = delay_us, .jitter_us = jitter_us, .queue = 256 * LANE_PIECE};
    const int64_t tick_us = 1000000 / rate;
    memset(&g, 0, sizeof g);
    framemix_init(&g.mix, 40000);
    CHECK(lane_init(&g.lanes[UP], &rules, 2 * seed) && lane_init(&g.lanes[DOWN], &rules, 2 * seed + 1));
    awtlead_begin(&g.lead, STEP_US, OLDEST_US, 2 * delay_us + jitter_us);
    int64_t next_us = 0, next_ping_us = 0;
    for (int64_t now_us = 0; now_us < 60000000; now_us += 500) {
        g.daemon_free_us = pause_us > 0 && now_us == 30000000 ? now_us + pause_us : g.daemon_free_us;
        if (now_us >= next_ping_us) {
            say(&g, UP, WORD_PING, now_us, now_us);
            next_ping_us += 1000000;
        }
        run_daemon(&g, now_us);
        run_client(&g, now_us);
        if (now_us == WARM_UP_US) {
            g.seen = (seen){.ticks = 0};
        }
        if (now_us >= next_us) {
            show(&g, next_us, tick_us);
            next_us += tick_us;
        }
    }
    lane_fini(&g.lanes[UP]);
    lane_fini(&g.lanes[DOWN]);
    framemix_fini(&g.mix);
    return g.seen;
}

TEST(lead_shows_hair_as_evenly_as_the_ticks_whatever_the_way)
{
    static const int64_t ways[][2] = {{0, 0}, {0, 2000}, {10000, 5000}, {50000, 20000}, {50000, 40000}};
    for (size_t w = 0; w < sizeof ways / sizeof ways[0]; w++) {
        for (uint64_t seed = 1; seed <= 3; seed++) {
            for (int rate = 60; rate <= 144; rate += 84) {
                const seen s = play(rate, ways[w][0], ways[w][1], 0, seed);
                CHECK(s.ticks >= (uint64_t)rate * 49);
                CHECK_INT(s.longest_stall_us, 0);
                CHECK(s.between * 1000 >= s.ticks * 999);
                CHECK(s.frames + 2 >= s.asked); /* none is left out for want of credit */
                const int64_t round_us = 2 * (ways[w][0] + ways[w][1]);
                CHECK(s.greatest_lead_us <= round_us + 2 * STEP_US); /* no more than is needed */
                CHECK(s.uneven_us <= (s.between == s.ticks ? 0 : 4000));
            }
        }
    }
}

TEST(lead_slows_hair_down_where_the_daemon_stood_still_and_goes_on)
{
    for (uint64_t seed = 1; seed <= 3; seed++) {
        const seen s = play(144, 50000, 20000, 50000, seed);
        CHECK_INT(s.longest_stall_us, 0);
        CHECK(s.between + 20 >= s.ticks);
        CHECK(s.greatest_lead_us <= OLDEST_US);
    }
}

TEST(lead_grows_at_once_shrinks_slowly_and_stays_within_its_bound)
{
    awtlead lead;
    int64_t now_us = 1000000, at_us, last_us = 0;
    awtlead_begin(&lead, STEP_US, 60000, 0);
    CHECK_INT(awtlead_us(&lead), 20000);
    for (int n = 0; n < 400; n++, now_us += STEP_US) {
        CHECK(awtlead_ask(&lead, now_us, &at_us));
        CHECK(at_us > last_us && !awtlead_ask(&lead, now_us + STEP_US / 2, &last_us));
        last_us = at_us;
        awtlead_came(&lead, now_us + (n == 20 ? 90000 : 5000), at_us);
        awtlead_came(&lead, now_us + 10000000, at_us - 1); /* nobody asked for that */
        if (n == 21) {
            CHECK_INT(awtlead_us(&lead), 60000);
        }
    }
    CHECK(awtlead_us(&lead) >= 5000 + STEP_US && awtlead_us(&lead) < 5000 + STEP_US + 15000);
    CHECK(awtlead_ask(&lead, now_us, &at_us));
    now_us += 18 * STEP_US; /* steps that were missed are left out, and the frame that waited meanwhile was not late */
    awtlead_came(&lead, now_us, at_us);
    last_us = awtlead_us(&lead);
    CHECK(awtlead_ask(&lead, now_us, &at_us) && !awtlead_ask(&lead, now_us + 1, &at_us));
    CHECK(awtlead_us(&lead) <= last_us);
}

TEST(lead_clock_takes_the_exchange_that_was_least_delayed)
{
    awtclock clock = {.count = 0};
    int64_t offset_us, uncertainty_us;
    CHECK(!awtclock_offset(&clock, &offset_us, &uncertainty_us));
    CHECK_INT(awtclock_credit(&clock, 60, 100000), 2);
    for (int64_t i = 0; i < 50; i++) { /* the daemon is 5 s ahead; the way out takes 10 ms and more, back 10 ms */
        const int64_t sent = i * 1000000, out = 10000 + i * 7919 % 30000;
        CHECK(awtclock_add(&clock, sent, sent + out + 5000000, sent + out + 5000100, sent + out + 10100));
    }
    CHECK(!awtclock_add(&clock, 0, 0, 0, -1));
    CHECK(!awtclock_add(&clock, 0, INT64_MAX, INT64_MIN, 1));
    CHECK(awtclock_offset(&clock, &offset_us, &uncertainty_us));
    CHECK(llabs(offset_us - 5000000) <= uncertainty_us && uncertainty_us < 12500);
    CHECK(awtclock_round_us(&clock) >= 20000 && awtclock_round_us(&clock) < 25000);
    CHECK(awtclock_age_us(&clock, 3000) >= 13000);
    clock.count = 0;
    CHECK(awtclock_add(&clock, 0, 50000, 50000, 100000));
    CHECK_INT(awtclock_credit(&clock, 60, 1000000), 8);   /* 100 ms there and back at 60 Hz, and more than one */
    CHECK(awtclock_add(&clock, 0, 70000, 70000, 140000)); /* it took more lately */
    CHECK_INT(awtclock_credit(&clock, 60, 1000000), 10);
    CHECK(awtclock_add(&clock, 0, 70000, 70000, 1000000)); /* so much is a queue */
    CHECK_INT(awtclock_credit(&clock, 60, 1000000), 11);
    CHECK_INT(awtclock_round_us(&clock), 100000);
    CHECK_INT(awtclock_credit(&clock, 60, 50000), 3);
    CHECK_INT(awtclock_credit(&clock, 60, 1), 1);
}
