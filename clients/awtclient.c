/* awtclient.c: requests and answers of callers that wait. The session (awtsession.c) does the work; here is the
 * waiting. A session that is lost stays so until the caller asks for it (awtclient_reopen).
 *
 * Every call has one deadline, whatever comes meanwhile, so that a peer who is slow, silent or lying costs the caller
 * at most its timeout. */
#include "awtclient.h"
#include "codec.h"
#include "socket.h"

#include <stdlib.h>

enum { DEFAULT_TIMEOUT_MS = 30000, UPLOAD_PIECE = 1 << 20 };

struct awtclient {
    awtsession *session;
    int timeout_ms;
    bool given_up; /* the daemon took nothing for that long: a message is cut off, and none can follow it */
};

static int64_t deadline_of(const awtclient *client)
{
    return socket_now_us() + (int64_t)client->timeout_ms * 1000;
}

static bool timed_out(const awtclient *client, awtclient_error *error)
{
    return awtcodec_fail(error, AWTCLIENT_TIMEOUT, "the daemon did not answer within %d ms", client->timeout_ms);
}

/* Waits for the descriptor and pumps once. The deadline is asked each time: a peer who never stops sending is bounded,
 * too. */
static bool wait_and_pump(awtclient *client, int64_t deadline_us, awtclient_error *error)
{
    int64_t until_us = awtsession_deadline_us(client->session);
    socket_wait(awtsession_descriptor(client->session), awtsession_wanted(client->session),
                until_us < deadline_us ? until_us : deadline_us);
    if (!awtsession_pump(client->session, socket_now_us(), error)) {
        return false;
    }
    return socket_left_ms(deadline_us) > 0 || timed_out(client, error);
}

/* The same for one who wants messages: no wait where there is more already. */
static bool turn(awtclient *client, int64_t deadline_us, awtclient_error *error)
{
    if (!awtsession_pending(client->session)) {
        return wait_and_pump(client, deadline_us, error);
    }
    if (!awtsession_pump(client->session, socket_now_us(), error)) {
        return false;
    }
    return socket_left_ms(deadline_us) > 0 || timed_out(client, error);
}

/* ---- sending and receiving --------------------------------------------------------------------------- */

/* Queues it, and waits where the queue is full. */
static bool queue_message(awtclient *client, proto_message *message, int64_t deadline_us, awtclient_error *error)
{
    awtclient_error why;
    while (!awtsession_queue(client->session, message, &why)) {
        if (why.code != AWTCLIENT_FULL) {
            return awtcodec_pass(error, &why);
        }
        if (!wait_and_pump(client, deadline_us, error)) {
            return false;
        }
    }
    return awtsession_pump(client->session, socket_now_us(), error);
}

static bool send_message(awtclient *client, proto_message *message, int64_t deadline_us, awtclient_error *error)
{
    if (client->given_up) {
        return awtcodec_fail(error, AWTCLIENT_CLOSED, "the connection to the daemon has ended");
    }
    if (!queue_message(client, message, deadline_us, error)) {
        return false;
    }
    while (awtsession_link(client->session) && awtlink_queued(awtsession_link(client->session)) > 0) {
        if (!wait_and_pump(client, deadline_us, error)) {
            client->given_up = true;
            return false;
        }
    }
    return true;
}

bool awtclient_send(awtclient *client, proto_message *message, awtclient_error *error)
{
    return send_message(client, message, deadline_of(client), error);
}

static bool receive_message(awtclient *client, proto_message *message, int64_t deadline_us, awtclient_error *error)
{
    for (;;) {
        switch (awtsession_next(client->session, message, error)) {
        case AWTSESSION_MESSAGE:
            return true;
        case AWTSESSION_LOST:
            return false;
        case AWTSESSION_OPENED:
            break;
        case AWTSESSION_NOTHING:
            if (!turn(client, deadline_us, error)) {
                return false;
            }
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

/* ---- the whole --------------------------------------------------------------------------------------- */

/* Waits until the session is open. What comes before is nobody's. */
static bool wait_open(awtclient *client, awtclient_error *error)
{
    proto_message *scratch = malloc(sizeof *scratch);
    bool open = false, good = scratch || awtcodec_fail(error, AWTCLIENT_MEMORY, "not enough memory");
    while (good && !open) {
        open = awtsession_next(client->session, scratch, error) == AWTSESSION_OPENED;
        good = open || turn(client, INT64_MAX, error); /* sessions have deadlines of their own until then */
    }
    free(scratch);
    return good;
}

awtclient *awtclient_open(const awtclient_options *options, awtclient_error *error)
{
    const awtsession_options once = {.link = *options, .patience_ms = AWTSESSION_STAY_LOST};
    awtclient *client = calloc(1, sizeof *client);
    if (!client) {
        awtcodec_fail(error, AWTCLIENT_MEMORY, "not enough memory");
        return NULL;
    }
    client->timeout_ms = options->timeout_ms > 0 ? options->timeout_ms : DEFAULT_TIMEOUT_MS;
    client->session = awtsession_open(&once, socket_now_us(), error);
    if (!client->session || !wait_open(client, error)) {
        awtclient_close(client);
        return NULL;
    }
    return client;
}

bool awtclient_reopen(awtclient *client, int patience_ms, awtclient_error *error)
{
    awtsession_return(client->session, patience_ms > 0 ? patience_ms : AWTSESSION_STAY_LOST, socket_now_us());
    client->given_up = false;
    return wait_open(client, error);
}

void awtclient_close(awtclient *client)
{
    if (client) {
        awtsession_close(client->session);
        free(client);
    }
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
    return awtsession_descriptor(client->session);
}

awtsession *awtclient_session(awtclient *client)
{
    return client->session;
}
