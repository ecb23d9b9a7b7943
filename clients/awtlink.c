/* awtlink.c: see awtlink.h. What the bytes mean is codec.c's, how they travel is the transport's; here both meet.
 *
 * Everything that fails for good is remembered with its text: whoever asks later hears the first reason. */
#include "awtlink.h"
#include "codec.h"
#include "handshake.h"
#include "layout.h"
#include "outqueue.h"
#include "socket.h"

#include <stdlib.h>
#include <string.h>

enum {
    DEFAULT_TIMEOUT_MS = 30000,
    DEFAULT_QUEUE = 4 << 20,
    PUMP_BYTES = 1 << 20 /* in and out each, by one call */
};

struct awtlink {
    awtlink_transport transport;
    awtcodec codec;
    handshake greeting;
    outqueue out;
    uint32_t queue_bytes;
    int timeout_ms;
    int64_t deadline_us, now_us, received_us;
    unsigned wanted;    /* AWTLINK_READ, AWTLINK_WRITE: what the transport said last */
    bool send_waits;    /* the transport takes no more until then */
    bool pending;       /* receiving stopped by our bound, not by the transport */
    bool sending_ended; /* the transport sends no more; `failure` says why, once nothing more comes */
    bool failed;        /* for good */
    awtclient_error failure;
};

/* For good; link->failure says why. */
static bool fail(awtlink *link)
{
    link->failed = true;
    return false;
}

static void closed(awtlink *link)
{
    awtcodec_fail(&link->failure, AWTCLIENT_CLOSED, "the connection to the daemon has ended");
}

/* ---- sending ----------------------------------------------------------------------------------------- */

/* Head and blob are copied: the caller keeps what is its own. */
static bool enqueue(awtlink *link, const proto_message *message, awtclient_error *error)
{
    size_t size = proto_encoded_size(message);
    if (size == 0) {
        return awtcodec_fail(error, PROTO_ERROR_LIMIT, "%s cannot be sent: a text or list in it is too long",
                             proto_type_name(message->type));
    }
    if (link->codec.in && size - PROTO_HEADER_SIZE > link->codec.greatest_payload) {
        return awtcodec_fail(error, PROTO_ERROR_TOO_LONG, "%s cannot be sent: the daemon takes %lu bytes at most",
                             proto_type_name(message->type), (unsigned long)link->codec.greatest_payload);
    }
    size_t waiting = outqueue_size(&link->out);
    if (waiting > 0 && waiting + size > link->queue_bytes) {
        awtcodec_fail(error, AWTCLIENT_FULL, "%lu bytes wait to be sent already: the daemon does not keep up",
                      (unsigned long)waiting);
        if (error) {
            error->retry = true;
        }
        return false;
    }
    unsigned char *place = outqueue_room(&link->out, size);
    if (!place) {
        return awtcodec_fail(error, AWTCLIENT_MEMORY, "not enough memory");
    }
    outqueue_filled(&link->out, proto_encode(message, place, size));
    return true;
}

bool awtlink_queue(awtlink *link, proto_message *message, awtclient_error *error)
{
    if (link->failed || link->sending_ended) {
        return awtcodec_pass(error, &link->failure);
    }
    if (!awtlink_ready(link)) {
        awtcodec_fail(error, AWTCLIENT_FULL, "%s cannot be sent yet: the handshake is not over",
                      proto_type_name(message->type));
        if (error) {
            error->retry = true;
        }
        return false;
    }
    if (awtcodec_answer_type(message->type) != 0) {
        awtcodec_number(&link->codec, message);
    }
    return enqueue(link, message, error);
}

/* What the transport answered where it took or gave no bytes. */
static void note_wait(awtlink *link, long answer)
{
    link->wanted |= answer == AWTLINK_WANT_READ ? AWTLINK_READ : AWTLINK_WRITE;
}

static void flush(awtlink *link)
{
    size_t sent = 0, size;
    link->send_waits = false;
    while (!link->sending_ended && sent < PUMP_BYTES) {
        const unsigned char *bytes = outqueue_front(&link->out, &size);
        if (size == 0) {
            return;
        }
        awtclient_error why = {.code = 0};
        long took = link->transport.send(link->transport.context, bytes, size, &why);
        if (took == AWTLINK_WANT_READ || took == AWTLINK_WANT_WRITE) {
            note_wait(link, took);
            link->send_waits = true;
            return;
        }
        if (took <= 0 || (size_t)took > size) {
            link->sending_ended = true;
            closed(link);
            if (why.code != 0) {
                link->failure = why;
            }
            return;
        }
        outqueue_taken(&link->out, (size_t)took);
        sent += (size_t)took;
    }
}

/* ---- receiving --------------------------------------------------------------------------------------- */

/* One read into the codec's buffer. False: there is nothing more to be had now. */
static bool receive_some(awtlink *link, size_t *total)
{
    size_t room;
    unsigned char *place = awtcodec_room(&link->codec, &room);
    if (!place) {
        awtcodec_fail(&link->failure, AWTCLIENT_MEMORY, "not enough memory for what the daemon sends");
        return fail(link);
    }
    awtclient_error why = {.code = 0};
    long got = link->transport.receive(link->transport.context, place, room, &why);
    if (got == AWTLINK_WANT_READ || got == AWTLINK_WANT_WRITE) {
        note_wait(link, got);
        return false;
    }
    if (got <= 0 || (size_t)got > room) {
        if (!link->sending_ended) {
            closed(link);
        }
        if (why.code != 0) {
            link->failure = why;
        }
        return fail(link);
    }
    awtcodec_filled(&link->codec, (size_t)got);
    link->received_us = link->now_us;
    *total += (size_t)got;
    return true;
}

/* Receives until a message is whole, the transport has no more, or it is enough for one call. */
static void receive(awtlink *link)
{
    size_t total = 0;
    for (;;) {
        switch (awtcodec_ready(&link->codec, &link->failure)) {
        case AWTCODEC_MESSAGE:
            link->pending = true;
            return;
        case AWTCODEC_BAD:
            fail(link);
            return;
        case AWTCODEC_MORE:
            break;
        }
        if (total >= PUMP_BYTES) {
            link->pending = true;
            return;
        }
        if (!receive_some(link, &total)) {
            return;
        }
    }
}

/* ---- the handshake ----------------------------------------------------------------------------------- */

static bool said_bye(awtlink *link, const proto_message *bye)
{
    char reason[161];
    proto_str_copy(bye->as.bye.reason, reason, sizeof reason);
    awtcodec_fail(&link->failure, AWTCLIENT_CLOSED, "the daemon closed the connection%s%s", reason[0] ? ": " : "",
                  reason);
    return fail(link);
}

static bool answer_ping(awtlink *link, const proto_message *ping)
{
    proto_message pong = {.type = PROTO_PONG, .request = ping->request};
    pong.as.pong.sent_us = ping->as.ping.sent_us;
    pong.as.pong.received_us = link->received_us;
    pong.as.pong.answered_us = link->now_us;
    awtclient_error why = {.code = 0};
    /* A full queue means that the peer does not read: it will not miss this answer. */
    if (!enqueue(link, &pong, &why) && why.code != AWTCLIENT_FULL) {
        link->failure = why;
        return fail(link);
    }
    return true;
}

/* The next message that is not the link's own business. False with the link unfailed: none has come. */
static bool take(awtlink *link, proto_message *message)
{
    for (;;) {
        switch (awtcodec_next(&link->codec, message, &link->failure)) {
        case AWTCODEC_MORE:
            return false;
        case AWTCODEC_BAD:
            return fail(link);
        case AWTCODEC_MESSAGE:
            break;
        }
        if (message->type == PROTO_BYE) {
            return said_bye(link, message);
        }
        if (message->type != PROTO_PING) {
            return true;
        }
        if (!answer_ping(link, message)) {
            return false;
        }
    }
}

/* One step of the handshake, if its message has come. */
static void shake_hands(awtlink *link)
{
    proto_message message;
    while (!link->failed && !awtlink_ready(link) && take(link, &message)) {
        proto_message reply;
        switch (handshake_take(&link->greeting, &link->codec, &message, &reply, &link->failure)) {
        case HANDSHAKE_SEND:
            if (!enqueue(link, &reply, &link->failure)) {
                fail(link);
            }
            break;
        case HANDSHAKE_DONE:
            break;
        case HANDSHAKE_FAILED:
            fail(link);
            break;
        }
    }
}

static void check_deadline(awtlink *link)
{
    if (!link->failed && !awtlink_ready(link) && link->now_us >= link->deadline_us) {
        awtcodec_fail(&link->failure, AWTCLIENT_TIMEOUT, "the daemon did not answer within %d ms", link->timeout_ms);
        fail(link);
    }
}

/* ---- the whole --------------------------------------------------------------------------------------- */

bool awtlink_pump(awtlink *link, int64_t now_us, awtclient_error *error)
{
    if (link->failed) {
        return awtcodec_pass(error, &link->failure);
    }
    link->now_us = now_us;
    link->wanted = 0;
    link->pending = false;
    flush(link);
    receive(link);
    if (!link->failed && !awtlink_ready(link)) {
        shake_hands(link);
        if (!link->failed) {
            flush(link);
        }
    }
    if (link->sending_ended && !link->pending) {
        fail(link);
    }
    check_deadline(link);
    return !link->failed || awtcodec_pass(error, &link->failure);
}

bool awtlink_next(awtlink *link, proto_message *message, awtclient_error *error)
{
    if (error) {
        *error = (awtclient_error){.code = 0};
    }
    if (link->failed) {
        return awtcodec_pass(error, &link->failure);
    }
    if (!awtlink_ready(link)) {
        return false;
    }
    if (take(link, message)) {
        return true;
    }
    return link->failed && awtcodec_pass(error, &link->failure);
}

static void link_free(awtlink *link)
{
    if (link->transport.close) {
        link->transport.close(link->transport.context);
    }
    awtcodec_fini(&link->codec);
    handshake_fini(&link->greeting);
    outqueue_fini(&link->out);
    free(link);
}

awtlink *awtlink_open(const awtclient_options *options, int64_t now_us, awtclient_error *error)
{
    awtlink *link = calloc(1, sizeof *link);
    awtlink_transport transport = {.context = NULL};
    proto_message hello;
    if (options->transport) {
        transport = *options->transport;
    }
    if (!link) {
        awtcodec_fail(error, AWTCLIENT_MEMORY, "not enough memory");
        if (transport.close) {
            transport.close(transport.context);
        }
        return NULL;
    }
    link->transport = transport;
    link->timeout_ms = options->timeout_ms > 0 ? options->timeout_ms : DEFAULT_TIMEOUT_MS;
    link->queue_bytes = options->queue_bytes > 0 ? options->queue_bytes : (uint32_t)DEFAULT_QUEUE;
    link->now_us = link->received_us = now_us;
    link->deadline_us = now_us + (int64_t)link->timeout_ms * 1000;
    awtcodec_init(&link->codec);
    if (!options->transport && !socket_begin(options->address, &link->transport, error)) {
        goto fail;
    }
    if (!handshake_init(&link->greeting, &link->codec, options, &hello, error) || !enqueue(link, &hello, error)) {
        goto fail;
    }
    link->wanted = AWTLINK_READ;
    return link;
fail:
    link_free(link);
    return NULL;
}

void awtlink_close(awtlink *link)
{
    if (!link) {
        return;
    }
    proto_message bye = {.type = PROTO_BYE};
    if (!link->failed && awtlink_queue(link, &bye, NULL)) {
        flush(link);
    }
    link_free(link);
}

bool awtlink_ready(const awtlink *link)
{
    return link->codec.in;
}

size_t awtlink_queued(const awtlink *link)
{
    return outqueue_size(&link->out);
}

int awtlink_descriptor(const awtlink *link)
{
    return link->transport.descriptor ? link->transport.descriptor(link->transport.context) : -1;
}

unsigned awtlink_wanted(const awtlink *link)
{
    bool fresh = outqueue_size(&link->out) > 0 && !link->send_waits && !link->sending_ended;
    return link->wanted | (fresh ? AWTLINK_WRITE : 0u);
}

bool awtlink_pending(const awtlink *link)
{
    return link->pending;
}

int64_t awtlink_deadline_us(const awtlink *link)
{
    return awtlink_ready(link) || link->failed ? INT64_MAX : link->deadline_us;
}

int64_t awtlink_received_us(const awtlink *link)
{
    return link->received_us;
}
