/* engine_hair.c: see engine_hair.h.
 *
 * The way to hair is CREATE, BINDING (what strands are made with from guides), SUBSCRIBE, each sent when the one before
 * is answered. Where the connection was lost, the session has brought back what it could (awtsession.h): hair that is
 * still there is only subscribed to again. */
#include "engine_hair.h"

#include <stdio.h>

enum {
    HAIR_ASKING = 15, /* questions under way; more would only make a late daemon later */
    HAIR_KIND = 2,    /* guides, with deltas: the fewest bytes; strands are made of them where they are decoded */
    HAIR_NODES = 3    /* what a question answers: the fewest bytes */
};

bool engine_failed(const char *why)
{
    fprintf(stderr, "engine_loop: %s\n", why);
    return false;
}

/* What is refused because too much waits to be sent, or nobody is there, is left out: the next motion says more. */
static bool send(engine_hair *hair, proto_message *message)
{
    awtclient_error error;
    return awtsession_queue(hair->session, message, &error) || error.code == AWTCLIENT_FULL ||
           engine_failed(error.text);
}

/* How long is the way? */
static bool ping(engine_hair *hair)
{
    proto_message ping = {.type = PROTO_PING};
    ping.as.ping.sent_us = awtclient_now_us();
    return send(hair, &ping);
}

/* ---- making it ------------------------------------------------------------------------------------------------ */

static bool make(engine_hair *hair)
{
    proto_message create = {.type = PROTO_CREATE};
    create.as.create.style = proto_str_of(hair->style);
    create.as.create.seed = 1;
    create.as.create.strands = hair->strands;
    create.as.create.time_us = hair->begin_us;
    create.as.create.head = hair->begin_head;
    create.as.create.body.orientation[3] = 1;
    return send(hair, &create);
}

/* What strands are made with; it stays the same as long as the hair. */
static bool ask_binding(engine_hair *hair)
{
    proto_message binding = {.type = PROTO_BINDING};
    binding.as.binding.forest = hair->forest;
    return send(hair, &binding);
}

/* The connection is there, for the first time or again. */
static bool opened(engine_hair *hair)
{
    uint32_t count;
    const awtsession_forest *forests = awtsession_forests(hair->session, &count);
    hair->subscription = 0;
    hair->asking = 0;
    hair->forest = count > 0 && forests[count - 1].open ? forests[count - 1].forest : 0;
    return ping(hair) && (hair->forest != 0 ? ask_binding(hair) : make(hair));
}

static uint32_t window(const engine_hair *hair)
{
    return awtclock_credit(&hair->clock, ENGINE_STREAM_RATE, ENGINE_OLDEST_US);
}

static bool subscribe(engine_hair *hair)
{
    proto_message subscribe = {.type = PROTO_SUBSCRIBE};
    hair->under_way = window(hair);
    subscribe.as.subscribe =
        (struct proto_subscribe){.forest = hair->forest, .kind = HAIR_KIND, .credit = hair->under_way, .deltas = 1};
    const bool good = send(hair, &subscribe);
    hair->subscribe_request = subscribe.request;
    return good;
}

/* ---- driving it ----------------------------------------------------------------------------------------------- */

bool engine_hair_ready(const engine_hair *hair)
{
    return hair->subscription != 0;
}

bool engine_hair_ask(engine_hair *hair, int64_t at_us, const proto_pose *head)
{
    proto_message motion = {.type = PROTO_MOTION}, query = {.type = PROTO_QUERY};
    motion.as.motion =
        (struct proto_motion){.forest = hair->forest, .sequence = ++hair->sequence, .time_us = at_us, .head = *head};
    motion.as.motion.body.orientation[3] = 1;
    query.as.query = (struct proto_query){.forest = hair->forest, .time_us = at_us, .kind = HAIR_NODES};
    if (!send(hair, &motion) || (hair->sequence % ENGINE_STREAM_RATE == 0 && !ping(hair))) {
        return false;
    }
    if (hair->asking >= HAIR_ASKING) { /* the poses are worth sending all the same: the hair will follow them all */
        return true;
    }
    hair->asking++;
    return send(hair, &query);
}

bool engine_hair_acknowledge(engine_hair *hair)
{
    const uint32_t wanted = window(hair);
    if (hair->under_way >= wanted || !engine_hair_ready(hair)) {
        return true;
    }
    proto_message credit = {.type = PROTO_CREDIT};
    credit.as.credit = (struct proto_credit){
        .subscription = hair->subscription, .frames = wanted - hair->under_way, .have = awtframes_have(hair->frames)};
    hair->under_way = wanted;
    return send(hair, &credit);
}

/* ---- hearing of it -------------------------------------------------------------------------------------------- */

static bool bind(engine_hair *hair, proto_blob binding)
{
    awtclient_error error;
    return awtframes_bind(hair->frames, binding.bytes, binding.length, &error) || engine_failed(error.text);
}

static bool take_frame(engine_hair *hair, const struct proto_frame *frame)
{
    awtclient_error error;
    engine_measure_frame(hair->measure, frame, &hair->clock);
    hair->under_way -= hair->under_way > 0;
    return awtframes_take(hair->frames, frame, &error) || engine_failed(error.text);
}

static bool take(engine_hair *hair, const proto_message *message)
{
    char text[256];
    if (message->type == PROTO_FRAME && message->request == hair->subscribe_request) {
        return take_frame(hair, &message->as.frame);
    }
    hair->asking -= hair->asking > 0 && (message->type == PROTO_FRAME || message->type == PROTO_ERROR);
    switch (message->type) {
    case PROTO_CREATE_REPLY:
        hair->forest = message->as.create_reply.forest;
        return ask_binding(hair);
    case PROTO_BINDING_REPLY:
        return bind(hair, message->as.binding_reply.binding) && subscribe(hair);
    case PROTO_SUBSCRIBE_REPLY:
        hair->subscription = message->as.subscribe_reply.subscription;
        return true;
    case PROTO_PONG:
        awtclock_add(&hair->clock, message->as.pong.sent_us, message->as.pong.received_us, message->as.pong.answered_us,
                     awtlink_received_us(awtsession_link(hair->session)));
        return true;
    case PROTO_ERROR:
        proto_str_copy(message->as.error.text, text, sizeof text);
        hair->measure->busy++;
        return message->as.error.retry == 1 || engine_failed(text);
    default:
        return true;
    }
}

bool engine_hair_listen(engine_hair *hair)
{
    static proto_message message; /* large */
    awtclient_error error;
    for (;;) {
        switch (awtsession_next(hair->session, &message, &error)) {
        case AWTSESSION_NOTHING:
            return true;
        case AWTSESSION_LOST:
            engine_measure_lost(hair->measure);
            hair->subscription = 0;
            fprintf(stderr, "engine_loop: %s; trying again\n", error.text);
            break;
        case AWTSESSION_OPENED:
            if (!opened(hair)) {
                return false;
            }
            break;
        case AWTSESSION_MESSAGE:
            if (!take(hair, &message)) {
                return false;
            }
        }
    }
}
