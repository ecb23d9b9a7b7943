/* session_stream.c: what a session sends without being asked at that moment: frames of its subscriptions, PING to a
 * client that is silent, and what was promised by a deadline. */
#include "session.h"
#include "clock.h"
#include "metrics.h"
#include "turns.h"

#include <stdlib.h>

/* ---- subscriptions ---------------------------------------------------------------------------------------------- */

void session_end_subscriptions(session *s)
{
    for (uint32_t i = 0; i < s->subscription_top; i++) {
        if (s->subscriptions[i].handle) {
            subscription_end(&s->subscriptions[i]);
        }
    }
    free(s->subscriptions);
    s->subscriptions = NULL;
    s->subscription_top = 0;
}

void session_end_subscriptions_on(session *s, uint64_t forest)
{
    for (uint32_t i = 0; i < s->subscription_top; i++) {
        subscription *sub = &s->subscriptions[i];
        if (sub->handle && sub->forest->handle == forest) {
            subscription_end(sub);
        }
    }
}

subscription *session_subscription_place(session *s)
{
    if (!s->subscriptions) {
        s->subscriptions = calloc(LIMIT_SESSION_SUBSCRIPTIONS, sizeof *s->subscriptions);
    }
    for (uint32_t i = 0; s->subscriptions && i < LIMIT_SESSION_SUBSCRIPTIONS; i++) {
        if (s->subscriptions[i].handle == 0) {
            s->subscription_top = i < s->subscription_top ? s->subscription_top : i + 1;
            return &s->subscriptions[i];
        }
    }
    return NULL;
}

subscription *session_subscription(session *s, uint64_t handle)
{
    for (uint32_t i = 0; handle && i < s->subscription_top; i++) {
        if (s->subscriptions[i].handle == handle) {
            return &s->subscriptions[i];
        }
    }
    return NULL;
}

/* The next in turn that may send, with its view, so that no forest starves another on the same connection. */
static subscription *next_due(session *s, int64_t now_us, const view **v)
{
    for (uint32_t n = 0; n < s->subscription_top; n++) {
        uint32_t i = (s->subscription_next + n) % s->subscription_top;
        subscription *sub = &s->subscriptions[i];
        if (!subscription_is_due(sub, now_us)) {
            continue;
        }
        *v = subscription_view(sub);
        if (*v) {
            s->subscription_next = (i + 1) % s->subscription_top;
            return sub;
        }
        if (subscription_asks(sub)) {
            turns_redraw(&s->shared->forests, sub->forest, now_us);
        }
    }
    return NULL;
}

static void stream(session *s, int64_t now_us)
{
    while (s->state == SESSION_OPEN && s->sink.drained(s->sink.context)) {
        const view *v = NULL;
        subscription *sub = next_due(s, now_us, &v);
        if (!sub) {
            return;
        }
        delivery to = {.request = sub->request, .stale = turns_is_late(sub->forest, now_us)};
        metrics_count(METRIC_FRAMES_STALE, to.stale);
        picture *shown = subscription_take(sub, v, now_us, &to.skipped);
        s->sink.picture(s->sink.context, shown, v, &to);
    }
}

void session_stream(session *s)
{
    if (!s->subscriptions) {
        return;
    }
    stream(s, s->shared->options.clock_us());
    if (s->sink.touched) {
        s->sink.touched(s->sink.context);
    }
}

/* ---- the clock --------------------------------------------------------------------------------------------------- */

static int64_t stream_due_us(const session *s)
{
    int64_t due_us = INT64_MAX;
    for (uint32_t i = 0; i < s->subscription_top; i++) {
        const subscription *sub = &s->subscriptions[i];
        if (sub->handle && sub->waiting && sub->credit > 0 && sub->due_us < due_us && subscription_view(sub)) {
            due_us = sub->due_us;
        }
    }
    return due_us;
}

/* A client of which nothing is awaited but a sign of life: what it sent has been read, what it asked is answered. */
static bool is_watched(const session *s)
{
    return s->state == SESSION_OPEN && s->shared->options.quiet_us > 0 && s->pending == 0;
}

/* It is asked after a third of the time that it may be silent, and has the rest to answer. */
static int64_t quiet_due_us(const session *s)
{
    const int64_t quiet_us = s->shared->options.quiet_us, ask_us = quiet_us / 3;
    return !is_watched(s) ? INT64_MAX : s->pinged_us ? s->pinged_us + quiet_us - ask_us : s->heard_us + ask_us;
}

static void watch(session *s, int64_t now_us)
{
    if (now_us < quiet_due_us(s)) {
        return;
    }
    const int64_t quiet_us = s->shared->options.quiet_us;
    if (s->pinged_us && clock_is_over(&s->pinged_us, quiet_us - quiet_us / 3, now_us)) {
        s->vanished = true;
        session_error(s, 0, 0, PROTO_ERROR_TIMED_OUT, "nothing came for %lld s, not even an answer to PING",
                      (long long)(quiet_us / 1000000));
        return;
    }
    proto_message ping = {.type = PROTO_PING};
    ping.as.ping.sent_us = now_us;
    s->pinged_us = now_us;
    session_send(s, &ping);
}

void session_heard(session *s)
{
    s->heard_us = s->shared->options.clock_us();
    s->pinged_us = 0;
    if (s->who) {
        account_count_message(s->who, s->heard_us);
    }
}

int64_t session_free_us(const session *s)
{
    return s->who ? account_free_us(s->who) : INT64_MIN;
}

/* Answers what was promised for now with what there is; the steps go on. */
static void break_promises(session *s, int64_t now_us)
{
    for (promise late; promises_break(&s->promised, now_us, &late);) {
        const resident *r = registry_find(&s->shared->forests, late.forest);
        const view *v = r ? picture_view(r->latest, (view_name){.form = late.form}) : NULL;
        s->pending--;
        if (v) {
            session_stale_picture(s, r->latest, v, late.request);
        } else {
            session_error(s, PROTO_STEP_MANY, late.request, PROTO_ERROR_BUSY,
                          "the deadline has passed, and of no step there is a frame of that kind yet");
        }
    }
}

void session_tick(session *s)
{
    const int64_t now_us = s->shared->options.clock_us();
    watch(s, now_us);
    break_promises(s, now_us);
    session_stream(s);
}

int64_t session_due_us(const session *s)
{
    const int64_t stream_us = stream_due_us(s), quiet_us = quiet_due_us(s), promised_us = promises_due_us(s->promised);
    const int64_t own_us = stream_us < quiet_us ? stream_us : quiet_us;
    return own_us < promised_us ? own_us : promised_us;
}
