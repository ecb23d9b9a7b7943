/* liars_fixture.c: see liars_fixture.h. */
#include "liars_fixture.h"

#include <poll.h>
#include <string.h>
#include <sys/socket.h>

/* ---- in the handshake ------------------------------------------------------------------------------------------ */

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

static void script_another_version(fake *self)
{
    proto_message welcome = {.type = PROTO_WELCOME};
    welcome.as.welcome.version = PROTO_VERSION + 1;
    if (fake_read(self)) {
        script_send(self, &welcome);
    }
}

/* ---- afterwards ------------------------------------------------------------------------------------------------ */

static void script_wrong_length(fake *self)
{
    static const unsigned char frame[] = "\x03\0\0\0\x34\0\0\0\0\0\0\0\0\0\0\0\x01\x01"; /* a FRAME of 3 bytes */
    if (fake_welcome(self, false)) {
        fake_write(self, frame, sizeof frame);
    }
}

static void script_endless_length(fake *self)
{
    static const unsigned char frame[] = "\xFF\xFF\xFF\xFF\x34\0\0\0\0\0\0\0\0\0\0\0\x01\x01";
    if (fake_welcome(self, false)) {
        fake_write(self, frame, sizeof frame);
    }
}

static void script_ends_inside(fake *self)
{
    static const unsigned char frame[] = "\x80\0\0\0\x34\0\0\0\0\0\0\0\0\0\0\0\x01\x01";
    if (fake_welcome(self, false)) {
        fake_write(self, frame, sizeof frame);
    }
}

static void script_guesses(fake *self)
{
    static const uint8_t guess[AUTH_TOKEN_SIZE] = {0};
    if (fake_welcome(self, true)) {
        fake_admit(self, guess);
    }
}

static void script_falls_silent(fake *self)
{
    fake_welcome(self, false);
    script_silent(self);
}

static void script_unknown_and_required(fake *self)
{
    static const unsigned char header[] = "\0\0\0\0\x77\x77\x01\0\0\0\0\0\0\0\0";
    if (fake_welcome(self, false)) {
        fake_write(self, header, PROTO_HEADER_SIZE);
    }
    script_silent(self);
}

static void script_is_a_client(fake *self)
{
    proto_message list = {.type = PROTO_LIST};
    if (fake_welcome(self, false)) {
        script_send(self, &list);
    }
    script_silent(self);
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

static void script_answers_otherwise(fake *self)
{
    if (fake_welcome(self, false) && fake_read(self)) {
        proto_message pong = {.type = PROTO_PONG, .request = self->got.request};
        script_send(self, &pong);
        fake_read(self);
    }
}

const liar LIARS[] = {
    {"a web server", script_web_server, LIAR_LONG_MS, AWTCLIENT_PEER},
    {"an echo", script_echo, LIAR_LONG_MS, AWTCLIENT_PEER},
    {"4 GB are announced", script_huge, LIAR_LONG_MS, AWTCLIENT_PEER},
    {"a greeting that does not decode", script_spoils_welcome, LIAR_LONG_MS, AWTCLIENT_PEER},
    {"closed after the first message", script_closes, LIAR_LONG_MS, AWTCLIENT_CLOSED},
    {"closed within the greeting", script_cuts_welcome, LIAR_LONG_MS, AWTCLIENT_CLOSED},
    {"no version in common", script_no_version, LIAR_LONG_MS, PROTO_ERROR_BAD_VERSION},
    {"a version that was not offered", script_another_version, LIAR_LONG_MS, AWTCLIENT_PEER},
    {"a proof under another token", script_guesses, LIAR_LONG_MS, AWTCLIENT_TOKEN},
    {"silent", script_silent, LIAR_SHORT_MS, AWTCLIENT_TIMEOUT},
    {"a byte now and then", script_drips, LIAR_SHORT_MS, AWTCLIENT_TIMEOUT},
    {"a length that does not fit", script_wrong_length, LIAR_LONG_MS, AWTCLIENT_PEER},
    {"4 GB are announced after the handshake", script_endless_length, LIAR_LONG_MS, AWTCLIENT_PEER},
    {"closed within a frame", script_ends_inside, LIAR_LONG_MS, AWTCLIENT_CLOSED},
    {"silent after the handshake", script_falls_silent, LIAR_SHORT_MS, AWTCLIENT_TIMEOUT},
    {"a message that nobody knows and all must", script_unknown_and_required, LIAR_LONG_MS, AWTCLIENT_PEER},
    {"a message that only clients send", script_is_a_client, LIAR_LONG_MS, AWTCLIENT_PEER},
    {"an answer to something else", script_answers_otherwise, LIAR_LONG_MS, AWTCLIENT_PEER},
    {"pings without end", script_never_stops, LIAR_SHORT_MS, AWTCLIENT_TIMEOUT},
    {"answers to others without end", script_never_stops_talking_to_others, LIAR_SHORT_MS, AWTCLIENT_TIMEOUT},
};
const size_t LIAR_COUNT = sizeof LIARS / sizeof LIARS[0];

awtclient_options liar_options(const liar *who, const fake *server)
{
    return (awtclient_options){.address = server->address,
                               .token = "a1b2c300000000000000000000000000",
                               .name = "test",
                               .timeout_ms = who->timeout_ms};
}
