/* awtsession.c: see awtsession.h. The link is made anew for every connection; what outlives it is here, what happens
 * between a new link and an open session is awtsession_return.c's, and which forests there are is sessionbook.c's. */
#include "awtsession_parts.h"

#include <stdlib.h>
#include <string.h>

/* ---- losing --------------------------------------------------------------------------------------------------- */

static bool may_help(const awtclient_error *why)
{
    return why->retry || why->code == AWTCLIENT_CLOSED || why->code == AWTCLIENT_TIMEOUT;
}

void session_lose(awtsession *s, const awtclient_error *why)
{
    const bool was_open = s->state == SESSION_OPEN;
    awtlink_drop(s->link);
    s->link = NULL;
    s->why = *why;
    s->loss_to_tell = s->loss_to_tell || was_open;
    s->resume_request = s->ping_request = 0;
    sessionbook_lost(&s->book, was_open);
    if (was_open) {
        s->since_us = s->now_us;
        s->waits.tries = 0;
    }
    const int64_t patience_us = (int64_t)s->patience_ms * 1000;
    const bool over = patience_us < 0 || (patience_us > 0 && s->now_us - s->since_us >= patience_us);
    s->state = over || !may_help(why) ? SESSION_LOST : SESSION_AWAY;
    s->again_us = s->now_us + backoff_failed(&s->waits, why->retry_after_ms);
}

/* ---- connecting ----------------------------------------------------------------------------------------------- */

static void connect_anew(awtsession *s)
{
    awtclient_error why = {.code = 0};
    s->state = SESSION_CONNECTING;
    s->link = sessionoptions_connect(&s->options, s->now_us, &why);
    if (!s->link) {
        session_lose(s, &why);
    }
}

/* Half of the timeout passed in silence: is anybody there? A request without an answer in time ends the connection. */
static int64_t ping_due_us(const awtsession *s)
{
    const int timeout_ms = s->options.given.link.timeout_ms;
    const bool watches = s->state == SESSION_OPEN && s->options.given.patience_ms >= 0 && s->ping_request == 0;
    return watches ? awtlink_received_us(s->link) + (int64_t)timeout_ms * 500 : INT64_MAX;
}

static void look_alive(awtsession *s)
{
    proto_message ping = {.type = PROTO_PING};
    ping.as.ping.sent_us = s->now_us;
    awtclient_error why;
    if (s->now_us >= ping_due_us(s) && awtlink_queue(s->link, &ping, &why)) {
        s->ping_request = ping.request;
    }
}

bool awtsession_pump(awtsession *s, int64_t now_us, awtclient_error *error)
{
    awtclient_error why;
    s->now_us = now_us;
    if (s->state == SESSION_AWAY && now_us >= s->again_us) {
        connect_anew(s);
    }
    if (s->link && !awtlink_pump(s->link, now_us, &why)) {
        session_lose(s, &why);
    }
    if (s->state == SESSION_CONNECTING && awtlink_ready(s->link)) {
        session_arrive(s);
    }
    if (s->state == SESSION_OPEN) {
        look_alive(s);
    }
    return s->state != SESSION_LOST || s->loss_to_tell || awtcodec_pass(error, &s->why);
}

/* ---- messages ------------------------------------------------------------------------------------------------- */

awtsession_news awtsession_next(awtsession *s, proto_message *message, awtclient_error *error)
{
    awtclient_error why = {.code = 0};
    while (s->link && awtlink_next(s->link, message, &why)) {
        if (!session_take_own(s, message)) {
            return AWTSESSION_MESSAGE;
        }
    }
    if (s->link && why.code != 0) {
        session_lose(s, &why);
    }
    if (s->loss_to_tell) {
        s->loss_to_tell = false;
        awtcodec_pass(error, &s->why);
        return AWTSESSION_LOST;
    }
    return session_has_returned(s) ? AWTSESSION_OPENED : AWTSESSION_NOTHING;
}

bool awtsession_queue(awtsession *s, proto_message *message, awtclient_error *error)
{
    if (s->state == SESSION_LOST) {
        return awtcodec_pass(error, &s->why);
    }
    if (s->state != SESSION_OPEN) {
        awtcodec_fail(error, AWTCLIENT_FULL, "%s cannot be sent now: the daemon is not reached yet",
                      proto_type_name(message->type));
        if (error) {
            error->retry = true;
        }
        return false;
    }
    if (!awtlink_queue(s->link, message, error)) {
        return false;
    }
    sessionbook_sent(&s->book, message);
    return true;
}

const awtsession_forest *awtsession_forests(const awtsession *s, uint32_t *count)
{
    *count = s->book.count;
    return s->book.forests;
}

/* ---- the whole ------------------------------------------------------------------------------------------------ */

awtsession *awtsession_open(const awtsession_options *options, int64_t now_us, awtclient_error *error)
{
    awtsession *s = calloc(1, sizeof *s);
    if (!s) {
        awtcodec_fail(error, AWTCLIENT_MEMORY, "not enough memory");
        return NULL;
    }
    s->now_us = s->since_us = now_us;
    if (!sessionoptions_copy(&s->options, options, error)) {
        awtsession_close(s);
        return NULL;
    }
    s->patience_ms = options->patience_ms;
    memcpy(&s->waits.random, s->options.routing_key, sizeof s->waits.random);
    s->waits.random += (uint64_t)now_us; /* a key may be shared */
    connect_anew(s);
    if (s->state == SESSION_LOST) {
        awtcodec_pass(error, &s->why);
        awtsession_close(s);
        return NULL;
    }
    return s;
}

void awtsession_close(awtsession *s)
{
    if (s) {
        awtlink_close(s->link);
        sessionoptions_fini(&s->options);
        free(s);
    }
}

void awtsession_return(awtsession *s, int patience_ms, int64_t now_us)
{
    awtlink_drop(s->link);
    s->link = NULL;
    sessionbook_lost(&s->book, s->state == SESSION_OPEN);
    s->now_us = s->since_us = s->again_us = now_us;
    s->patience_ms = patience_ms;
    s->waits.tries = 0;
    s->resume_request = s->ping_request = 0;
    s->loss_to_tell = false;
    s->state = SESSION_AWAY;
}

awtlink *awtsession_link(const awtsession *s)
{
    return s->link;
}

int awtsession_descriptor(const awtsession *s)
{
    return s->link ? awtlink_descriptor(s->link) : -1;
}

unsigned awtsession_wanted(const awtsession *s)
{
    return s->link ? awtlink_wanted(s->link) : 0;
}

bool awtsession_pending(const awtsession *s)
{
    return s->loss_to_tell || s->state == SESSION_LOST || (s->link && awtlink_pending(s->link));
}

int64_t awtsession_deadline_us(const awtsession *s)
{
    if (!s->link) {
        return s->state == SESSION_AWAY ? s->again_us : s->now_us; /* awtsession_pump has to say that it is lost */
    }
    const int64_t link_us = awtlink_deadline_us(s->link), ping_us = ping_due_us(s);
    return link_us < ping_us ? link_us : ping_us;
}
