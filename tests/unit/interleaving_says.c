/* interleaving_says.c: what a client of an interleaving says (interleaving_actor.h): whatever one might, in any order.
 */
#include "interleaving_says.h"

/* Mostly later than all before. */
static int64_t some_time_us(actor *who)
{
    stage *s = who->on;
    if (actor_decide(who, 8) == 0) {
        return 1000 * (int64_t)actor_decide(who, 4000);
    }
    s->time_us += 1000 * (int64_t)actor_decide(who, 30);
    return s->time_us;
}

static void say_motion(actor *who)
{
    const int64_t time_us = some_time_us(who);
    proto_message message = fake_motion(actor_some_forest(who)->forest, ++who->on->motions, time_us);
    message.as.motion.teleport = (uint8_t)(actor_decide(who, 8) == 0);
    actor_put(who, &message, 0);
}

static void say_query(actor *who)
{
    const int64_t time_us = some_time_us(who);
    proto_message message = fake_query(actor_some_forest(who)->forest, time_us);
    message.as.query.latest = (uint8_t)actor_decide(who, 2);
    message.as.query.kind = (uint8_t)actor_decide(who, 5);
    message.as.query.level = (uint8_t)(actor_decide(who, 4) == 0);
    actor_put(who, &message, 1);
}

/* Of several forests, or of one twice. */
static void say_many(actor *who)
{
    proto_message message = {.type = PROTO_STEP_MANY};
    struct proto_step_many *many = &message.as.step_many;
    many->deadline_us = 1000 * actor_decide(who, 100);
    many->kind = (uint8_t)actor_decide(who, 5);
    many->forests.count = (uint16_t)actor_decide(who, 4);
    for (uint16_t i = 0; i < many->forests.count; i++) {
        many->forests.items[i] = (struct proto_step_request){actor_some_forest(who)->forest, some_time_us(who)};
    }
    actor_put(who, &message, many->forests.count > 0 && many->kind <= FORM_KIND_GREATEST ? many->forests.count : 1);
}

static void say_clock(actor *who)
{
    static const float rates[] = {1, 0.25f, 10, 0};
    proto_message message = {.type = PROTO_SET_CLOCK};
    message.as.set_clock.forest = actor_some_forest(who)->forest;
    message.as.set_clock.mode = (uint8_t)actor_decide(who, 4); /* one more than there are */
    message.as.set_clock.rate = rates[actor_decide(who, sizeof rates / sizeof rates[0])];
    message.as.set_clock.importance = (float)actor_decide(who, 3);
    actor_put(who, &message, 1);
}

static void say_subscribe(actor *who)
{
    proto_message message = {.type = PROTO_SUBSCRIBE};
    struct proto_subscribe *subscribe = &message.as.subscribe;
    if (who->subscription_count == ACTOR_SUBSCRIPTIONS) {
        return;
    }
    subscribe->forest = actor_some_forest(who)->forest;
    subscribe->kind = (uint8_t)actor_decide(who, 4);
    subscribe->credit = actor_decide(who, 3);
    subscribe->deltas = (uint8_t)actor_decide(who, 2);
    subscribe->budget = actor_decide(who, 4) == 0 ? 1000 : 0;
    subscribe->greatest_rate = (uint16_t)(actor_decide(who, 4) == 0 ? 10 : 0);
    const uint64_t before = who->last_request;
    actor_put(who, &message, 1);
    if (who->last_request > before) {
        who->subscriptions[who->subscription_count++] =
            (begun_subscription){.request = who->last_request, .credit = subscribe->credit};
    }
}

/* Of a subscription that it has begun, if any. */
static begun_subscription *some_subscription(actor *who)
{
    return who->subscription_count > 0 ? &who->subscriptions[actor_decide(who, who->subscription_count)] : NULL;
}

static void say_credit(actor *who)
{
    begun_subscription *sub = some_subscription(who);
    proto_message message = {.type = PROTO_CREDIT};
    message.as.credit.frames = actor_decide(who, 3);
    if (sub) {
        message.as.credit.subscription = sub->handle;
        message.as.credit.have = actor_decide(who, 4) ? sub->sequence : 0;
        sub->credit += message.as.credit.frames;
    }
    actor_put(who, &message, 0);
}

static void say_of_forest(actor *who)
{
    proto_message message = {0};
    const uint64_t forest = actor_some_forest(who)->forest;
    switch (actor_decide(who, 8)) {
    case 3:
    case 4:
        message.type = PROTO_SNAPSHOT;
        message.as.snapshot.forest = forest;
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
        message.as.set_params.params.items[0].name = proto_str_of(actor_decide(who, 4) ? "wind_x" : "windy");
        message.as.set_params.params.items[0].value = (float)actor_decide(who, 5);
    }
    actor_put(who, &message, message.type == PROTO_DETACH ? 0 : 1);
}

static void say_small(actor *who)
{
    static const uint16_t types[] = {PROTO_PING, PROTO_STATS, PROTO_LIST, PROTO_LIST_STYLES};
    proto_message message = {.type = types[actor_decide(who, sizeof types / sizeof types[0])]};
    actor_put(who, &message, 1);
}

/* What ends the connection. */
static void say_last(actor *who)
{
    proto_message message = {.type = PROTO_BYE};
    switch (actor_decide(who, 8)) {
    case 0:
        say_hello(who);
        break;
    case 1:
        say_auth(who);
        break;
    case 2:
        actor_put(who, &message, 0);
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
    actor_put(who, &message, 0);
}

void actor_say(actor *who)
{
    static void (*const sayings[])(actor *) = {
        say_create,    say_create,    say_upload, say_attach, say_attach,    say_motion,      say_motion,
        say_query,     say_query,     say_query,  say_credit, say_credit,    say_credit,      say_credit,
        say_subscribe, say_subscribe, say_small,  say_last,   say_of_forest, say_unsubscribe, say_hair,
        say_restore,   say_restore,   say_many,   say_many,   say_clock};
    enum { SAYINGS = sizeof sayings / sizeof sayings[0] };
    const bool at_door = who->talk.state < SESSION_OPEN && who->wire_size == 0;
    const uint32_t n = actor_decide(who, SAYINGS + 4);
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
