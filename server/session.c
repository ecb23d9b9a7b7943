/* session.c: see session.h. */
#include "session.h"
#include "load_watch.h"
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

/* Whoever was cut off, or fell silent, may come back for what it held; whoever said BYE, or was sent away, has given it
 * up. */
bool session_is_resumable(const session *s)
{
    return s->state == SESSION_OPEN || s->vanished;
}

static void leave_holdings(session *s)
{
    const service_options *options = &s->shared->options;
    const int64_t now_us = options->clock_us();
    const uint32_t driven = holdings_driven(&s->holds, &s->shared->forests);
    if (driven > 0) {
        log_write(LOG_INFO, "forests live on", "peer=%s forests=%lu", s->peer, (unsigned long)driven);
    }
    if (session_is_resumable(s) && options->resume_grace_us > 0 && !holdings_are_none(&s->holds)) {
        parking_leave(&s->shared->parked, s->token, &s->holds, &s->shared->forests, now_us,
                      now_us + options->resume_grace_us);
        service_ring_door(s->shared);
    }
    holdings_fini(&s->holds, &s->shared->forests, now_us);
}

void session_fini(session *s)
{
    if (!s->shared) {
        return;
    }
    session_end_subscriptions(s);
    promises_free(&s->promised);
    leave_holdings(s);
    if (s->who) {
        s->who->connections--;
    }
    handle_remove(&s->shared->sessions, s->handle);
    s->shared->counters.sessions--;
    metrics_add(METRIC_CONNECTIONS, -1);
    *s = (session){0};
}

bool session_enter(session *s, uint16_t about, uint64_t request, account *who)
{
    if (who->connections >= who->is.caps.connections) {
        session_error(s, about, request, PROTO_ERROR_LIMIT, "this token has %lu connections, and that is its limit",
                      (unsigned long)who->connections);
        s->state = SESSION_CLOSING;
        return false;
    }
    log_write(LOG_DEBUG, "let in", "peer=%s account=%s", s->peer, who->is.name);
    who->connections++;
    s->who = who;
    s->state = SESSION_OPEN;
    return true;
}

void sessions_end_closed(service *shared)
{
    for (uint32_t i = 0; i < shared->sessions.capacity; i++) {
        session *s = handle_at(&shared->sessions, i);
        if (s && s->who && !s->who->open && s->state != SESSION_CLOSING) {
            session_bye(s, "this token is taken back");
        }
    }
}

bool session_may_drive(session *s, const proto_message *message)
{
    if (s->who->is.caps.views_only) {
        session_error(s, message->type, message->request, PROTO_ERROR_NOT_ALLOWED,
                      "this token only lets look at forests");
    }
    return !s->who->is.caps.views_only;
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

static void end_listening(session *s)
{
    s->state = SESSION_CLOSING;
    if (s->sink.touched) {
        s->sink.touched(s->sink.context);
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
        end_listening(s);
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
    end_listening(s);
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
        metrics_count(METRIC_FRAMES_STALE, 1);
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

bool session_make(session *s, const proto_message *message, recipe *making)
{
    const origin from = {.session = s->handle, .request = message->request};
    awt_error error = {0};
    if (load_watch_is_full(s->shared)) {
        recipe_destroy(making);
        session_error(s, message->type, message->request, PROTO_ERROR_BUSY,
                      "the forests here are more than the workers can keep up with");
        return false;
    }
    if (registry_create(&s->shared->forests, making, from, s->who, s->shared->options.clock_us(), &error) != AWT_OK) {
        session_error_awt(s, message->type, message->request, &error);
        return false;
    }
    s->pending++;
    return true;
}

void session_detach(session *s, uint64_t forest)
{
    holdings_close(&s->holds, &s->shared->forests, forest, s->shared->options.clock_us());
    session_end_subscriptions_on(s, forest);
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
