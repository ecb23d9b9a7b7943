/* awtsession_return.c: from a new connection to an open session (awtsession_parts.h): RESUME takes up what the daemon
 * has kept, ATTACH opens forests by their tokens where it has not; and the answers to what the session itself has
 * asked. */
#include "awtsession_parts.h"

#include <string.h>

enum { ATTACHES_AT_ONCE = 16 /* so that many forests do not fill the queue */ };

/* Queues a message of the session's own. */
static bool ask(awtsession *s, proto_message *message)
{
    awtclient_error why;
    if (!awtlink_queue(s->link, message, &why)) {
        session_lose(s, &why);
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

void session_arrive(awtsession *s)
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

static void lose_by(awtsession *s, int code, const char *text)
{
    awtclient_error why;
    awtcodec_fail(&why, code, "%s", text);
    session_lose(s, &why);
}

bool session_take_own(awtsession *s, const proto_message *message)
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

bool session_has_returned(awtsession *s)
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
