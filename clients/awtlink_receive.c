/* awtlink_receive.c: what comes over a link (awtlink.h): bytes to messages, those that are the link's own business, and
 * answers that do not come. */
#include "awtlink_parts.h"

/* ---- receiving --------------------------------------------------------------------------------------- */

/* One read into the codec's buffer. False: there is nothing more to be had now. */
static bool receive_some(awtlink *link, size_t *total)
{
    size_t room;
    unsigned char *place = awtcodec_room(&link->codec, &room);
    if (!place) {
        awtcodec_fail(&link->failure, AWTCLIENT_MEMORY, "not enough memory for what the daemon sends");
        return link_fail(link);
    }
    awtclient_error why = {.code = 0};
    long got = link->transport.receive(link->transport.context, place, room, &why);
    if (got == AWTLINK_WANT_READ || got == AWTLINK_WANT_WRITE) {
        link_note_wait(link, got);
        return false;
    }
    if (got <= 0 || (size_t)got > room) {
        if (!link->sending_ended) {
            link_closed(link);
        }
        if (why.code != 0) {
            link->failure = why;
        }
        return link_fail(link);
    }
    awtcodec_filled(&link->codec, (size_t)got);
    link->received_us = link->now_us;
    *total += (size_t)got;
    return true;
}

void link_receive(awtlink *link)
{
    size_t total = 0;
    for (;;) {
        switch (awtcodec_ready(&link->codec, &link->failure)) {
        case AWTCODEC_MESSAGE:
            link->pending = true;
            return;
        case AWTCODEC_BAD:
            link_fail(link);
            return;
        case AWTCODEC_MORE:
            break;
        }
        if (total >= LINK_PUMP_BYTES) {
            link->pending = true;
            return;
        }
        if (!receive_some(link, &total)) {
            return;
        }
    }
}

/* ---- messages ---------------------------------------------------------------------------------------- */

static bool said_bye(awtlink *link, const proto_message *bye)
{
    char reason[161];
    proto_str_copy(bye->as.bye.reason, reason, sizeof reason);
    awtcodec_fail(&link->failure, AWTCLIENT_CLOSED, "the daemon closed the connection%s%s", reason[0] ? ": " : "",
                  reason);
    return link_fail(link);
}

static bool answer_ping(awtlink *link, const proto_message *ping)
{
    proto_message pong = {.type = PROTO_PONG, .request = ping->request};
    pong.as.pong.sent_us = ping->as.ping.sent_us;
    pong.as.pong.received_us = link->received_us;
    pong.as.pong.answered_us = link->now_us;
    awtclient_error why = {.code = 0};
    /* A full queue means that the peer does not read: it will not miss this answer. */
    if (!link_enqueue(link, &pong, &why) && why.code != AWTCLIENT_FULL) {
        link->failure = why;
        return link_fail(link);
    }
    return true;
}

/* Notes what a message says of the request that it belongs to. */
static void note_answer(awtlink *link, const proto_message *message)
{
    if (message->type == PROTO_PROGRESS) {
        openrequests_prolong(&link->open, message->request);
    } else {
        openrequests_remove(&link->open, message->request);
    }
}

bool link_take(awtlink *link, proto_message *message)
{
    for (;;) {
        switch (awtcodec_next(&link->codec, message, &link->failure)) {
        case AWTCODEC_MORE:
            return false;
        case AWTCODEC_BAD:
            return link_fail(link);
        case AWTCODEC_MESSAGE:
            break;
        }
        if (message->type == PROTO_BYE) {
            return said_bye(link, message);
        }
        if (message->type != PROTO_PING) {
            note_answer(link, message);
            return true;
        }
        if (!answer_ping(link, message)) {
            return false;
        }
    }
}

/* What has come is read first, for the answer may be in it,
 * but a peer who never stops talking of other things does not put it off for ever. */
bool link_take_overdue(awtlink *link, proto_message *message)
{
    const open_request *first = openrequests_first(&link->open);
    const int64_t late_us = first ? link->now_us - first->deadline_us : -1;
    if (late_us < 0 || (!(link->wanted & AWTLINK_READ) && late_us < (int64_t)link->timeout_ms * 1000)) {
        return false;
    }
    *message = (proto_message){.type = PROTO_ERROR, .request = first->request};
    message->as.error = (struct proto_error){.code = PROTO_ERROR_TIMED_OUT,
                                             .retry = 1,
                                             .about = first->type,
                                             .text = proto_str_of("the daemon did not answer in time")};
    openrequests_remove(&link->open, first->request);
    return true;
}
