/* test_server_connection.c: connections whose peers go away, or take nothing, in the midst of much. */
#include "check.h"
#include "unit/memory_acts.h"
#include "unit/server_fixture.h"

static wire on;
static talker who;

/* It takes no more of what was sent to it, and has more requests under way than may wait for a worker. */
static void overload(void)
{
    enum { LOOKS = 40, STEPS = 20 };
    CHECK(wire_begin(&on, 2));
    talker_init(&who, &on, 0);
    CHECK(talker_come(&who) && talker_ask(&who, memory_create(1)));
    on.clients[0].deaf = true;
    for (uint64_t n = 0; n < LOOKS; n++) {
        proto_message look = memory_look(&who, GEOM_RIBBON, 0, 0);
        look.request = 100 + n;
        wire_send(&on, 0, &look);
    }
    wire_settle(&on);
    for (int64_t n = 1; n <= STEPS; n++) {
        const proto_message query = fake_query(who.forest, n * 10000);
        wire_send(&on, 0, &query);
    }
    wire_turns(&on);
    CHECK(on.clients[0].served != NULL);
    CHECK_INT(on.shared.counters.sessions, 1);
}

TEST(server_connection_of_a_peer_that_vanished_ends_though_requests_were_under_way)
{
    overload();
    wire_cut(&on, 0);
    wire_turns(&on); /* it finds that nobody is there, and waits for the workers */
    CHECK(on.clients[0].served != NULL);
    wire_settle(&on);
    CHECK(on.clients[0].served == NULL);
    CHECK_INT(on.shared.counters.sessions, 0);
    wire_end(&on);
}

TEST(server_connection_answers_all_once_its_peer_reads_again)
{
    overload();
    who.frames = 0;
    on.clients[0].deaf = false;
    wire_settle(&on);
    CHECK_INT(who.frames, 60);
    CHECK(on.clients[0].served != NULL);
    wire_end(&on);
}
