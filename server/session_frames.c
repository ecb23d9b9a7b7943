/* session_frames.c: QUERY, SUBSCRIBE, UNSUBSCRIBE, CREDIT: what comes out of a forest. (A QUERY that advances is
 * answered in completions.c, when a worker has done it.) */
#include "handlers.h"

enum {
    KIND_RIBBON = 0,
    KIND_GREATEST = 3, /* ribbon, strands, guides, nodes */
    LEVEL_FULL = 0,
    LEVEL_GREATEST = 2 /* full, fifth, guides */
};

/* False: an ERROR was sent. */
static bool check_kind(session *s, const proto_message *message, uint8_t kind, uint8_t level)
{
    if (kind > KIND_GREATEST || level > LEVEL_GREATEST) {
        session_error(s, message->type, message->request, PROTO_ERROR_BAD_VALUE,
                      "kind is %u and level %u; the greatest are %d and %d", (unsigned)kind, (unsigned)level,
                      KIND_GREATEST, LEVEL_GREATEST);
        return false;
    }
    if (kind != KIND_RIBBON || level != LEVEL_FULL) {
        session_error(s, message->type, message->request, PROTO_ERROR_NOT_SUPPORTED,
                      "this daemon makes frames of kind 0 (ribbon) and level 0 (full) only");
        return false;
    }
    return true;
}

static void query_advance(session *s, const proto_message *message, resident *r)
{
    forest_input *input = session_input(s, message, FOREST_QUERY);
    if (input) {
        input->as.query_us = message->as.query.time_us;
    }
    if (session_push(s, message, r, input)) {
        s->pending++;
    }
}

void session_query(session *s, const proto_message *message)
{
    const struct proto_query *query = &message->as.query;
    resident *r = session_resident(s, message, query->forest, !query->latest);
    if (!r || !check_kind(s, message, query->kind, query->level)) {
        return;
    }
    if (query->latest) {
        session_frame(s, r->latest, message->request);
    } else {
        query_advance(s, message, r);
    }
}

void session_subscribe(session *s, const proto_message *message)
{
    const struct proto_subscribe *subscribe = &message->as.subscribe;
    resident *r = session_resident(s, message, subscribe->forest, false);
    if (!r || !check_kind(s, message, subscribe->kind, subscribe->level)) {
        return;
    }
    subscription *place = NULL;
    for (uint32_t i = 0; i < LIMIT_SESSION_SUBSCRIPTIONS && !place; i++) {
        place = s->subscriptions[i].handle == 0 ? &s->subscriptions[i] : NULL;
    }
    if (!place) {
        session_error(s, message->type, message->request, PROTO_ERROR_LIMIT,
                      "a connection has %d subscriptions at most", LIMIT_SESSION_SUBSCRIPTIONS);
        return;
    }
    subscription_begin(place, s, r, ++s->subscription_serial, message->request, subscribe->credit,
                       subscribe->greatest_rate);
    proto_message reply = {.type = PROTO_SUBSCRIBE_REPLY, .request = message->request};
    reply.as.subscribe_reply.subscription = place->handle;
    session_send(s, &reply);
}

/* The subscription that the message names; NULL: an ERROR was sent. */
static subscription *find(session *s, const proto_message *message, uint64_t handle)
{
    subscription *sub = session_subscription(s, handle);
    if (!sub) {
        session_error(s, message->type, message->request, PROTO_ERROR_NO_SUBSCRIPTION, NULL);
    }
    return sub;
}

void session_unsubscribe(session *s, const proto_message *message)
{
    subscription *sub = find(s, message, message->as.unsubscribe.subscription);
    if (sub) {
        subscription_end(sub);
    }
}

void session_credit(session *s, const proto_message *message)
{
    subscription *sub = find(s, message, message->as.credit.subscription);
    if (sub) {
        subscription_credit(sub, message->as.credit.frames);
        session_stream(s);
    }
}
