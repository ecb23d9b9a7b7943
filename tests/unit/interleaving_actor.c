/* interleaving_actor.c: see interleaving_actor.h. */
#include "interleaving_actor.h"

#include "base/assert.h"
#include "base/hash.h"
#include "completions.h"
#include "protocol.h"

#include <stdlib.h>
#include <string.h>

enum { ARRIVALS = 4096 };

void stage_expect(stage *s, bool holds, const char *otherwise)
{
    if (!holds && !s->seen.broken) {
        s->seen.broken = otherwise;
    }
}

bool stage_work(stage *s)
{
    const bool any = worker_pool_run_one(s->shared->pool);
    completions_take(s->shared);
    return any;
}

/* ---- what the daemon says ---------------------------------------------------------------------------------------- */

static open_request *find_open(actor *who, uint64_t request)
{
    for (int i = 0; request && i < ACTOR_REQUESTS; i++) {
        if (who->open[i].request == request) {
            return &who->open[i];
        }
    }
    return NULL;
}

static begun_subscription *find_subscription(actor *who, uint64_t request)
{
    for (uint32_t i = 0; i < who->subscription_count; i++) {
        if (who->subscriptions[i].request == request) {
            return &who->subscriptions[i];
        }
    }
    return NULL;
}

static void see_frame(actor *who, begun_subscription *sub, const struct proto_frame *frame)
{
    sub->frames++;
    stage_expect(who->on, sub->handle != 0, "a frame came before its subscription's answer");
    stage_expect(who->on, sub->frames <= sub->credit, "a frame came without credit");
    stage_expect(who->on, frame->sequence > sub->sequence, "a frame came that is not newer than the last one");
    stage_expect(who->on, frame->base < frame->sequence, "a delta stands on a frame that is not older");
    sub->sequence = frame->sequence;
}

static void take_one(open_request *asked)
{
    asked->request = --asked->answers > 0 ? asked->request : 0;
}

static void keep_state(stage *s, proto_blob state)
{
    s->state_size = state.length <= STAGE_STATE ? state.length : 0;
    memcpy(s->state, state.bytes, s->state_size);
}

static void see_answer(actor *who, open_request *asked, const proto_message *message)
{
    stage *s = who->on;
    begun_subscription *sub = find_subscription(who, message->request);
    const uint16_t expected = asked->type == PROTO_QUERY       ? PROTO_FRAME
                              : asked->type == PROTO_STEP_MANY ? PROTO_FRAME
                              : asked->type == PROTO_PING      ? PROTO_PONG
                              : asked->type == PROTO_RESTORE   ? PROTO_CREATE_REPLY
                                                               : asked->type | PROTO_REPLY;
    s->seen.answers++;
    s->seen.restored += asked->type == PROTO_RESTORE;
    s->seen.many += asked->type == PROTO_STEP_MANY;
    s->seen.clocks += asked->type == PROTO_SET_CLOCK;
    stage_expect(s, message->type == expected || (asked->type == PROTO_HELLO && message->type == PROTO_WELCOME),
                 "an answer is not of its request's kind");
    take_one(asked);
    if (message->type == PROTO_CREATE_REPLY) {
        who->mine = s->forests[s->forests_made++ % STAGE_FORESTS] = message->as.create_reply;
    } else if (message->type == PROTO_ATTACH_REPLY) {
        who->mine = who->attaching;
    } else if (message->type == PROTO_WELCOME) {
        memcpy(who->server_nonce, message->as.welcome.nonce, sizeof who->server_nonce);
        memcpy(who->token, message->as.welcome.session, sizeof who->token);
    } else if (message->type == PROTO_RESUME_REPLY && message->as.resume_reply.forests.count > 0) {
        who->mine = (struct proto_create_reply){.forest = message->as.resume_reply.forests.items[0].forest};
    } else if (message->type == PROTO_SUBSCRIBE_REPLY && sub) {
        sub->handle = message->as.subscribe_reply.subscription;
    } else if (message->type == PROTO_SNAPSHOT_REPLY) {
        keep_state(s, message->as.snapshot_reply.state);
    }
}

static void see(actor *who, const proto_message *message)
{
    stage *s = who->on;
    open_request *asked = find_open(who, message->request);
    begun_subscription *sub = find_subscription(who, message->request);
    s->seen.hash = hash_u64(hash_u64(s->seen.hash, message->type), message->request);
    if (message->type == PROTO_ERROR) {
        s->seen.errors++;
        s->seen.hash = hash_u64(s->seen.hash, message->as.error.code);
        stage_expect(s, message->as.error.code != PROTO_ERROR_INTERNAL, "the daemon found a fault of its own");
        if (asked) {
            take_one(asked);
        }
    } else if (asked && message->type != PROTO_PROGRESS) {
        see_answer(who, asked, message);
    } else if (message->type == PROTO_FRAME && sub) {
        s->seen.frames++;
        s->seen.hash = hash_u64(hash_u64(s->seen.hash, message->as.frame.sequence), message->as.frame.glb.length);
        see_frame(who, sub, &message->as.frame);
    } else {
        stage_expect(s,
                     who->garbled || message->type == PROTO_BYE || message->type == PROTO_PING ||
                         (asked && message->type == PROTO_PROGRESS),
                     "an answer came to what was not asked, or twice");
    }
}

static void sink_message(void *context, const proto_message *message)
{
    see(context, message);
}

static void sink_picture(void *context, picture *shown, const view *v, const delivery *to)
{
    proto_message message;
    picture_message(shown, v, to, &message);
    see(context, &message);
    picture_release(shown);
}

static bool sink_drained(void *context)
{
    return !((const actor *)context)->congested;
}

/* ---- connections ------------------------------------------------------------------------------------------------- */

bool actor_is_there(const actor *who)
{
    return who->there;
}

bool actor_is_refused(const actor *who)
{
    return who->talk.state == SESSION_CLOSING;
}

void actor_connect(actor *who, stage *on)
{
    *who = (actor){.on = on, .wire = malloc(ACTOR_WIRE)};
    session_sink sink = {.context = who, .message = sink_message, .picture = sink_picture, .drained = sink_drained};
    ASSERT(who->wire);
    who->there = session_init(&who->talk, on->shared, &sink, "actor");
    if (!who->there) {
        free(who->wire);
    }
}

void actor_cut(actor *who)
{
    if (who->there) {
        who->on->seen.cuts++;
        memcpy(who->on->token, who->token, sizeof who->token);
        session_fini(&who->talk);
        input_fini(&who->in);
        free(who->wire);
        who->there = false;
    }
}

void actor_congest(actor *who, bool congested)
{
    who->congested = congested;
    if (!congested) {
        session_stream(&who->talk);
    }
}

/* As a connection does with what has come. */
static void process(actor *who)
{
    uint16_t done = 0;
    while (who->talk.state != SESSION_CLOSING && who->talk.pending < LIMIT_SESSION_PENDING &&
           protocol_step(&who->talk, &who->in, &done)) {
    }
}

void actor_hear(actor *who, size_t most)
{
    size_t left = who->wire_size < most ? who->wire_size : most;
    process(who);
    for (size_t got = 0; left > 0 && !input_ready(&who->in) && who->talk.state != SESSION_CLOSING; left -= got) {
        unsigned char *room = NULL;
        got = input_room(&who->in, ARRIVALS, &room);
        ASSERT(got > 0);
        got = got < left ? got : left;
        memcpy(room, who->wire, got);
        memmove(who->wire, who->wire + got, who->wire_size - got);
        who->wire_size -= got;
        input_came(&who->in, got);
        process(who);
    }
}

void actor_expect_nothing(const actor *who)
{
    if (!who->there || who->garbled || who->talk.state != SESSION_OPEN) {
        return;
    }
    stage_expect(who->on, who->talk.pending == 0, "a session counts a request as waiting that is not");
    for (int i = 0; i < ACTOR_REQUESTS; i++) {
        stage_expect(who->on, who->open[i].request == 0, "a request was never answered");
    }
}
