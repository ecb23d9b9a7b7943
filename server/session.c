/* session.c: see session.h. */
#include "session.h"
#include "log.h"
#include "metrics.h"
#include "status.h"
#include "turns.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool session_init(session *s, service *shared, const session_sink *sink, const char *peer)
{
    *s = (session){.shared = shared, .sink = *sink, .heard_us = shared->options.clock_us()};
    s->handle = handle_add(&shared->sessions, s);
    if (s->handle == 0) {
        *s = (session){0};
        return false;
    }
    snprintf(s->peer, sizeof s->peer, "%s", peer);
    shared->counters.sessions++;
    metrics_add(METRIC_CONNECTIONS, 1);
    return true;
}

/* Whoever was cut off may come back for what it held; whoever said BYE, or was sent away, has given it up. */
static void leave_holdings(session *s)
{
    const service_options *options = &s->shared->options;
    const int64_t now_us = options->clock_us();
    const uint32_t driven = holdings_driven(&s->holds, &s->shared->forests);
    if (driven > 0) {
        log_write(LOG_INFO, "forests live on", "peer=%s forests=%lu", s->peer, (unsigned long)driven);
    }
    if (s->state == SESSION_OPEN && options->resume_grace_us > 0 && !holdings_are_none(&s->holds)) {
        parking_leave(&s->shared->parked, s->token, &s->holds, &s->shared->forests, now_us,
                      now_us + options->resume_grace_us);
        service_ring_door(s->shared);
    }
    holdings_fini(&s->holds, &s->shared->forests, now_us);
}

static uint32_t subscription_places(const session *s)
{
    return s->subscriptions ? LIMIT_SESSION_SUBSCRIPTIONS : 0;
}

void session_end_subscriptions(session *s)
{
    for (uint32_t i = 0; i < subscription_places(s); i++) {
        if (s->subscriptions[i].handle) {
            subscription_end(&s->subscriptions[i]);
        }
    }
    free(s->subscriptions);
    s->subscriptions = NULL;
}

void session_fini(session *s)
{
    if (!s->shared) {
        return;
    }
    session_end_subscriptions(s);
    promises_free(&s->promised);
    leave_holdings(s);
    handle_remove(&s->shared->sessions, s->handle);
    s->shared->counters.sessions--;
    metrics_add(METRIC_CONNECTIONS, -1);
    *s = (session){0};
}

session *session_find(const service *shared, origin from)
{
    return handle_find(&shared->sessions, from.session);
}

void session_send(session *s, const proto_message *message)
{
    if (s->state != SESSION_CLOSING) {
        s->sink.message(s->sink.context, message);
    }
}

static void send_error(session *s, uint16_t about, uint64_t request, int code, const char *text)
{
    char quoted[LOG_QUOTED];
    log_write(LOG_DEBUG, "error sent", "peer=%s about=%s code=%d text=%s", s->peer,
              about ? proto_type_name(about) : "connection", code, log_quote(text, strlen(text), quoted));
    proto_message message = {.type = PROTO_ERROR, .request = request};
    message.as.error.code = (uint16_t)code;
    message.as.error.retry = proto_error_retry(code);
    message.as.error.retry_after_ms = code != PROTO_ERROR_BUSY ? 0
                                      : s->shared->load.full   ? LIMIT_FULL_RETRY_MS
                                                               : LIMIT_BUSY_RETRY_MS;
    message.as.error.about = about;
    message.as.error.text = proto_str_of(text);
    s->shared->counters.errors_sent++;
    metrics_count_error(code);
    session_send(s, &message);
    if (proto_error_closes(code)) {
        s->state = SESSION_CLOSING;
    }
}

void session_error(session *s, uint16_t about, uint64_t request, int code, const char *format, ...)
{
    char text[240];
    if (!format) {
        send_error(s, about, request, code, proto_error_text(code));
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    send_error(s, about, request, code, text);
}

void session_error_awt(session *s, uint16_t about, uint64_t request, const awt_error *error)
{
    send_error(s, about, request, status_wire_error(error->status), error->text);
}

void session_bye(session *s, const char *reason)
{
    proto_message message = {.type = PROTO_BYE};
    message.as.bye.reason = proto_str_of(reason);
    session_send(s, &message);
    s->state = SESSION_CLOSING;
}

void session_prompt(session *s)
{
    if (s->sink.prompt) {
        s->sink.prompt(s->sink.context);
    }
}

void session_picture(session *s, picture *shown, const view *v, uint64_t request)
{
    if (s->state != SESSION_CLOSING) {
        s->sink.picture(s->sink.context, picture_hold(shown), v, &(delivery){.request = request});
    }
}

void session_stale_picture(session *s, picture *shown, const view *v, uint64_t request)
{
    if (s->state != SESSION_CLOSING) {
        s->sink.picture(s->sink.context, picture_hold(shown), v, &(delivery){.request = request, .stale = true});
    }
}

/* ---- forests of a session --------------------------------------------------------------------------------------- */

bool session_attach(session *s, uint16_t about, uint64_t request, resident *r, bool may_drive)
{
    switch (holdings_open(&s->holds, &s->shared->forests, r, may_drive)) {
    case 0:
        return true;
    case PROTO_ERROR_LIMIT:
        session_error(s, about, request, PROTO_ERROR_LIMIT, "a connection has %d forests open at most; DETACH from one",
                      LIMIT_SESSION_FORESTS);
        return false;
    default:
        session_error(s, about, request, PROTO_ERROR_NO_MEMORY, NULL);
        return false;
    }
}

void session_detach(session *s, uint64_t forest)
{
    holdings_close(&s->holds, &s->shared->forests, forest, s->shared->options.clock_us());
    for (uint32_t i = 0; i < subscription_places(s); i++) {
        subscription *sub = &s->subscriptions[i];
        if (sub->handle && sub->forest->handle == forest) {
            subscription_end(sub);
        }
    }
}

resident *session_resident(session *s, const proto_message *message, uint64_t forest, bool to_drive)
{
    resident *r = registry_find(&s->shared->forests, forest);
    const attachment *open = r ? holdings_find(&s->holds, forest) : NULL;
    if (!r) {
        session_error(s, message->type, message->request, PROTO_ERROR_NO_FOREST, NULL);
    } else if (!open) {
        session_error(s, message->type, message->request, PROTO_ERROR_NOT_ALLOWED,
                      "the forest is not open on this connection: ATTACH to it with one of its tokens first");
    } else if (to_drive && !open->may_drive) {
        session_error(s, message->type, message->request, PROTO_ERROR_NOT_ALLOWED, NULL);
    } else {
        return r;
    }
    return NULL;
}

forest_input *session_input(const session *s, const proto_message *message, forest_input_kind kind)
{
    forest_input *input = calloc(1, sizeof *input);
    if (input) {
        input->kind = kind;
        input->from = (origin){.session = s->handle, .request = message->request};
        input->arrived_us = s->shared->options.clock_us();
    }
    return input;
}

bool session_push(session *s, const proto_message *message, resident *r, forest_input *input)
{
    if (!input) {
        session_error(s, message->type, message->request, PROTO_ERROR_NO_MEMORY, NULL);
        return false;
    }
    if (turns_push(&s->shared->forests, r, input)) {
        return true;
    }
    if (input->kind >= FOREST_QUERY) {
        session_error(s, message->type, message->request, PROTO_ERROR_BUSY, "%d queries wait for this forest already",
                      LIMIT_FOREST_QUERIES);
    } else {
        session_error(s, message->type, message->request, PROTO_ERROR_BUSY,
                      "%d motions and changes of parameters wait for a QUERY that advances the forest",
                      LIMIT_FOREST_INPUTS);
    }
    forest_inputs_free(input);
    return false;
}

/* ---- subscriptions ---------------------------------------------------------------------------------------------- */

subscription *session_subscription_place(session *s)
{
    if (!s->subscriptions) {
        s->subscriptions = calloc(LIMIT_SESSION_SUBSCRIPTIONS, sizeof *s->subscriptions);
    }
    for (uint32_t i = 0; i < subscription_places(s); i++) {
        if (s->subscriptions[i].handle == 0) {
            return &s->subscriptions[i];
        }
    }
    return NULL;
}

subscription *session_subscription(session *s, uint64_t handle)
{
    for (uint32_t i = 0; handle && i < subscription_places(s); i++) {
        if (s->subscriptions[i].handle == handle) {
            return &s->subscriptions[i];
        }
    }
    return NULL;
}

/* The next in turn that may send, with its view, so that no forest starves another on the same connection. */
static subscription *next_due(session *s, int64_t now_us, const view **v)
{
    for (uint32_t n = 0; n < subscription_places(s); n++) {
        uint32_t i = (s->subscription_next + n) % LIMIT_SESSION_SUBSCRIPTIONS;
        subscription *sub = &s->subscriptions[i];
        if (!subscription_is_due(sub, now_us)) {
            continue;
        }
        *v = subscription_view(sub);
        if (*v) {
            s->subscription_next = (i + 1) % LIMIT_SESSION_SUBSCRIPTIONS;
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
        delivery to = {.request = sub->request};
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
    for (uint32_t i = 0; i < subscription_places(s); i++) {
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

/* It is asked after a third of the time that it may be silent. */
static int64_t quiet_due_us(const session *s)
{
    const int64_t quiet_us = s->shared->options.quiet_us;
    return is_watched(s) ? s->heard_us + (s->pinged ? quiet_us : quiet_us / 3) : INT64_MAX;
}

static void watch(session *s, int64_t now_us)
{
    if (now_us < quiet_due_us(s)) {
        return;
    }
    if (s->pinged) {
        session_error(s, 0, 0, PROTO_ERROR_TIMED_OUT, "nothing came for %lld s, not even an answer to PING",
                      (long long)(s->shared->options.quiet_us / 1000000));
        return;
    }
    proto_message ping = {.type = PROTO_PING};
    ping.as.ping.sent_us = now_us;
    s->pinged = true;
    session_send(s, &ping);
}

void session_heard(session *s)
{
    s->heard_us = s->shared->options.clock_us();
    s->pinged = false;
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
