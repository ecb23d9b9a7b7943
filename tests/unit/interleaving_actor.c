/* interleaving_actor.c: see interleaving_actor.h. */
#include "interleaving_actor.h"

#include "base/assert.h"
#include "base/hash.h"
#include "completions.h"
#include "protocol.h"

#include <stdlib.h>
#include <string.h>

enum { STRANDS = 12, WISPS = 3, TOP_WISPS = 1, ARRIVALS = 4096 };

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

static uint32_t decide(const actor *who, uint32_t below)
{
    return who->on->decide(who->on->context, below);
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

static void see_answer(actor *who, open_request *asked, const proto_message *message)
{
    stage *s = who->on;
    begun_subscription *sub = find_subscription(who, message->request);
    const uint16_t expected = asked->type == PROTO_QUERY     ? PROTO_FRAME
                              : asked->type == PROTO_PING    ? PROTO_PONG
                              : asked->type == PROTO_RESTORE ? PROTO_CREATE_REPLY
                                                             : asked->type | PROTO_REPLY;
    s->seen.answers++;
    stage_expect(s, message->type == expected || (asked->type == PROTO_HELLO && message->type == PROTO_WELCOME),
                 "an answer is not of its request's kind");
    asked->request = 0;
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
            asked->request = 0;
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

/* ---- what is said ------------------------------------------------------------------------------------------------ */

static open_request *free_open(actor *who)
{
    for (int i = 0; i < ACTOR_REQUESTS; i++) {
        if (who->open[i].request == 0) {
            return &who->open[i];
        }
    }
    return NULL;
}

static void put(actor *who, proto_message *message, bool answered)
{
    const size_t size = proto_encoded_size(message);
    open_request *place = answered ? free_open(who) : NULL;
    ASSERT(size > 0);
    if (size > ACTOR_WIRE - who->wire_size || (answered && !place)) {
        return;
    }
    message->request = ++who->last_request;
    message->flags = PROTO_FLAG_REQUIRED;
    who->wire_size += proto_encode(message, who->wire + who->wire_size, ACTOR_WIRE - who->wire_size);
    who->on->seen.sent++;
    if (answered) {
        *place = (open_request){message->request, message->type};
    }
}

void actor_say_garbage(actor *who)
{
    const uint32_t size = decide(who, 64);
    if (size > ACTOR_WIRE - who->wire_size) {
        return;
    }
    who->garbled = true;
    for (uint32_t i = 0; i < size; i++) {
        who->wire[who->wire_size++] = (unsigned char)decide(who, 256);
    }
}

/* Mostly the one that it opened last, else one of those that were made last, or one that never was. */
static const struct proto_create_reply *some_forest(const actor *who)
{
    static const struct proto_create_reply never = {.forest = UINT64_C(0x7700000001)};
    const uint32_t known = who->on->forests_made < STAGE_FORESTS ? who->on->forests_made : STAGE_FORESTS;
    if (who->mine.forest != 0 && decide(who, 8) != 0) {
        return &who->mine;
    }
    return known > 0 && decide(who, 8) != 0 ? &who->on->forests[decide(who, known)] : &never;
}

static void say_hello(actor *who)
{
    proto_message message = fake_hello();
    put(who, &message, true);
}

static void say_auth(actor *who)
{
    proto_message message = {.type = PROTO_AUTH};
    struct proto_auth *auth = &message.as.auth;
    memset(auth->nonce, (int)decide(who, 256), sizeof auth->nonce);
    auth_client_proof(fake_token, who->server_nonce, auth->nonce, auth->proof);
    auth->proof[0] ^= (uint8_t)(decide(who, 16) == 0);
    put(who, &message, true);
}

/* The session that was cut off last. */
static void say_resume(actor *who)
{
    proto_message message = {.type = PROTO_RESUME};
    memcpy(message.as.resume.session, who->on->token, sizeof who->on->token);
    put(who, &message, true);
}

static void say_create(actor *who)
{
    proto_message message = fake_create(decide(who, 3));
    message.as.create.strands = STRANDS;
    message.as.create.finest_wisps = WISPS;
    message.as.create.top_wisps = TOP_WISPS;
    message.as.create.progress = (uint8_t)decide(who, 2);
    if (decide(who, 4) == 0) {
        message.as.create.source = 1;
        message.as.create.upload = decide(who, 3);
    }
    put(who, &message, true);
}

static void say_upload(actor *who)
{
    static const unsigned char piece[256] = {'H', 'A', 'I', 'R'};
    proto_message message = {.type = PROTO_UPLOAD};
    struct proto_upload *said = &message.as.upload;
    said->upload = decide(who, 3);
    said->total = 256 * (uint64_t)decide(who, 4);
    said->offset = 256 * (uint64_t)decide(who, 4);
    said->piece = (proto_blob){piece, decide(who, 2) ? 256 : decide(who, 257)};
    put(who, &message, true);
}

static void say_attach(actor *who)
{
    const struct proto_create_reply *forest = some_forest(who);
    proto_message message = {.type = PROTO_ATTACH};
    message.as.attach.forest = forest->forest;
    memcpy(message.as.attach.token, decide(who, 2) ? forest->drive_token : forest->view_token,
           sizeof message.as.attach.token);
    message.as.attach.token[3] ^= (uint8_t)(decide(who, 32) == 0);
    who->attaching = *forest;
    put(who, &message, true);
}

/* Mostly later than all before. */
static int64_t some_time_us(actor *who)
{
    stage *s = who->on;
    if (decide(who, 8) == 0) {
        return 1000 * (int64_t)decide(who, 4000);
    }
    s->time_us += 1000 * (int64_t)decide(who, 30);
    return s->time_us;
}

static void say_motion(actor *who)
{
    const int64_t time_us = some_time_us(who);
    proto_message message = fake_motion(some_forest(who)->forest, ++who->on->motions, time_us);
    message.as.motion.teleport = (uint8_t)(decide(who, 8) == 0);
    put(who, &message, false);
}

static void say_query(actor *who)
{
    const int64_t time_us = some_time_us(who);
    proto_message message = fake_query(some_forest(who)->forest, time_us);
    message.as.query.latest = (uint8_t)decide(who, 2);
    message.as.query.kind = (uint8_t)decide(who, 5);
    message.as.query.level = (uint8_t)(decide(who, 4) == 0);
    put(who, &message, true);
}

static void say_subscribe(actor *who)
{
    proto_message message = {.type = PROTO_SUBSCRIBE};
    struct proto_subscribe *subscribe = &message.as.subscribe;
    if (who->subscription_count == ACTOR_SUBSCRIPTIONS) {
        return;
    }
    subscribe->forest = some_forest(who)->forest;
    subscribe->kind = (uint8_t)decide(who, 4);
    subscribe->credit = decide(who, 3);
    subscribe->deltas = (uint8_t)decide(who, 2);
    subscribe->budget = decide(who, 4) == 0 ? 1000 : 0;
    subscribe->greatest_rate = (uint16_t)(decide(who, 4) == 0 ? 10 : 0);
    const uint64_t before = who->last_request;
    put(who, &message, true);
    if (who->last_request > before) {
        who->subscriptions[who->subscription_count++] =
            (begun_subscription){.request = who->last_request, .credit = subscribe->credit};
    }
}

/* Of a subscription that it has begun, if any. */
static begun_subscription *some_subscription(actor *who)
{
    return who->subscription_count > 0 ? &who->subscriptions[decide(who, who->subscription_count)] : NULL;
}

static void say_credit(actor *who)
{
    begun_subscription *sub = some_subscription(who);
    proto_message message = {.type = PROTO_CREDIT};
    message.as.credit.frames = decide(who, 3);
    if (sub) {
        message.as.credit.subscription = sub->handle;
        message.as.credit.have = decide(who, 4) ? sub->sequence : 0;
        sub->credit += message.as.credit.frames;
    }
    put(who, &message, false);
}

static void say_of_forest(actor *who)
{
    proto_message message = {0};
    const uint64_t forest = some_forest(who)->forest;
    switch (decide(who, 8)) {
    case 3:
        message.type = PROTO_SNAPSHOT;
        message.as.snapshot.forest = forest;
        break;
    case 4:
        message.type = PROTO_RESTORE;
        message.as.restore.upload = decide(who, 3);
        break;
    case 0:
        message.type = PROTO_DESTROY;
        message.as.destroy.forest = forest;
        break;
    case 1:
        message.type = PROTO_DETACH;
        message.as.detach.forest = forest;
        break;
    case 2:
        message.type = PROTO_BINDING;
        message.as.binding.forest = forest;
        break;
    default:
        message.type = PROTO_SET_PARAMS;
        message.as.set_params.forest = forest;
        message.as.set_params.params.count = 1;
        message.as.set_params.params.items[0].name = proto_str_of(decide(who, 4) ? "wind_x" : "windy");
        message.as.set_params.params.items[0].value = (float)decide(who, 5);
    }
    put(who, &message, message.type != PROTO_DETACH);
}

static void say_small(actor *who)
{
    static const uint16_t types[] = {PROTO_PING, PROTO_STATS, PROTO_LIST, PROTO_LIST_STYLES};
    proto_message message = {.type = types[decide(who, sizeof types / sizeof types[0])]};
    put(who, &message, true);
}

/* What ends the connection. */
static void say_last(actor *who)
{
    proto_message message = {.type = PROTO_BYE};
    switch (decide(who, 8)) {
    case 0:
        say_hello(who);
        break;
    case 1:
        say_auth(who);
        break;
    case 2:
        put(who, &message, false);
        break;
    default:
        say_small(who);
    }
}

static void say_unsubscribe(actor *who)
{
    const begun_subscription *sub = some_subscription(who);
    proto_message message = {.type = PROTO_UNSUBSCRIBE};
    message.as.unsubscribe.subscription = sub ? sub->handle : 1;
    put(who, &message, false);
}

void actor_say(actor *who)
{
    static void (*const sayings[])(actor *) = {say_create,    say_create, say_upload, say_attach,    say_attach,
                                               say_motion,    say_motion, say_query,  say_query,     say_query,
                                               say_credit,    say_credit, say_credit, say_credit,    say_subscribe,
                                               say_subscribe, say_small,  say_last,   say_of_forest, say_unsubscribe};
    enum { SAYINGS = sizeof sayings / sizeof sayings[0] };
    const bool at_door = who->talk.state < SESSION_OPEN && who->wire_size == 0;
    const uint32_t n = decide(who, SAYINGS + 4);
    if (at_door && n < SAYINGS) { /* else hardly anyone would come in, */
        (who->talk.state == SESSION_GREETING ? say_hello : say_auth)(who);
    } else if (who->mine.forest == 0 && n < SAYINGS) { /* or have a forest, */
        (n % 4 == 0 ? say_create : n % 4 == 1 ? say_resume : say_attach)(who);
    } else if (who->subscription_count == 0 && n < SAYINGS / 4) { /* or look at it */
        say_subscribe(who);
    } else if (n < SAYINGS) {
        sayings[n](who);
    } else {
        say_query(who);
    }
}
