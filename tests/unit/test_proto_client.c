/* test_proto_client.c: the client library against scripted daemons on the loopback that do it right, and at
 * the door, against some that do not. */
#include "check.h"
#include "fake_daemon.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { LONG_MS = FAKE_PATIENCE_MS, GLB_SIZE = 300000, UPLOAD_SIZE = 2500000 };

static unsigned char file_bytes[UPLOAD_SIZE];

static void fake_frame(fake *self, uint64_t request)
{
    proto_message frame = {.type = PROTO_FRAME, .request = request};
    frame.as.frame.sequence = request;
    frame.as.frame.glb = (proto_blob){file_bytes, GLB_SIZE};
    script_send(self, &frame);
}

/* LIST: a PING, a frame of some subscription and an answer to nobody come before the answer. */
static void fake_list(fake *self, uint64_t request)
{
    proto_message ping = {.type = PROTO_PING, .request = 77};
    ping.as.ping.sent_us = 123456;
    script_send(self, &ping);
    fake_frame(self, 99999);
    proto_message reply = {.type = PROTO_LIST_REPLY, .request = request + 1000};
    script_send(self, &reply);
    reply.request = request;
    reply.as.list_reply.total = 1;
    reply.as.list_reply.forests.count = 1;
    reply.as.list_reply.forests.items[0] = (struct proto_forest_info){.forest = 42, .name = proto_str_of("long")};
    script_send(self, &reply);
}

static void fake_upload(fake *self, uint64_t request)
{
    const struct proto_upload *upload = &self->got.as.upload;
    if (upload->offset == 0) {
        auth_sha256_init(&self->uploaded);
    }
    auth_sha256_add(&self->uploaded, upload->piece.bytes, upload->piece.length);
    self->pieces++;
    proto_message reply = {.type = PROTO_UPLOAD_REPLY, .request = request};
    reply.as.upload_reply.upload = upload->upload;
    reply.as.upload_reply.received = upload->offset + upload->piece.length;
    script_send(self, &reply);
}

/* CREATE: PROGRESS twice, if it is wanted, and once of another CREATE. */
static void fake_create(fake *self, uint64_t request)
{
    proto_message progress = {.type = PROTO_PROGRESS, .request = request + 1000};
    progress.as.progress.stage = 3;
    script_send(self, &progress);
    progress.request = request;
    for (int n = 1; n <= 2 && self->got.as.create.progress; n++) {
        progress.as.progress.stage = (uint8_t)n;
        progress.as.progress.share = 0.25f * (float)n;
        script_send(self, &progress);
    }
    proto_message reply = {.type = PROTO_CREATE_REPLY, .request = request};
    reply.as.create_reply.forest = 42;
    script_send(self, &reply);
}

static void fake_serve(fake *self)
{
    while (fake_read(self)) {
        uint64_t request = self->got.request;
        switch (self->got.type) {
        case PROTO_LIST:
            fake_list(self, request);
            break;
        case PROTO_PONG:
            self->pings_answered += request == 77 && self->got.as.pong.sent_us == 123456;
            break;
        case PROTO_QUERY:
            fake_frame(self, request);
            break;
        case PROTO_UPLOAD:
            fake_upload(self, request);
            break;
        case PROTO_CREATE:
            fake_create(self, request);
            break;
        case PROTO_MOTION:
            self->motions++;
            fake_error(self, request, PROTO_MOTION, PROTO_ERROR_BAD_TIME, "");
            break;
        case PROTO_STATS:
            fake_error(self, request, PROTO_STATS, PROTO_ERROR_BUSY, "far too much to do");
            break;
        case PROTO_BYE:
            self->said_bye = true;
            return;
        default:
            return;
        }
    }
}

/* ---- the scripts -------------------------------------------------------------------------------------------- */

static void script_right(fake *self)
{
    if (fake_welcome(self, true) && fake_admit(self, script_token)) {
        fake_serve(self);
    }
}

static void script_open_door(fake *self)
{
    if (fake_welcome(self, false)) {
        fake_serve(self);
    }
}

static void script_impostor(fake *self)
{
    static const uint8_t guess[AUTH_TOKEN_SIZE] = {0};
    if (fake_welcome(self, true)) {
        fake_admit(self, guess);
        fake_read(self);
    }
}

static void script_wrong_token(fake *self)
{
    if (fake_welcome(self, true) && fake_read(self)) {
        fake_error(self, self->got.request, PROTO_AUTH, PROTO_ERROR_WRONG_TOKEN, "");
    }
}

/* ---- the tests ------------------------------------------------------------------------------------------ */

/* A token file with `text` in it. The caller removes it. */
static bool token_file(char path[64], const char *text)
{
    snprintf(path, 64, "/tmp/awtd-test-XXXXXX");
    int descriptor = mkstemp(path);
    size_t length = strlen(text);
    bool written = descriptor >= 0 && write(descriptor, text, length) == (ssize_t)length;
    if (descriptor >= 0) {
        close(descriptor);
    }
    return written;
}

static bool right_token_file(char path[64])
{
    char text[AUTH_TOKEN_TEXT];
    auth_token_format(script_token, text);
    return token_file(path, text);
}

TEST(client_shakes_hands_calls_and_says_bye)
{
    static proto_message answer;
    fake server;
    char path[64];
    awtclient_error error = {.code = 0};
    CHECK(right_token_file(path) && fake_start(&server, script_right));
    awtclient *client = fake_open(&server, path, LONG_MS, &error);
    CHECK_TEXT(error.text, "");
    if (client) {
        proto_message list = {.type = PROTO_LIST}, query = {.type = PROTO_QUERY};
        CHECK(awtclient_call(client, &list, &answer, &error));
        CHECK_INT(answer.as.list_reply.forests.count, 1);
        CHECK_U64(answer.as.list_reply.forests.items[0].forest, 42);
        CHECK(awtclient_call(client, &query, &answer, &error));
        CHECK(query.request > list.request);
        CHECK_U64(answer.as.frame.sequence, query.request);
        CHECK_INT(answer.as.frame.glb.length, GLB_SIZE);
        CHECK_BYTES(answer.as.frame.glb.bytes, file_bytes, GLB_SIZE);
    }
    awtclient_close(client);
    fake_stop(&server);
    unlink(path);
    CHECK(server.proof_good);
    CHECK_INT(server.pings_answered, 1);
    CHECK(server.said_bye);
}

TEST(client_receives_what_comes_unasked)
{
    static proto_message message;
    fake server;
    awtclient_error error = {.code = 0};
    CHECK(fake_start(&server, script_open_door));
    awtclient *client = fake_open(&server, NULL, LONG_MS, &error);
    if (client) {
        proto_message list = {.type = PROTO_LIST};
        CHECK(awtclient_send(client, &list, &error));
        CHECK(awtclient_receive(client, &message, &error));
        CHECK_INT(message.type, PROTO_FRAME);
        CHECK_U64(message.request, 99999);
        CHECK(awtclient_descriptor(client) >= 0);
    }
    CHECK(client != NULL);
    awtclient_close(client);
    fake_stop(&server);
}

TEST(client_tells_what_the_daemon_refused)
{
    static proto_message answer;
    fake server;
    awtclient_error error = {.code = 0};
    CHECK(fake_start(&server, script_open_door));
    awtclient *client = fake_open(&server, NULL, LONG_MS, &error);
    if (client) {
        proto_message stats = {.type = PROTO_STATS}, list = {.type = PROTO_LIST}, motion = {.type = PROTO_MOTION};
        CHECK(!awtclient_call(client, &stats, &answer, &error));
        CHECK_INT(error.code, PROTO_ERROR_BUSY);
        CHECK(error.retry);
        CHECK_INT(error.retry_after_ms, 250);
        CHECK_TEXT(error.text, "far too much to do");
        motion.as.motion.head.orientation[3] = motion.as.motion.body.orientation[3] = 1;
        CHECK(awtclient_send(client, &motion, &error));
        CHECK_U64(motion.request, 0);
        CHECK(!awtclient_call(client, &list, &answer, &error));
        CHECK_INT(error.code, PROTO_ERROR_BAD_TIME);
        CHECK_TEXT(error.text, "MOTION: simulated time does not run backwards");
        list.request = 0;
        CHECK(awtclient_call(client, &list, &answer, &error)); /* the connection has not suffered */
    }
    CHECK(client != NULL);
    awtclient_close(client);
    fake_stop(&server);
    CHECK_INT(server.motions, 1);
}

static double last_share;

static void note_share(void *context, double share)
{
    *(int *)context += share > last_share;
    last_share = share;
}

TEST(client_uploads_a_file_in_pieces)
{
    fake server;
    awtclient_error error = {.code = 0};
    uint8_t there[AUTH_HASH_SIZE], here[AUTH_HASH_SIZE];
    for (size_t i = 0; i < sizeof file_bytes; i++) {
        file_bytes[i] = (unsigned char)(i * 37 >> 4);
    }
    CHECK(fake_start(&server, script_open_door));
    awtclient *client = fake_open(&server, NULL, LONG_MS, &error);
    int rises = 0, small = 8192; /* so that pieces go out in many parts */
    CHECK(client && setsockopt(awtclient_descriptor(client), SOL_SOCKET, SO_SNDBUF, &small, sizeof small) == 0);
    last_share = 0;
    CHECK(client && awtclient_upload(client, 3, file_bytes, sizeof file_bytes, note_share, &rises, &error));
    CHECK(client && !awtclient_upload(client, 4, file_bytes, 0, NULL, NULL, &error));
    awtclient_close(client);
    fake_stop(&server);
    CHECK_INT(server.pieces, 3);
    CHECK_INT(rises, 3);
    CHECK_NEAR(last_share, 1, 0);
    auth_sha256_done(&server.uploaded, there);
    auth_sha256 hash;
    auth_sha256_init(&hash);
    auth_sha256_add(&hash, file_bytes, sizeof file_bytes);
    auth_sha256_done(&hash, here);
    CHECK_BYTES(there, here, sizeof here);
}

static void note_progress(void *context, const struct proto_progress *progress)
{
    double *sum = context;
    *sum += 10 * progress->stage + (double)progress->share;
}

TEST(client_hears_how_far_a_create_has_come_if_it_wants_to)
{
    fake server;
    awtclient_error error = {.code = 0};
    CHECK(fake_start(&server, script_open_door));
    awtclient *client = fake_open(&server, NULL, LONG_MS, &error);
    proto_message request = {.type = PROTO_CREATE}, answer;
    request.as.create.head.orientation[3] = request.as.create.body.orientation[3] = 1;
    double heard = 0;
    CHECK(client && awtclient_create(client, &request, &answer, note_progress, &heard, &error));
    CHECK_NEAR(heard, 10.25 + 20.5, 0);
    CHECK_U64(client ? answer.as.create_reply.forest : 0, 42);
    request.request = 0; /* still wants it, but asks in the plain way: what nobody listens to is passed over */
    CHECK(client && awtclient_call(client, &request, &answer, &error));
    CHECK_U64(client ? answer.as.create_reply.forest : 0, 42);
    CHECK_NEAR(heard, 10.25 + 20.5, 0);
    awtclient_close(client);
    fake_stop(&server);
}

TEST(client_door_fails_with_words_that_help)
{
    fake server;
    awtclient_error error = {.code = 0};
    char path[64], expected[200];
    CHECK(fake_start(&server, script_right));
    CHECK(!fake_open(&server, "/nowhere/token", LONG_MS, &error));
    CHECK_INT(error.code, AWTCLIENT_TOKEN);
    CHECK_TEXT(error.text, "awtd wants a token; looked in /nowhere/token: give --token-file");
    fake_stop(&server);

    CHECK(token_file(path, "no token") && fake_start(&server, script_right));
    CHECK(!fake_open(&server, path, LONG_MS, &error));
    CHECK_INT(error.code, AWTCLIENT_TOKEN);
    fake_stop(&server);
    unlink(path);

    CHECK(right_token_file(path) && fake_start(&server, script_impostor));
    CHECK(!fake_open(&server, path, LONG_MS, &error));
    CHECK_INT(error.code, AWTCLIENT_TOKEN);
    fake_stop(&server);

    CHECK(fake_start(&server, script_wrong_token));
    CHECK(!fake_open(&server, path, LONG_MS, &error));
    CHECK_INT(error.code, PROTO_ERROR_WRONG_TOKEN);
    snprintf(expected, sizeof expected, "the token in %s is not that of this daemon: give its --token-file", path);
    CHECK_TEXT(error.text, expected);
    fake_stop(&server);
    unlink(path);
}
