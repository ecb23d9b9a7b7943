/* test_clock_jumps.c: clocks that jump. The wall clock concerns the log alone; where the monotonic one leaps, as it
 * does when a machine slept, time is dropped and not stepped through, and nobody is let go who could not have answered.
 */
#include "check.h"
#include "clock.h"
#include "unit/clock_seam.h"
#include "unit/memory_acts.h"
#include "unit/server_fixture.h"

#include <string.h>
#include <time.h>

enum { DAY_S = 86400, STEP_US = 10000, QUIET_US = 9000000, FOREST_GRACE_US = 20000000, SLEEP_US = 600000000 };

static wire on;
static talker who[3];

static void begin(void)
{
    CHECK(wire_begin(&on, 4));
    on.shared.options.quiet_us = QUIET_US;
    on.shared.options.forest_grace_us = FOREST_GRACE_US;
    on.shared.forests_due_us = fake_now_us;
    for (int i = 0; i < 3; i++) {
        talker_init(&who[i], &on, i);
    }
}

/* ---- the wall clock ---------------------------------------------------------------------------------------------- */

/* All that a client can have the daemon do, while the wall clock jumps; a sum of what it saw. */
static uint32_t play(int64_t jump_s)
{
    memory_scene s = {.on = &on, .victim = &who[0]};
    begin();
    for (int act = 0; act < MEMORY_ACTS; act++) {
        clock_shift_wall(act % 3 == 0 ? jump_s : act % 3 == 1 ? -jump_s : 0);
        memory_act(&s, act);
    }
    clock_shift_wall(0);
    CHECK_INT(who[0].errors, 0);
    const uint32_t sum = who[0].sum;
    wire_end(&on);
    return sum;
}

TEST(clock_of_the_wall_concerns_nothing_but_the_log)
{
    struct timespec now;
    uint64_t before = clock_wall_readings();
    clock_shift_wall(DAY_S);
    CHECK_INT(clock_gettime(CLOCK_REALTIME, &now), 0);
    CHECK(clock_wall_readings() == before + 1); /* they are counted, and it jumps */
    const time_t late = now.tv_sec;
    clock_shift_wall(0);
    CHECK_INT(clock_gettime(CLOCK_REALTIME, &now), 0);
    CHECK(late - now.tv_sec >= DAY_S - 1);
    before = clock_wall_readings();
    const uint32_t calm = play(0);
    CHECK_U64(play(DAY_S), calm);
    CHECK_U64(clock_wall_readings(), before); /* it was not asked at all */
}

/* ---- leaps of the monotonic clock -------------------------------------------------------------------------------- */

static proto_message clock_of(const talker *t)
{
    proto_message message = {.type = PROTO_SET_CLOCK};
    message.as.set_clock.forest = t->forest;
    message.as.set_clock.mode = CLOCK_FREE;
    message.as.set_clock.rate = 1;
    return message;
}

static const resident *forest_of(const talker *t)
{
    return registry_find(&on.shared.forests, t->forest);
}

/* A pose each step, a little ahead, of a head that does not rest. */
static void sway(uint32_t from, uint32_t to)
{
    for (uint32_t n = from; n <= to; n++) {
        const int64_t now_us = sim_clock_at(&forest_of(&who[0])->clock, fake_now_us);
        proto_message motion = fake_motion(who[0].forest, n, now_us + 3 * STEP_US);
        motion.as.motion.head.position[0] = 0.02 * (n % 9);
        talker_say(&who[0], motion);
        wire_pass(&on, STEP_US);
    }
}

TEST(clock_that_leaps_has_no_forest_stepped_through_it_and_drops_the_time)
{
    begin();
    for (int i = 0; i < 2; i++) {
        CHECK(talker_come(&who[i]) && talker_ask(&who[i], memory_create(5)));
        CHECK(talker_ask(&who[i], clock_of(&who[i])));
    }
    proto_message subscribe = {.type = PROTO_SUBSCRIBE}; /* one is looked at, the other is not */
    subscribe.as.subscribe.forest = who[0].forest;
    subscribe.as.subscribe.kind = GEOM_GUIDES;
    subscribe.as.subscribe.credit = 1000;
    CHECK(talker_ask(&who[0], subscribe));
    sway(1, 50);
    const service_counters before = on.shared.counters;
    CHECK(who[0].frames > 40);
    CHECK_U64(before.dropped_us, 0);
    who[0].frames = 0;
    wire_pass(&on, SLEEP_US);
    const service_counters *after = &on.shared.counters;
    CHECK(after->steps - before.steps < 50);
    CHECK(after->dropped_us > 2 * (SLEEP_US - 500000) && after->dropped_us <= 2 * (uint64_t)SLEEP_US);
    CHECK(who[0].frames >= 1 && who[0].frames <= 2); /* not all that were missed */
    for (int i = 0; i < 2; i++) {
        CHECK(forest_of(&who[i])->state_us > SLEEP_US);
        CHECK(forest_of(&who[i])->state_us <= fake_now_us);
    }
    who[0].frames = 0;
    const uint64_t dropped_us = after->dropped_us;
    sway(51, 100);
    CHECK(who[0].frames > 40); /* it goes on as before */
    CHECK_U64(after->dropped_us, dropped_us);
    wire_end(&on);
}

static void answer_ping(talker *t)
{
    talker_say(t, (proto_message){.type = PROTO_PONG});
}

/* Somebody is silent, somebody reads nothing of what waits for it, somebody was cut off, somebody has not said HELLO.
 */
TEST(clock_that_leaps_has_nobody_let_go_who_could_not_have_answered)
{
    enum { SILENT, DEAF, CUT, NEW, LOOKS = 40 };
    begin();
    for (int i = 0; i < 3; i++) {
        CHECK(talker_come(&who[i]) && talker_ask(&who[i], memory_create(5)));
    }
    CHECK(wire_connect(&on, NEW, who[SILENT].on->clients[SILENT].hear, &who[SILENT]));
    on.clients[DEAF].deaf = true;
    for (uint64_t n = 0; n < LOOKS; n++) {
        proto_message look = memory_look(&who[DEAF], GEOM_RIBBON, 0, 0);
        look.request = 100 + n;
        wire_send(&on, DEAF, &look);
    }
    wire_cut(&on, CUT);
    wire_pass(&on, 1000000);
    CHECK_INT(on.shared.counters.sessions, 3);
    for (int sleep = 0; sleep < 2; sleep++) {
        wire_pass(&on, SLEEP_US);
        CHECK_INT(on.shared.counters.sessions, 3);
        answer_ping(&who[SILENT]);
    }
    proto_message resume = {.type = PROTO_RESUME};
    memcpy(resume.as.resume.session, who[CUT].session, sizeof who[CUT].session);
    CHECK(talker_come(&who[CUT]) && talker_ask(&who[CUT], resume));
    CHECK_INT(who[CUT].resumed, 1);
    for (int n = 0; n < 40; n++) { /* and then they have as long as ever */
        wire_pass(&on, 1000000);
        answer_ping(&who[CUT]);
    }
    CHECK(!wire_is_there(&on, SILENT) && on.clients[DEAF].served == NULL && !wire_is_there(&on, NEW));
    CHECK_INT(on.shared.counters.sessions, 1);
    wire_end(&on);
}

/* One that nobody has open is not ended for the time that passed while nobody could open it. */
TEST(clock_that_leaps_ends_no_forest_that_was_left)
{
    begin();
    CHECK(talker_come(&who[0]) && talker_ask(&who[0], memory_create(5)));
    talker_say(&who[0], (proto_message){.type = PROTO_BYE});
    wire_pass(&on, 1000000);
    CHECK_INT(on.shared.counters.sessions, 0);
    wire_pass(&on, SLEEP_US);
    CHECK_INT(registry_ready_count(&on.shared.forests), 1);
    for (int n = 0; n < 22; n++) {
        wire_pass(&on, 1000000);
    }
    CHECK_INT(registry_ready_count(&on.shared.forests), 0);
    wire_end(&on);
}
