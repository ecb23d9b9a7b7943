/* test_proto_liars.c: the client library against whoever else may listen at that port: programs that lie, stop, or
 * never stop. It fails in bounded time, and says what it met. */
#include "check.h"
#include "fake_daemon.h"

#include <poll.h>
#include <string.h>
#include <sys/socket.h>

enum { SHORT_MS = 150, LONG_MS = FAKE_PATIENCE_MS };

static void script_no_version(fake *self)
{
    if (fake_read(self)) {
        fake_error(self, self->got.request, PROTO_HELLO, PROTO_ERROR_BAD_VERSION, "");
    }
}

static void script_web_server(fake *self)
{
    static const char answer[] = "HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\n\r\n";
    fake_read(self);
    fake_write(self, answer, sizeof answer - 1);
    fake_read(self);
}

static void script_echo(fake *self)
{
    char bytes[256];
    ssize_t got = recv(self->peer, bytes, sizeof bytes, 0);
    if (got > 0) {
        fake_write(self, bytes, (size_t)got);
    }
    fake_read(self);
}

static void script_huge(fake *self)
{
    static const unsigned char header[] = "\xFF\xFF\xFF\xFF\x02\0\0\0\0\0\0\0\0\0\0";
    fake_read(self);
    fake_write(self, header, PROTO_HEADER_SIZE);
    fake_read(self);
}

static void script_closes(fake *self)
{
    fake_read(self);
}

static void script_cuts_welcome(fake *self)
{
    static const unsigned char part[] = "\x30\0\0\0\x02\0\0\0\0\0\0\0\0\0\0\0\x01\x01";
    fake_read(self);
    fake_write(self, part, sizeof part - 1);
}

static void script_spoils_welcome(fake *self)
{
    static const unsigned char whole[] = "\x02\0\0\0\x02\0\0\0\0\0\0\0\0\0\0\0\x01\x01";
    fake_read(self);
    fake_write(self, whole, sizeof whole - 1);
    fake_read(self);
}

static void script_silent(fake *self)
{
    while (fake_read(self)) {
    }
}

static void script_drips(fake *self)
{
    static const unsigned char header[PROTO_HEADER_SIZE] = {0x40, 0, 0, 0, 0x02};
    for (size_t i = 0; fake_write(self, i < sizeof header ? header + i : header + 5, 1); i++) {
        poll(NULL, 0, 10);
    }
}

static void script_never_stops(fake *self)
{
    proto_message ping = {.type = PROTO_PING};
    if (fake_welcome(self, false)) {
        while (script_send(self, &ping)) {
        }
    }
}

/* In large pieces, so that there is always more to read than the client has read. */
static void script_never_stops_talking_to_others(fake *self)
{
    proto_message list = {.type = PROTO_LIST_REPLY, .request = 99999};
    static unsigned char block[1 << 20];
    size_t size = proto_encode(&list, block, sizeof block), used = size;
    while (used + size <= sizeof block) {
        memcpy(block + used, block, size);
        used += size;
    }
    if (fake_welcome(self, false)) {
        while (fake_write(self, block, used)) {
        }
    }
}

static void script_stops_reading(fake *self)
{
    char byte;
    if (fake_welcome(self, false)) {
        poll(NULL, 0, 3 * SHORT_MS);
        while (recv(self->peer, &byte, 1, 0) == 1) {
        }
    }
}

static void script_answers_otherwise(fake *self)
{
    if (fake_welcome(self, false) && fake_read(self)) {
        proto_message pong = {.type = PROTO_PONG, .request = self->got.request};
        script_send(self, &pong);
        fake_read(self);
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

TEST(client_is_not_hurt_by_whoever_listens_there)
{
    static const struct {
        void (*script)(fake *self);
        int timeout_ms, code;
    } cases[] = {
        {script_web_server, LONG_MS, AWTCLIENT_PEER},
        {script_echo, LONG_MS, AWTCLIENT_PEER},
        {script_huge, LONG_MS, AWTCLIENT_PEER},
        {script_spoils_welcome, LONG_MS, AWTCLIENT_PEER},
        {script_closes, LONG_MS, AWTCLIENT_CLOSED},
        {script_cuts_welcome, LONG_MS, AWTCLIENT_CLOSED},
        {script_no_version, LONG_MS, PROTO_ERROR_BAD_VERSION},
        {script_silent, SHORT_MS, AWTCLIENT_TIMEOUT},
        {script_drips, SHORT_MS, AWTCLIENT_TIMEOUT},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        fake server;
        awtclient_error error = {.code = 0};
        CHECK(fake_start(&server, cases[i].script));
        CHECK(!fake_open(&server, NULL, cases[i].timeout_ms, &error));
        CHECK_INT(error.code, cases[i].code);
        CHECK(error.text[0] != '\0');
        fake_stop(&server);
    }
}

TEST(client_call_is_not_hurt_by_a_daemon_that_lies)
{
    static const struct {
        void (*script)(fake *self);
        int timeout_ms, code;
    } cases[] = {
        {script_answers_otherwise, LONG_MS, AWTCLIENT_PEER},
        {script_never_stops, SHORT_MS, AWTCLIENT_TIMEOUT},
        {script_never_stops_talking_to_others, SHORT_MS, AWTCLIENT_TIMEOUT},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        static proto_message answer;
        fake server;
        awtclient_error error = {.code = 0};
        CHECK(fake_start(&server, cases[i].script));
        awtclient *client = fake_open(&server, NULL, cases[i].timeout_ms, &error);
        proto_message list = {.type = PROTO_LIST};
        CHECK(client && !awtclient_call(client, &list, &answer, &error));
        CHECK_INT(error.code, cases[i].code);
        awtclient_close(client);
        fake_stop(&server);
    }
}

TEST(client_passes_on_why_the_daemon_says_bye)
{
    static proto_message answer;
    fake server;
    awtclient_error error = {.code = 0};
    CHECK(fake_start(&server, script_says_bye));
    awtclient *client = fake_open(&server, NULL, LONG_MS, &error);
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
    awtclient *client = fake_open(&server, NULL, SHORT_MS, &error);
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

TEST(client_says_when_nobody_is_there)
{
    static const char *const wrong[] = {"127.0.0.1", "127.0.0.1:", "", NULL};
    fake server;
    awtclient_error error = {.code = 0};
    CHECK(fake_start(&server, script_closes));
    awtclient_close(fake_open(&server, NULL, LONG_MS, &error));
    fake_stop(&server); /* the port is free now */
    CHECK(!fake_open(&server, NULL, LONG_MS, &error));
    CHECK_INT(error.code, AWTCLIENT_ADDRESS);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        awtclient_options options = {.address = wrong[i]};
        CHECK(!awtclient_open(&options, &error));
        CHECK_INT(error.code, AWTCLIENT_ADDRESS);
    }
}
