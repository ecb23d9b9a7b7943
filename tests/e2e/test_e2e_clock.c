/* test_e2e_clock.c: forests that run by the daemon's clock, and several steps by one deadline, over the wire. */
#include "check.h"
#include "e2e/daemon.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t create(awtclient *client, uint64_t seed, struct proto_create_reply *made)
{
    awtclient_error error = {0};
    proto_message request = {.type = PROTO_CREATE}, answer = {0};
    request.as.create.style = proto_str_of("short");
    request.as.create.seed = seed;
    request.as.create.strands = 300;
    request.as.create.head.orientation[3] = request.as.create.body.orientation[3] = 1;
    CHECK(awtclient_call(client, &request, &answer, &error));
    CHECK_TEXT(error.text, "");
    *made = answer.as.create_reply;
    return made->forest;
}

/* What awtctl clock prints, and how it ends. */
static int awtctl_clock(const daemon_process *daemon, const struct proto_create_reply *made, const char *mode,
                        char *line, int size)
{
    char command[1024], token[33];
    for (int i = 0; i < 16; i++) {
        snprintf(token + 2 * i, 3, "%02x", made->drive_token[i]);
    }
    snprintf(
        command, sizeof command, "%s/awtctl clock %llu %s --drive-token %s --connect %s --token-file %s 2>/dev/null",
        check_build_directory(), (unsigned long long)made->forest, mode, token, daemon->address, daemon->token_file);
    FILE *said = popen(command, "r");
    CHECK(said != NULL);
    line[0] = '\0';
    if (said && !fgets(line, size, said)) {
        line[0] = '\0';
    }
    return said ? pclose(said) : -1;
}

TEST(e2e_forest_runs_by_the_daemons_clock_and_stands_when_paused)
{
    daemon_process daemon;
    awtclient_error error = {0};
    struct proto_create_reply made;
    char line[256];
    CHECK(daemon_start(&daemon, 2, NULL));
    awtclient *client = daemon_client(&daemon);
    proto_message message = {.type = PROTO_SUBSCRIBE}, answer = {0};
    message.as.subscribe = (struct proto_subscribe){
        .forest = create(client, 1, &made), .kind = 2, .greatest_rate = 50, .credit = UINT32_MAX};
    CHECK(awtclient_call(client, &message, &answer, &error));
    CHECK_INT(awtctl_clock(&daemon, &made, "free --rate 2", line, sizeof line), 0);
    CHECK(strstr(line, ": free, at 0.0") != NULL);
    int64_t last_us = -1;
    for (int frames = 0; frames < 10; frames++) { /* nobody asks for them */
        CHECK(awtclient_receive(client, &answer, &error));
        CHECK_INT(answer.type, PROTO_FRAME);
        CHECK(answer.as.frame.time_us > last_us);
        last_us = answer.as.frame.time_us;
    }
    CHECK_TEXT(error.text, "");
    CHECK_INT(awtctl_clock(&daemon, &made, "pause", line, sizeof line), 0);
    CHECK(strstr(line, ": pause, at") != NULL);
    message = (proto_message){.type = PROTO_SET_CLOCK};
    message.as.set_clock = (struct proto_set_clock){.forest = made.forest, .mode = 2};
    CHECK(awtclient_call(client, &message, &answer, &error));
    const int64_t paused_us = answer.as.set_clock_reply.time_us;
    CHECK(paused_us >= last_us);
    message.request = 0;
    CHECK(awtclient_call(client, &message, &answer, &error));
    CHECK_INT(answer.as.set_clock_reply.time_us, paused_us); /* though time has passed */
    CHECK(awtctl_clock(&daemon, &made, "backwards", line, sizeof line) != 0);
    awtclient_close(client);
    CHECK_INT(daemon_stop(&daemon), 0);
}

TEST(e2e_several_forests_step_by_one_deadline)
{
    enum { FORESTS = 3 };
    daemon_process daemon;
    awtclient_error error = {0};
    struct proto_create_reply made[FORESTS];
    bool seen[FORESTS] = {false};
    CHECK(daemon_start(&daemon, 2, NULL));
    awtclient *client = daemon_client(&daemon);
    proto_message message = {.type = PROTO_STEP_MANY, .request = 4711}, answer = {0};
    message.as.step_many.deadline_us = 60000000;
    message.as.step_many.forests.count = FORESTS;
    for (int i = 0; i < FORESTS; i++) {
        message.as.step_many.forests.items[i] =
            (struct proto_step_request){create(client, (uint64_t)i, &made[i]), 20000};
    }
    CHECK(awtclient_send(client, &message, &error));
    for (int n = 0; n < FORESTS; n++) {
        CHECK(awtclient_receive(client, &answer, &error));
        CHECK_INT(answer.type, PROTO_FRAME);
        CHECK_U64(answer.request, message.request);
        CHECK_INT(answer.as.frame.time_us, 20000);
        CHECK_INT(answer.as.frame.flags, 0);
        for (int i = 0; i < FORESTS; i++) {
            seen[i] = seen[i] || answer.as.frame.forest == made[i].forest;
        }
    }
    CHECK(seen[0] && seen[1] && seen[2]);
    message.request = 4712;
    message.as.step_many.deadline_us = 0; /* nobody is so fast: all are answered with what there is, or with the step */
    message.as.step_many.forests.items[0].time_us = message.as.step_many.forests.items[1].time_us =
        message.as.step_many.forests.items[2].time_us = 5000000;
    CHECK(awtclient_send(client, &message, &error));
    for (int n = 0; n < FORESTS; n++) {
        CHECK(awtclient_receive(client, &answer, &error));
        CHECK_INT(answer.type, PROTO_FRAME);
        CHECK_U64(answer.request, message.request);
        CHECK_INT(answer.as.frame.time_us, answer.as.frame.flags ? 20000 : 5000000);
    }
    CHECK_TEXT(error.text, "");
    awtclient_close(client);
    CHECK_INT(daemon_stop(&daemon), 0);
}
