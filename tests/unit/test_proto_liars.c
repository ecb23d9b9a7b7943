/* test_proto_liars.c: the client library against whoever else may listen at that port: programs that lie, stop, or
 * never stop. It fails in bounded time, and says what it met. */
#include "check.h"
#include "codec.h"
#include "liars_fixture.h"
#include "socket.h"

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>

static void check_told(const liar *who, const awtclient_error *error)
{
    check_int(__FILE__, __LINE__, who->name, error->code, who->code);
    CHECK(error->text[0] != '\0');
}

TEST(client_that_waits_is_not_hurt_by_whoever_listens_there)
{
    static proto_message answer;
    for (const liar *who = LIARS; who < LIARS + LIAR_COUNT; who++) {
        fake server;
        awtclient_error error = {.code = 0};
        CHECK(fake_start(&server, who->script));
        const awtclient_options options = liar_options(who, &server);
        awtclient *client = awtclient_open(&options, &error);
        proto_message list = {.type = PROTO_LIST};
        CHECK(!client || !awtclient_call(client, &list, &answer, &error));
        check_told(who, &error);
        awtclient_close(client);
        fake_stop(&server);
    }
}

/* A caller's loop until the link has failed, or has answered LIST, which it asks as soon as it may. */
static void ask_until_over(awtlink *link, awtclient_error *error)
{
    static proto_message message;
    proto_message list = {.type = PROTO_LIST};
    awtcodec_match match = AWTCODEC_OTHER;
    while (match == AWTCODEC_OTHER) {
        if (!awtlink_next(link, &message, error)) {
            const int64_t due_us = awtlink_deadline_us(link), last_us = awtclient_now_us() + 1000 * LIAR_LONG_MS;
            socket_wait(awtlink_descriptor(link), awtlink_wanted(link),
                        awtlink_pending(link) ? 0
                        : due_us < last_us    ? due_us
                                              : last_us);
            if (error->code != 0 || !awtlink_pump(link, awtclient_now_us(), error) ||
                (awtlink_ready(link) && list.request == 0 && !awtlink_queue(link, &list, error))) {
                return;
            }
            continue;
        }
        match = awtcodec_matches(&list, &message, error);
    }
    CHECK(match != AWTCODEC_ANSWER);
    error->code = error->code == PROTO_ERROR_TIMED_OUT ? AWTCLIENT_TIMEOUT : error->code; /* as a link says it */
}

TEST(link_is_not_hurt_by_whoever_listens_there)
{
    for (const liar *who = LIARS; who < LIARS + LIAR_COUNT; who++) {
        fake server;
        awtclient_error error = {.code = 0};
        CHECK(fake_start(&server, who->script));
        const awtclient_options options = liar_options(who, &server);
        awtlink *link = awtlink_open(&options, awtclient_now_us(), &error);
        CHECK(link != NULL);
        if (link) {
            ask_until_over(link, &error);
        }
        check_told(who, &error);
        awtlink_close(link);
        fake_stop(&server);
    }
}

/* ---- frames that are none --------------------------------------------------------------------------------------- */

/* Makes hair, and answers each question with a frame of another kind of garbage, until the hair is ended. */
static void script_garbage_frames(fake *self)
{
    static unsigned char garbage[2000] = "glTF\2\0\0\0\xd0\7\0\0\x10\0\0\0JSON{\"asset\":{}}";
    proto_message reply = {.type = PROTO_CREATE_REPLY}, frame = {.type = PROTO_FRAME};
    if (!fake_welcome(self, false) || !fake_read(self)) {
        return;
    }
    reply.request = self->got.request;
    reply.as.create_reply.forest = 7;
    script_send(self, &reply);
    for (uint64_t n = 1; fake_read(self) && self->got.type != PROTO_DESTROY;) {
        if (self->got.type == PROTO_QUERY) {
            frame.request = self->got.request;
            frame.as.frame = (struct proto_frame){.forest = 7, .kind = (uint8_t)(n % 5), .sequence = n};
            frame.as.frame.base = n > 5 ? n - 1 : 0;
            frame.as.frame.glb = (proto_blob){garbage, n % 3 == 0 ? 0 : sizeof garbage};
            script_send(self, &frame);
            n++;
        }
    }
    reply = (proto_message){.type = PROTO_DESTROY_REPLY, .request = self->got.request};
    script_send(self, &reply);
    fake_read(self);
}

TEST(client_is_told_of_frames_that_are_garbage_and_goes_on)
{
    fake server;
    awtclient_error error = {.code = 0};
    const proto_pose head = {.orientation = {0, 0, 0, 1}};
    awtframes_shown shown;
    CHECK(fake_start(&server, script_garbage_frames));
    awtclient *client = fake_open(&server, NULL, LIAR_LONG_MS, &error);
    awthair *hair = client ? awthair_create(client, "long", 10, &error) : NULL;
    CHECK(hair != NULL);
    for (int n = 1; hair && n <= 12; n++) {
        error = (awtclient_error){.code = 0};
        CHECK(!awthair_drive(hair, n * 10000, &head, NULL, &shown, &error));
        CHECK_INT(error.code, AWTCLIENT_PEER);
        CHECK(error.text[0] != '\0');
    }
    awthair_close(hair);
    awtclient_close(client);
    fake_stop(&server);
}

static void script_stops_reading(fake *self)
{
    char byte;
    if (fake_welcome(self, false)) {
        poll(NULL, 0, 3 * LIAR_SHORT_MS);
        while (recv(self->peer, &byte, 1, 0) == 1) {
        }
    }
}

static void script_says_bye(fake *self)
{
    if (fake_welcome(self, false) && fake_read(self)) {
        proto_message bye = {.type = PROTO_BYE};
        bye.as.bye.reason = proto_str_of("going home");
        script_send(self, &bye);
    }
}

TEST(client_passes_on_why_the_daemon_says_bye)
{
    static proto_message answer;
    fake server;
    awtclient_error error = {.code = 0};
    CHECK(fake_start(&server, script_says_bye));
    awtclient *client = fake_open(&server, NULL, LIAR_LONG_MS, &error);
    proto_message list = {.type = PROTO_LIST}, again = {.type = PROTO_LIST};
    CHECK(client && !awtclient_call(client, &list, &answer, &error));
    CHECK_INT(error.code, AWTCLIENT_CLOSED);
    CHECK_TEXT(error.text, "the daemon closed the connection: going home");
    CHECK(client && !awtclient_call(client, &again, &answer, &error));
    CHECK_INT(error.code, AWTCLIENT_CLOSED);
    awtclient_close(client);
    fake_stop(&server);
}

/* A message that was cut off by the timeout cannot be followed by another. */
TEST(client_gives_up_a_daemon_that_stops_reading)
{
    static const unsigned char piece[1 << 20];
    fake server;
    int small = 8192;
    awtclient_error error = {.code = 0};
    CHECK(fake_start(&server, script_stops_reading));
    awtclient *client = fake_open(&server, NULL, LIAR_SHORT_MS, &error);
    CHECK(client != NULL);
    if (client) {
        setsockopt(awtclient_descriptor(client), SOL_SOCKET, SO_SNDBUF, &small, sizeof small);
        bool late = false;
        for (int turn = 0; turn < 100 && !late; turn++) {
            proto_message upload = {.type = PROTO_UPLOAD};
            upload.as.upload.piece = (proto_blob){piece, sizeof piece};
            late = !awtclient_send(client, &upload, &error);
        }
        CHECK_INT(error.code, AWTCLIENT_TIMEOUT);
        proto_message list = {.type = PROTO_LIST};
        CHECK(!awtclient_send(client, &list, &error));
        CHECK_INT(error.code, AWTCLIENT_CLOSED);
    }
    awtclient_close(client);
    fake_stop(&server);
}

static void script_leaves(fake *self)
{
    fake_read(self);
}

TEST(client_says_when_nobody_is_there)
{
    static const char *const wrong[] = {"127.0.0.1", "127.0.0.1:", "", NULL};
    fake server;
    awtclient_error error = {.code = 0};
    CHECK(fake_start(&server, script_leaves));
    awtclient_close(fake_open(&server, NULL, LIAR_LONG_MS, &error));
    fake_stop(&server); /* the port is free now */
    CHECK(!fake_open(&server, NULL, LIAR_LONG_MS, &error));
    CHECK_INT(error.code, AWTCLIENT_ADDRESS);
    CHECK(strstr(error.text, strerror(ECONNREFUSED)) != NULL);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        awtclient_options options = {.address = wrong[i]};
        CHECK(!awtclient_open(&options, &error));
        CHECK_INT(error.code, AWTCLIENT_ADDRESS);
    }
}
