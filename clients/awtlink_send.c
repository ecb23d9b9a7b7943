/* awtlink_send.c: what goes out over a link (awtlink.h): messages into its queue, and the queue to the transport. */
#include "awtlink_parts.h"
#include "layout.h"

/* Not now, but it may be tried again. */
static bool refuse_full(awtclient_error *error, const proto_message *message, const char *why)
{
    awtcodec_fail(error, AWTCLIENT_FULL, "%s cannot be sent yet: %s", proto_type_name(message->type), why);
    if (error) {
        error->retry = true;
    }
    return false;
}

/* Head and blob are copied: the caller keeps what is its own. */
bool link_enqueue(awtlink *link, const proto_message *message, awtclient_error *error)
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
        return refuse_full(error, message, "too much waits to be sent already, for the daemon does not keep up");
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
        return refuse_full(error, message, "the handshake is not over");
    }
    if (awtcodec_answer_type(message->type) == 0) {
        return link_enqueue(link, message, error);
    }
    if (!openrequests_reserve(&link->open)) {
        return refuse_full(error, message, "too many requests wait for their answers");
    }
    awtcodec_number(&link->codec, message);
    if (!link_enqueue(link, message, error)) {
        return false;
    }
    openrequests_add(&link->open, message->request, message->type);
    return true;
}

void link_note_wait(awtlink *link, long answer)
{
    link->wanted |= answer == AWTLINK_WANT_READ ? AWTLINK_READ : AWTLINK_WRITE;
}

void link_flush(awtlink *link)
{
    size_t sent = 0, size;
    link->send_waits = false;
    while (!link->sending_ended && sent < LINK_PUMP_BYTES) {
        const unsigned char *bytes = outqueue_front(&link->out, &size);
        if (size == 0) {
            return;
        }
        awtclient_error why = {.code = 0};
        long took = link->transport.send(link->transport.context, bytes, size, &why);
        if (took == AWTLINK_WANT_READ || took == AWTLINK_WANT_WRITE) {
            link_note_wait(link, took);
            link->send_waits = true;
            return;
        }
        if (took <= 0 || (size_t)took > size) {
            link->sending_ended = true;
            link_closed(link);
            if (why.code != 0) {
                link->failure = why;
            }
            return;
        }
        outqueue_taken(&link->out, (size_t)took);
        sent += (size_t)took;
    }
}
