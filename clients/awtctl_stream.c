/* awtctl_stream.c: how awtctl play gets its frames. Whole ones answer its QUERYs. Deltas, and levels within a budget,
 * come by a subscription, which alone knows what has been acknowledged and how large frames were: then a QUERY of the
 * kind of the fewest bytes drives the forest, and the frame follows its answer. */
#include "awtctl_play.h"

#include "geom/receive.h"

#include <time.h>

enum { STREAM_BUSY_TRIES = 100, STREAM_BUSY_LEAST_MS = 20, STREAM_BUSY_MOST_MS = 2000 };

static bool is_subscribed(const play_plan *plan)
{
    return plan->deltas || plan->budget > 0;
}

static bool subscribe(awtclient *client, const play_plan *plan, uint64_t forest, play_stream *s)
{
    awtclient_error error;
    proto_message request = {.type = PROTO_SUBSCRIBE}, answer;
    request.as.subscribe.forest = forest;
    request.as.subscribe.kind = plan->kind;
    request.as.subscribe.level = plan->level;
    request.as.subscribe.credit = 1;
    request.as.subscribe.deltas = plan->deltas;
    request.as.subscribe.budget = (uint32_t)plan->budget;
    request.as.subscribe.attributes = plan->attributes;
    if (!awtclient_call(client, &request, &answer, &error)) {
        awtctl_failed("%s", error.text);
        return false;
    }
    s->request = request.request;
    s->subscription = answer.as.subscribe_reply.subscription;
    return true;
}

static bool get_binding(awtclient *client, const play_plan *plan, uint64_t forest, play_stream *s)
{
    awtclient_error error;
    awt_error why;
    proto_message request = {.type = PROTO_BINDING}, answer;
    request.as.binding.forest = forest;
    request.as.binding.level = plan->level;
    if (!awtclient_call(client, &request, &answer, &error)) {
        awtctl_failed("%s", error.text);
        return false;
    }
    const proto_blob *bytes = &answer.as.binding_reply.binding;
    if (geom_binding_read(bytes->bytes, bytes->length, &s->binding, &why) != AWT_OK) {
        awtctl_failed("the binding: %s", why.text);
        return false;
    }
    return true;
}

bool play_stream_open(awtclient *client, const play_plan *plan, uint64_t forest, play_stream *s)
{
    *s = (play_stream){.client = client, .plan = plan, .forest = forest, .ring = framering_create()};
    if (!s->ring) {
        awtctl_failed("not enough memory");
        return false;
    }
    return (!is_subscribed(plan) || subscribe(client, plan, forest, s)) &&
           (plan->kind != GEOM_GUIDES || get_binding(client, plan, forest, s));
}

void play_stream_close(play_stream *s)
{
    framering_destroy(s->ring);
    geom_binding_destroy(s->binding);
    *s = (play_stream){0};
}

/* ---- frames ------------------------------------------------------------------------------------------------------ */

static void wait_ms(uint32_t ms)
{
    ms = ms < STREAM_BUSY_LEAST_MS ? STREAM_BUSY_LEAST_MS : ms > STREAM_BUSY_MOST_MS ? STREAM_BUSY_MOST_MS : ms;
    struct timespec wait = {ms / 1000, (long)(ms % 1000) * 1000000};
    nanosleep(&wait, NULL);
}

/* The hair at that time. A daemon that has too much to do is asked again. */
static bool query(play_stream *s, int64_t time_us, proto_message *answer, awtclient_error *error)
{
    for (int tries = 0; tries < STREAM_BUSY_TRIES; tries++) {
        proto_message request = {.type = PROTO_QUERY};
        request.as.query.forest = s->forest;
        request.as.query.time_us = time_us;
        request.as.query.kind = is_subscribed(s->plan) ? GEOM_NODES : s->plan->kind;
        request.as.query.level = is_subscribed(s->plan) ? 0 : s->plan->level;
        request.as.query.attributes = !is_subscribed(s->plan) && s->plan->attributes;
        if (awtclient_call(s->client, &request, answer, error)) {
            return true;
        }
        if (error->code != PROTO_ERROR_BUSY) {
            return false;
        }
        wait_ms(error->retry_after_ms);
    }
    return false;
}

/* The next message of the subscription. */
static bool receive(play_stream *s, proto_message *frame, awtclient_error *error)
{
    do {
        if (!awtclient_receive(s->client, frame, error)) {
            return false;
        }
        if (frame->type == PROTO_ERROR) {
            error->code = frame->as.error.code;
            proto_str_copy(frame->as.error.text, error->text, sizeof error->text);
            return false;
        }
    } while (frame->type != PROTO_FRAME || frame->request != s->request);
    return true;
}

bool play_stream_ask(play_stream *s, int64_t time_us, proto_message *frame, uint32_t *last_write_us,
                     awtclient_error *error)
{
    if (!query(s, time_us, frame, error)) {
        return false;
    }
    *last_write_us = frame->as.frame.last_write_us;
    return !is_subscribed(s->plan) || receive(s, frame, error);
}

/* What is no hair is read, to see whether it can be. */
static awt_status read_nodes(const struct proto_frame *frame, awt_error *error)
{
    geom_nodes nodes = {0};
    awt_status status = geom_read_nodes(frame->glb.bytes, frame->glb.length, &nodes, error);
    if (status == AWT_OK) {
        geom_nodes_fini(&nodes);
    }
    return status;
}

awt_status play_stream_read(play_stream *s, const struct proto_frame *frame, const geom_strands **strands,
                            awt_error *error)
{
    *strands = NULL;
    return frame->kind == GEOM_NODES ? read_nodes(frame, error)
                                     : framering_take(s->ring, frame, s->binding, strands, error);
}

bool play_stream_credit(play_stream *s, awtclient_error *error)
{
    proto_message credit = {.type = PROTO_CREDIT};
    credit.as.credit.subscription = s->subscription;
    credit.as.credit.frames = 1;
    credit.as.credit.have = framering_newest(s->ring);
    return !is_subscribed(s->plan) || awtclient_send(s->client, &credit, error);
}
