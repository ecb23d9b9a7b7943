/* test_link.c: links, which never block: many at once in one loop, and over transports that give and take as little as
 * they like. No test waits but in poll, and none has a thread but the scripted daemon's. */
#include "check.h"
#include "codec.h"
#include "fake_daemon.h"
#include "socket.h"

#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

enum { LONG_MS = FAKE_PATIENCE_MS };

/* One turn of a caller's loop. */
static bool turn(awtlink *link, awtclient_error *error)
{
    const int64_t due_us = awtlink_deadline_us(link), last_us = awtclient_now_us() + INT64_C(1000) * LONG_MS;
    socket_wait(awtlink_descriptor(link), awtlink_wanted(link),
                awtlink_pending(link) ? 0
                : due_us < last_us    ? due_us
                                      : last_us);
    return awtlink_pump(link, awtclient_now_us(), error);
}

static bool wait_ready(awtlink *link, awtclient_error *error)
{
    while (!awtlink_ready(link)) {
        if (!turn(link, error)) {
            return false;
        }
    }
    return true;
}

static bool wait_message(awtlink *link, proto_message *message, awtclient_error *error)
{
    while (!awtlink_next(link, message, error)) {
        if (error->code != 0 || !turn(link, error)) {
            return false;
        }
    }
    return true;
}

static awtlink *open_link(const fake *server, int timeout_ms, awtclient_error *error)
{
    awtclient_options options = {.address = server->address,
                                 .token = "a1b2c300000000000000000000000000",
                                 .timeout_ms = timeout_ms,
                                 .queue_bytes = 100000};
    return awtlink_open(&options, awtclient_now_us(), error);
}

/* Takes three requests before it answers, the last first, and asks for a sign of life between. */
static void script_answers_backwards(fake *self)
{
    uint64_t requests[3];
    if (!fake_welcome(self, true) || !fake_admit(self, script_token)) {
        return;
    }
    for (int i = 0; i < 3 && fake_read(self); i++) {
        requests[i] = self->got.request;
    }
    for (int i = 2; i >= 0; i--) {
        proto_message ping = {.type = PROTO_PING, .request = 5}, reply = {.type = PROTO_LIST_REPLY};
        reply.request = requests[i];
        script_send(self, &ping);
        script_send(self, &reply);
    }
    while (fake_read(self) && self->got.type != PROTO_BYE) {
        self->pings_answered += self->got.type == PROTO_PONG && self->got.request == 5;
    }
    self->said_bye = self->got.type == PROTO_BYE;
}

TEST(link_pipelines_requests_and_tells_their_answers_apart)
{
    static proto_message message;
    fake server;
    awtclient_error error = {.code = 0};
    CHECK(fake_start(&server, script_answers_backwards));
    awtlink *link = open_link(&server, LONG_MS, &error);
    CHECK(link && wait_ready(link, &error));
    CHECK_TEXT(error.text, "");
    if (link && awtlink_ready(link)) {
        uint64_t requests[3];
        for (int i = 0; i < 3; i++) {
            proto_message list = {.type = PROTO_LIST};
            CHECK(awtlink_queue(link, &list, &error));
            requests[i] = list.request;
        }
        for (int i = 2; i >= 0; i--) {
            CHECK(wait_message(link, &message, &error));
            CHECK_INT(message.type, PROTO_LIST_REPLY);
            CHECK_U64(message.request, requests[i]);
        }
        CHECK(!awtlink_next(link, &message, &error));
        CHECK_INT(error.code, 0);
        while (awtlink_queued(link) > 0 && turn(link, &error)) {
        }
    }
    awtlink_close(link);
    fake_stop(&server);
    CHECK_INT(server.pings_answered, 3);
    CHECK(server.said_bye);
}

/* Reads nothing after the greeting, and goes when something comes. */
static void script_stops_reading(fake *self)
{
    if (fake_welcome(self, false)) {
        poll(&(struct pollfd){.fd = self->peer, .events = POLLIN}, 1, LONG_MS);
    }
}

TEST(link_refuses_what_its_queue_does_not_hold_and_stays)
{
    static const unsigned char piece[30000];
    fake server;
    awtclient_error error = {.code = 0};
    proto_message list = {.type = PROTO_LIST}, upload = {.type = PROTO_UPLOAD};
    upload.as.upload.piece = (proto_blob){piece, sizeof piece};
    CHECK(fake_start(&server, script_stops_reading));
    awtlink *link = open_link(&server, LONG_MS, &error);
    CHECK(link && !awtlink_queue(link, &list, &error)); /* not before it is ready */
    CHECK_INT(error.code, AWTCLIENT_FULL);
    CHECK(error.retry);
    CHECK(link && wait_ready(link, &error));
    int taken = 0;
    for (; link && taken < 100 && awtlink_queue(link, &upload, &error); taken++) {
    }
    CHECK_INT(taken, 3);
    CHECK_INT(error.code, AWTCLIENT_FULL);
    CHECK(link && awtlink_queued(link) <= 100000);
    CHECK(link && awtlink_queue(link, &list, &error)); /* what still fits, fits */
    awtlink_close(link);
    fake_stop(&server);
}

/* ---- a transport in memory: each call gives or takes one byte, every other none ----------------------------- */

typedef struct drip {
    unsigned char in[4096], out[4096];
    size_t in_size, in_used, out_size;
    unsigned calls;
    bool ended, closed;
} drip;

static long drip_send(void *context, const void *bytes, size_t size, awtclient_error *error)
{
    drip *self = context;
    (void)size, (void)error;
    if (self->calls++ % 2 == 0) {
        return AWTLINK_WANT_WRITE;
    }
    memcpy(self->out + self->out_size++ % sizeof self->out, bytes, 1);
    return 1;
}

static long drip_receive(void *context, void *bytes, size_t size, awtclient_error *error)
{
    drip *self = context;
    (void)size;
    if (self->in_used == self->in_size) {
        return self->ended ? awtcodec_fail(error, -77, "the cellar is flooded"), AWTLINK_FAILED : AWTLINK_WANT_READ;
    }
    if (self->calls++ % 2 == 0) {
        return AWTLINK_WANT_READ;
    }
    memcpy(bytes, self->in + self->in_used++, 1);
    return 1;
}

static void drip_close(void *context)
{
    ((drip *)context)->closed = true;
}

static void drip_put(drip *self, const proto_message *message)
{
    self->in_size += proto_encode(message, self->in + self->in_size, sizeof self->in - self->in_size);
}

TEST(link_goes_through_any_transport_that_the_caller_brings)
{
    static proto_message message;
    drip pipe = {.ended = false};
    awtlink_transport transport = {&pipe, drip_send, drip_receive, NULL, drip_close};
    awtclient_options options = {.transport = &transport, .timeout_ms = 1000};
    awtclient_error error = {.code = 0};
    proto_message welcome = {.type = PROTO_WELCOME}, list = {.type = PROTO_LIST}, reply = {.type = PROTO_LIST_REPLY};
    welcome.as.welcome.version = PROTO_VERSION;
    welcome.as.welcome.greatest_payload = PROTO_MAX_REQUEST;
    drip_put(&pipe, &welcome);
    awtlink *link = awtlink_open(&options, 0, &error);
    CHECK(link != NULL);
    CHECK_INT(awtlink_descriptor(link), -1);
    for (int turns = 0; turns < 5000 && !awtlink_ready(link); turns++) {
        CHECK(awtlink_pump(link, turns, &error));
    }
    CHECK(awtlink_ready(link));
    CHECK(awtlink_queue(link, &list, &error));
    reply.request = list.request;
    drip_put(&pipe, &reply);
    pipe.ended = true;
    bool came = false;
    for (int turns = 0; turns < 5000 && !came && awtlink_pump(link, 7000 + turns, &error); turns++) {
        came = awtlink_next(link, &message, &error);
    }
    CHECK(came && message.request == list.request);
    CHECK(awtlink_received_us(link) >= 7000);
    while (awtlink_pump(link, 20000, &error)) {
    }
    CHECK_INT(error.code, -77);
    CHECK_TEXT(error.text, "the cellar is flooded");
    error.code = 0;
    CHECK(!awtlink_next(link, &message, &error));
    CHECK_INT(error.code, -77);
    awtlink_close(link);
    CHECK(pipe.closed);
}

TEST(link_gives_up_the_handshake_at_its_deadline_by_the_callers_clock)
{
    drip pipe = {.ended = false};
    awtlink_transport transport = {&pipe, drip_send, drip_receive, NULL, NULL};
    awtclient_options options = {.transport = &transport, .timeout_ms = 1000};
    awtclient_error error = {.code = 0};
    awtlink *link = awtlink_open(&options, 5000000, &error);
    CHECK(link != NULL);
    CHECK_INT(awtlink_deadline_us(link), 6000000);
    CHECK(awtlink_pump(link, 5999999, &error));
    CHECK(!awtlink_pump(link, 6000000, &error));
    CHECK_INT(error.code, AWTCLIENT_TIMEOUT);
    awtlink_close(link);
}
