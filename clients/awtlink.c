/* awtlink.c: see awtlink.h. What the bytes mean is codec.c's, how they travel is the transport's; here both meet.
 *
 * Everything that fails for good is remembered with its text: whoever asks later hears the first reason. */
#include "awtlink_parts.h"
#include "socket.h"

#include <stdlib.h>
#include <string.h>

enum { DEFAULT_TIMEOUT_MS = 30000, DEFAULT_QUEUE = 4 << 20 };

bool link_fail(awtlink *link)
{
    link->failed = true;
    return false;
}

void link_closed(awtlink *link)
{
    awtcodec_fail(&link->failure, AWTCLIENT_CLOSED, "the connection to the daemon has ended");
}

/* ---- the handshake ----------------------------------------------------------------------------------- */

/* One step of the handshake, if its message has come. */
static void shake_hands(awtlink *link)
{
    proto_message message;
    while (!link->failed && !awtlink_ready(link) && link_take(link, &message)) {
        proto_message reply;
        switch (handshake_take(&link->greeting, &link->codec, &message, &reply, &link->failure)) {
        case HANDSHAKE_SEND:
            if (!link_enqueue(link, &reply, &link->failure)) {
                link_fail(link);
            }
            break;
        case HANDSHAKE_DONE:
            break;
        case HANDSHAKE_FAILED:
            link_fail(link);
            break;
        }
    }
}

static void check_deadline(awtlink *link)
{
    if (!link->failed && !awtlink_ready(link) && link->now_us >= link->deadline_us) {
        awtcodec_fail(&link->failure, AWTCLIENT_TIMEOUT, "the daemon did not answer within %d ms", link->timeout_ms);
        link_fail(link);
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
    openrequests_stamp(&link->open, now_us + (int64_t)link->timeout_ms * 1000);
    link_flush(link);
    link_receive(link);
    if (!link->failed && !awtlink_ready(link)) {
        shake_hands(link);
        if (!link->failed) {
            link_flush(link);
        }
    }
    if (link->sending_ended && !link->pending) {
        link_fail(link);
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
    if (link_take(link, message)) {
        return true;
    }
    if (link->failed) {
        return awtcodec_pass(error, &link->failure);
    }
    return link_take_overdue(link, message);
}

static void link_free(awtlink *link)
{
    if (link->transport.close) {
        link->transport.close(link->transport.context);
    }
    awtcodec_fini(&link->codec);
    handshake_fini(&link->greeting);
    outqueue_fini(&link->out);
    openrequests_fini(&link->open);
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
    if (!handshake_init(&link->greeting, &link->codec, options, &hello, error) || !link_enqueue(link, &hello, error)) {
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
        link_flush(link);
    }
    link_free(link);
}

void awtlink_drop(awtlink *link)
{
    if (link) {
        link_free(link);
    }
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
    if (link->failed) {
        return INT64_MAX;
    }
    const open_request *first = openrequests_first(&link->open);
    return !awtlink_ready(link) ? link->deadline_us : first ? first->deadline_us : INT64_MAX;
}

const uint8_t *awtlink_session_token(const awtlink *link)
{
    return link->codec.session;
}

int64_t awtlink_received_us(const awtlink *link)
{
    return link->received_us;
}
