/* test_e2e_session.c: a client of a daemon that is stopped or killed, and started again. */
#include "check.h"
#include "e2e/daemon.h"

#include <stdio.h>
#include <string.h>

enum { STEP_US = 16667 };

/* Drives one step; the time at which the hair is then. */
static int64_t step(awtclient *client, uint64_t forest, int n)
{
    static proto_message answer;
    awtclient_error error = {.text = ""};
    proto_message motion = {.type = PROTO_MOTION}, query = {.type = PROTO_QUERY};
    motion.as.motion = (struct proto_motion){.forest = forest, .sequence = (uint32_t)n, .time_us = n * STEP_US};
    motion.as.motion.head.orientation[3] = motion.as.motion.body.orientation[3] = 1;
    query.as.query = (struct proto_query){.forest = forest, .time_us = n * STEP_US, .kind = 1};
    const bool good = awtclient_send(client, &motion, &error) && awtclient_call(client, &query, &answer, &error);
    CHECK_TEXT(error.text, "");
    return good ? answer.as.frame.time_us : -1;
}

TEST(e2e_client_gets_its_hair_back_from_a_daemon_that_starts_again)
{
    static proto_message request, answer;
    daemon_process daemon;
    awtclient_error error = {.text = ""};
    uint32_t count = 0;
    CHECK(daemon_start(&daemon, 1, NULL));
    awtclient *client = daemon_client(&daemon);
    request = (proto_message){.type = PROTO_CREATE};
    request.as.create.style = proto_str_of("short");
    request.as.create.strands = 100;
    request.as.create.head.orientation[3] = request.as.create.body.orientation[3] = 1;
    CHECK(client && awtclient_call(client, &request, &answer, &error));
    CHECK_TEXT(error.text, "");
    const uint64_t forest = answer.as.create_reply.forest;
    if (client) {
        char address[sizeof daemon.address];
        snprintf(address, sizeof address, "%s", daemon.address);
        const char *const there[] = {"--listen", address, NULL};
        CHECK_INT(step(client, forest, 1), STEP_US);
        CHECK_INT(daemon_end(&daemon), 0);
        while (awtclient_receive(client, &answer, &error)) { /* GOAWAY */
        }
        CHECK_INT(error.code, AWTCLIENT_CLOSED);
        CHECK(daemon_start_again(&daemon, 1, there));
        CHECK(awtclient_reopen(client, 20000, &error));
        const awtsession_forest *forests = awtsession_forests(awtclient_session(client), &count);
        CHECK(count == 1 && forests[0].open && forests[0].may_drive && forests[0].forest == forest);
        CHECK_INT(step(client, forest, 2), 2 * STEP_US);
        request = (proto_message){.type = PROTO_DESTROY};
        request.as.destroy.forest = forest;
        CHECK(awtclient_call(client, &request, &answer, &error));
    }
    awtclient_close(client);
    CHECK_INT(daemon_stop(&daemon), 0);
}
