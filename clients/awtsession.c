/* awtsession.c: see awtsession.h. The link is made anew for every connection; what outlives it is here, and which
 * forests there are is sessionbook.c's.
 *
 * A session is between connections (no link), connecting (the link shakes hands), returning (RESUME and the ATTACHes
 * are under way) or open. */
#include "awtsession.h"
#include "backoff.h"
#include "codec.h"
#include "sessionbook.h"
#include "sessionoptions.h"

#include <stdlib.h>
#include <string.h>

enum { ATTACHES_AT_ONCE = 16 /* so that many forests do not fill the queue */ };

typedef enum session_state {
    SESSION_AWAY,
    SESSION_CONNECTING,
    SESSION_RETURNING,
    SESSION_OPEN,
    SESSION_LOST
} session_state;

struct awtsession {
    session_state state;
    awtlink *link;
    sessionoptions options;
    uint8_t token[AUTH_TOKEN_SIZE];
    bool resumable; /* token is of a session that was cut off */
    sessionbook book;
    int patience_ms;                    /* in force */
    int64_t now_us, since_us, again_us; /* since when, and when again, a connection is tried */
    backoff waits;
    uint64_t resume_request, ping_request; /* under way; 0: none */
    bool loss_to_tell;
    awtclient_error why; /* of the latest loss */
};

/* ---- losing --------------------------------------------------------------------------------------------------- */

static bool may_help(const awtclient_error *why)
{
    return why->retry || why->code == AWTCLIENT_CLOSED || why->code == AWTCLIENT_TIMEOUT;
}

/* The connection, or the attempt at one, has ended by `why`. */
static void lose(awtsession *s, const awtclient_error *why)
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
        lose(s, &why);
    }
}

/* Queues a message of the session's own. */
static bool ask(awtsession *s, proto_message *message)
{
    awtclient_error why;
    if (!awtlink_queue(s->link, message, &why)) {
        lose(s, &why);
        return false;
    }
    return true;
}

static void reopen_forests(awtsession *s)
{
    proto_message attach;
    uint32_t number;
    for (int i = 0; i < ATTACHES_AT_ONCE && sessionbook_next_attach(&s->book, &attach, &number); i++) {
        if (!ask(s, &attach)) {
            return;
        }
        sessionbook_asked(&s->book, number, attach.request);
    }
}

/* The link has just become ready. */
static void arrive(awtsession *s)
{
    proto_message resume = {.type = PROTO_RESUME};
    memcpy(resume.as.resume.session, s->token, sizeof s->token);
    s->state = SESSION_RETURNING;
    if (s->resumable && ask(s, &resume)) {
        s->resume_request = resume.request;
    }
    if (s->link) {
        memcpy(s->token, awtlink_session_token(s->link), sizeof s->token);
        s->resumable = true;
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
        lose(s, &why);
    }
    if (s->state == SESSION_CONNECTING && awtlink_ready(s->link)) {
        arrive(s);
    }
    if (s->state == SESSION_OPEN) {
        look_alive(s);
    }
    return s->state != SESSION_LOST || s->loss_to_tell || awtcodec_pass(error, &s->why);
}

/* ---- messages ------------------------------------------------------------------------------------------------- */

static void lose_by(awtsession *s, int code, const char *text)
{
    awtclient_error why;
    awtcodec_fail(&why, code, "%s", text);
    lose(s, &why);
}

/* Takes a message that is the session's own business. */
static bool take_own(awtsession *s, const proto_message *message)
{
    static const char SILENT[] = "the daemon does not answer any more";
    const int code = message->type == PROTO_ERROR ? message->as.error.code : 0;
    const bool late = code == PROTO_ERROR_TIMED_OUT;
    if (s->state == SESSION_RETURNING && late) {
        lose_by(s, AWTCLIENT_TIMEOUT, SILENT);
        return true;
    }
    if (s->resume_request != 0 && message->request == s->resume_request) {
        s->resume_request = 0; /* an ERROR: the time is over, or the daemon is another one */
        if (message->type == PROTO_RESUME_REPLY) {
            sessionbook_resumed(&s->book, &message->as.resume_reply);
        }
        return true;
    }
    if (s->ping_request != 0 && message->request == s->ping_request) {
        s->ping_request = 0;
        if (late) {
            lose_by(s, AWTCLIENT_TIMEOUT, SILENT);
        }
        return true;
    }
    sessionbook_came(&s->book, message);
    if (s->state == SESSION_RETURNING && code == PROTO_ERROR_WRONG_TOKEN) { /* the daemon closes after it */
        lose_by(s, AWTCLIENT_CLOSED, "a forest's token is not known any more");
        return true;
    }
    return s->state == SESSION_RETURNING && (message->type == PROTO_ATTACH_REPLY || message->type == PROTO_ERROR);
}

/* What is left to do before the session is open; true: nothing. */
static bool has_returned(awtsession *s)
{
    if (s->state != SESSION_RETURNING || s->resume_request != 0) {
        return false;
    }
    if (sessionbook_settled(&s->book)) {
        s->patience_ms = s->options.given.patience_ms;
        s->state = SESSION_OPEN;
        return true;
    }
    reopen_forests(s);
    return false;
}

awtsession_news awtsession_next(awtsession *s, proto_message *message, awtclient_error *error)
{
    awtclient_error why = {.code = 0};
    while (s->link && awtlink_next(s->link, message, &why)) {
        if (!take_own(s, message)) {
            return AWTSESSION_MESSAGE;
        }
    }
    if (s->link && why.code != 0) {
        lose(s, &why);
    }
    if (s->loss_to_tell) {
        s->loss_to_tell = false;
        awtcodec_pass(error, &s->why);
        return AWTSESSION_LOST;
    }
    return has_returned(s) ? AWTSESSION_OPENED : AWTSESSION_NOTHING;
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
    return s->loss_to_tell || (s->link && awtlink_pending(s->link));
}

int64_t awtsession_deadline_us(const awtsession *s)
{
    if (!s->link) {
        return s->state == SESSION_AWAY ? s->again_us : INT64_MAX;
    }
    const int64_t link_us = awtlink_deadline_us(s->link), ping_us = ping_due_us(s);
    return link_us < ping_us ? link_us : ping_us;
}
