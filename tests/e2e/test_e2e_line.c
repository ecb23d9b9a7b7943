/* test_e2e_line.c: the daemon at the far end of a bad line. */
#include "check.h"
#include "e2e/daemon.h"

TEST(e2e_a_bad_line_delays_what_goes_through_it_and_loses_nothing)
{
    daemon_process daemon;
    line_process line = {0};
    CHECK(daemon_start(&daemon, 1, NULL));
    CHECK(line_start(&line, daemon.address, "15", "5", "1000000"));
    awtclient_error error = {0};
    awtclient *client = awtclient_open(
        &(awtclient_options){.address = line.address, .token_file = daemon.token_file, .name = "far"}, &error);
    CHECK_TEXT(error.text, "");
    for (int i = 0; client && i < 5; i++) {
        proto_message ping = {.type = PROTO_PING}, list = {.type = PROTO_LIST_STYLES}, answer;
        ping.as.ping.sent_us = awtclient_now_us();
        CHECK(awtclient_call(client, &ping, &answer, &error));
        CHECK(awtclient_now_us() - answer.as.pong.sent_us >= 30000); /* there and back */
        CHECK(awtclient_call(client, &list, &answer, &error));
        CHECK(answer.as.list_styles_reply.styles.count >= 4);
    }
    awtclient_close(client);
    line_stop(&line);
    CHECK_INT(daemon_stop(&daemon), 0);
}
