/* awtclient.c: connections, requests and answers. What the bytes mean is codec.c's, how they travel is socket.c's.
 *
 * Every call has one deadline, whatever comes meanwhile, so that a peer who is slow, silent or lying costs the caller
 * at most its timeout. When a stream is cut inside of a message it is of no use any more, and later calls say so. */
#include "awtclient.h"
#include "codec.h"
#include "layout.h"
#include "socket.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEFAULT_TIMEOUT_MS = 30000, UPLOAD_PIECE = 1 << 20 };

struct awtclient {
    int descriptor;
    int timeout_ms;
    bool broken;
    awtcodec codec;
    unsigned char *out; /* heap; the message being sent, without its tail */
    size_t out_capacity;
};

static int64_t deadline_of(const awtclient *client)
{
    return socket_now_us() + (int64_t)client->timeout_ms * 1000;
}

/* ---- sending ----------------------------------------------------------------------------------------- */

static bool closed(awtclient *client, awtclient_error *error)
{
    client->broken = true;
    return awtcodec_fail(error, AWTCLIENT_CLOSED, "the connection to the daemon has ended");
}

static bool timed_out(const awtclient *client, awtclient_error *error)
{
    return awtcodec_fail(error, AWTCLIENT_TIMEOUT, "the daemon did not answer within %d ms", client->timeout_ms);
}

static bool grow_out(awtclient *client, size_t size)
{
    if (size > client->out_capacity) {
        unsigned char *larger = realloc(client->out, size);
        if (!larger) {
            return false;
        }
        client->out = larger;
        client->out_capacity = size;
    }
    return true;
}

/* Head and tail (a blob at the end, if there is one) go out together, without a copy of the tail. */
static bool send_message(awtclient *client, const proto_message *message, int64_t deadline_us, awtclient_error *error)
{
    size_t size = proto_encoded_size(message);
    if (client->broken) {
        return closed(client, error);
    }
    if (size == 0) {
        return awtcodec_fail(error, PROTO_ERROR_LIMIT, "%s cannot be sent: a text or list in it is too long",
                             proto_type_name(message->type));
    }
    if (client->codec.in && size - PROTO_HEADER_SIZE > client->codec.greatest_payload) {
        return awtcodec_fail(error, PROTO_ERROR_TOO_LONG, "%s cannot be sent: the daemon takes %lu bytes at most",
                             proto_type_name(message->type), (unsigned long)client->codec.greatest_payload);
    }
    const proto_blob *tail = proto_tail(message);
    size_t head = size - (tail ? tail->length : 0);
    if (!grow_out(client, head)) {
        return awtcodec_fail(error, AWTCLIENT_MEMORY, "not enough memory");
    }
    proto_blob bytes = {client->out, (uint32_t)proto_encode_head(message, client->out, head)};
    switch (socket_send(client->descriptor, bytes, tail ? *tail : (proto_blob){NULL, 0}, deadline_us)) {
    case SOCKET_DONE:
        return true;
    case SOCKET_LATE:
        client->broken = true; /* the message is cut off: nothing can follow it */
        return timed_out(client, error);
    case SOCKET_ENDED:
        break;
    }
    return closed(client, error);
}

bool awtclient_send(awtclient *client, proto_message *message, awtclient_error *error)
{
    if (awtcodec_answer_type(message->type) != 0) {
        awtcodec_number(&client->codec, message);
    }
    return send_message(client, message, deadline_of(client), error);
}

/* ---- receiving --------------------------------------------------------------------------------------- */

/* One read into the codec's buffer. The deadline is asked after it too: a peer who never stops sending is bounded. */
static bool receive_bytes(awtclient *client, int64_t deadline_us, awtclient_error *error)
{
    size_t room, got;
    unsigned char *place = awtcodec_room(&client->codec, &room);
    if (!place) {
        return awtcodec_fail(error, AWTCLIENT_MEMORY, "not enough memory for what the daemon sends");
    }
    switch (socket_receive(client->descriptor, place, room, &got, deadline_us)) {
    case SOCKET_DONE:
        awtcodec_filled(&client->codec, got);
        return socket_left_ms(deadline_us) > 0 || timed_out(client, error);
    case SOCKET_LATE:
        return timed_out(client, error);
    case SOCKET_ENDED:
        break;
    }
    return closed(client, error);
}

static bool receive_any(awtclient *client, proto_message *message, int64_t deadline_us, awtclient_error *error)
{
    if (client->broken) {
        return closed(client, error);
    }
    for (;;) {
        switch (awtcodec_next(&client->codec, message, error)) {
        case AWTCODEC_MESSAGE:
            return true;
        case AWTCODEC_BAD:
            client->broken = true;
            return false;
        case AWTCODEC_MORE:
            break;
        }
        if (!receive_bytes(client, deadline_us, error)) {
            return false;
        }
    }
}

static bool answer_ping(awtclient *client, const proto_message *ping, int64_t deadline_us, awtclient_error *error)
{
    proto_message pong = {.type = PROTO_PONG, .request = ping->request};
    pong.as.pong.sent_us = ping->as.ping.sent_us;
    pong.as.pong.received_us = socket_now_us();
    pong.as.pong.answered_us = socket_now_us();
    return send_message(client, &pong, deadline_us, error);
}

static bool said_bye(awtclient *client, const proto_message *bye, awtclient_error *error)
{
    char reason[161];
    proto_str_copy(bye->as.bye.reason, reason, sizeof reason);
    client->broken = true;
    return awtcodec_fail(error, AWTCLIENT_CLOSED, "the daemon closed the connection%s%s", reason[0] ? ": " : "",
                         reason);
}

/* The next message that is the caller's business. */
static bool receive_message(awtclient *client, proto_message *message, int64_t deadline_us, awtclient_error *error)
{
    for (;;) {
        if (!receive_any(client, message, deadline_us, error)) {
            return false;
        }
        if (message->type == PROTO_BYE) {
            return said_bye(client, message, error);
        }
        if (message->type != PROTO_PING) {
            return true;
        }
        if (!answer_ping(client, message, deadline_us, error)) {
            return false;
        }
    }
}

bool awtclient_receive(awtclient *client, proto_message *message, awtclient_error *error)
{
    return receive_message(client, message, deadline_of(client), error);
}

/* Whoever hears of each PROGRESS; NULL: nobody. */
typedef struct client_listener {
    void (*heard)(void *context, const struct proto_progress *progress);
    void *context;
} client_listener;

static bool call(awtclient *client, proto_message *request, proto_message *answer, const client_listener *listener,
                 awtclient_error *error)
{
    int64_t deadline_us = deadline_of(client);
    awtcodec_number(&client->codec, request);
    if (!send_message(client, request, deadline_us, error)) {
        return false;
    }
    for (;;) {
        if (!receive_message(client, answer, deadline_us, error)) {
            return false;
        }
        awtcodec_match match = awtcodec_matches(request, answer, error);
        if (match != AWTCODEC_OTHER) {
            return match == AWTCODEC_ANSWER;
        }
        if (listener && answer->type == PROTO_PROGRESS && answer->request == request->request) {
            deadline_us = deadline_of(client);
            listener->heard(listener->context, &answer->as.progress);
        }
    }
}

bool awtclient_call(awtclient *client, proto_message *request, proto_message *answer, awtclient_error *error)
{
    return call(client, request, answer, NULL, error);
}

bool awtclient_create(awtclient *client, proto_message *request, proto_message *answer,
                      void (*heard)(void *context, const struct proto_progress *progress), void *context,
                      awtclient_error *error)
{
    const client_listener listener = {heard, context};
    request->as.create.progress = 1;
    return call(client, request, answer, &listener, error);
}

/* ---- the handshake ----------------------------------------------------------------------------------- */

static bool random_bytes(void *bytes, size_t size, awtclient_error *error)
{
    FILE *file = fopen("/dev/urandom", "rb");
    size_t got = 0;
    if (file) {
        setvbuf(file, NULL, _IONBF, 0); /* take no more from it than is used */
        got = fread(bytes, 1, size, file);
        fclose(file);
    }
    return got == size || awtcodec_fail(error, AWTCLIENT_TOKEN, "/dev/urandom cannot be read: no random numbers");
}

static bool exchange(awtclient *client, proto_message *message, awtclient_error *error)
{
    int64_t deadline_us = deadline_of(client);
    return send_message(client, message, deadline_us, error) && receive_message(client, message, deadline_us, error);
}

static bool greet(awtclient *client, const char *name, bool *auth_required, awtclient_error *error)
{
    uint8_t key[AWTCODEC_KEY_SIZE];
    if (!random_bytes(key, sizeof key, error)) {
        return false;
    }
    proto_message message;
    awtcodec_hello(&client->codec, name, key, &message);
    return exchange(client, &message, error) && awtcodec_welcome(&client->codec, &message, auth_required, error);
}

static bool read_token(const char *path, uint8_t token[AUTH_TOKEN_SIZE], awtclient_error *error)
{
    FILE *file = fopen(path, "rb");
    if (!file && errno == ENOENT) {
        return awtcodec_fail(error, AWTCLIENT_TOKEN, "awtd wants a token; looked in %.150s: give --token-file", path);
    }
    if (!file) {
        return awtcodec_fail(error, AWTCLIENT_TOKEN,
                             "awtd wants a token; %.120s cannot be read (%.40s): give --token-file", path,
                             strerror(errno));
    }
    char text[256] = "";
    size_t size = fread(text, 1, sizeof text - 1, file);
    fclose(file);
    text[size] = '\0';
    if (!auth_token_parse(text, token)) {
        return awtcodec_fail(error, AWTCLIENT_TOKEN, "%.150s holds no token: that is 32 hexadecimal digits", path);
    }
    return true;
}

static bool authenticate(awtclient *client, const char *token_file, awtclient_error *error)
{
    char path[4096];
    if (!token_file && !auth_token_path(NULL, path, sizeof path)) {
        return awtcodec_fail(error, AWTCLIENT_TOKEN,
                             "awtd wants a token, and neither AWTD_STATE_DIR nor HOME says where: give --token-file");
    }
    if (!token_file) {
        token_file = path;
    }
    uint8_t token[AUTH_TOKEN_SIZE], nonce[AUTH_NONCE_SIZE];
    if (!read_token(token_file, token, error) || !random_bytes(nonce, sizeof nonce, error)) {
        return false;
    }
    proto_message message;
    awtcodec_auth(&client->codec, token, nonce, &message);
    if (!exchange(client, &message, error)) {
        return false;
    }
    if (message.type == PROTO_ERROR && message.as.error.code == PROTO_ERROR_WRONG_TOKEN) {
        return awtcodec_fail(error, PROTO_ERROR_WRONG_TOKEN,
                             "the token in %.120s is not that of this daemon: give its --token-file", token_file);
    }
    return awtcodec_auth_reply(&client->codec, &message, error);
}

/* ---- the whole --------------------------------------------------------------------------------------- */

static void client_free(awtclient *client)
{
    socket_close(client->descriptor);
    awtcodec_fini(&client->codec);
    free(client->out);
    free(client);
}

awtclient *awtclient_open(const awtclient_options *options, awtclient_error *error)
{
    awtclient *client = calloc(1, sizeof *client);
    if (!client) {
        awtcodec_fail(error, AWTCLIENT_MEMORY, "not enough memory");
        return NULL;
    }
    client->descriptor = -1;
    client->timeout_ms = options->timeout_ms > 0 ? options->timeout_ms : DEFAULT_TIMEOUT_MS;
    awtcodec_init(&client->codec);
    bool auth_required = false;
    client->descriptor = socket_open(options->address, deadline_of(client), error);
    if (client->descriptor < 0 || !greet(client, options->name, &auth_required, error)) {
        goto fail;
    }
    if (auth_required && !authenticate(client, options->token_file, error)) {
        goto fail;
    }
    return client;
fail:
    client_free(client);
    return NULL;
}

void awtclient_close(awtclient *client)
{
    if (!client) {
        return;
    }
    proto_message bye = {.type = PROTO_BYE};
    send_message(client, &bye, 0, NULL); /* the deadline has passed already: only what goes out at once does */
    client_free(client);
}

bool awtclient_upload(awtclient *client, uint32_t upload, const void *bytes, size_t size,
                      void (*progress)(void *context, double share), void *context, awtclient_error *error)
{
    if (size == 0) {
        return awtcodec_fail(error, PROTO_ERROR_BAD_UPLOAD, "the file is empty");
    }
    proto_message request = {.type = PROTO_UPLOAD};
    request.as.upload.upload = upload;
    request.as.upload.total = size;
    auth_sha256 hash;
    auth_sha256_init(&hash);
    auth_sha256_add(&hash, bytes, size);
    auth_sha256_done(&hash, request.as.upload.sha256);
    for (size_t sent = 0; sent < size;) {
        size_t piece = size - sent < UPLOAD_PIECE ? size - sent : UPLOAD_PIECE;
        request.request = 0;
        request.as.upload.offset = sent;
        request.as.upload.piece = (proto_blob){(const unsigned char *)bytes + sent, (uint32_t)piece};
        proto_message answer;
        if (!awtclient_call(client, &request, &answer, error)) {
            return false;
        }
        sent += piece;
        if (answer.as.upload_reply.received != sent) {
            return awtcodec_fail(error, AWTCLIENT_PEER, "the daemon has lost a piece of the file");
        }
        if (progress) {
            progress(context, (double)sent / (double)size);
        }
    }
    return true;
}

int awtclient_descriptor(const awtclient *client)
{
    return client->descriptor;
}
