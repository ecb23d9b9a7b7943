/* session_resume.c: RESUME: a client whose connection was cut off takes up what it held. */
#include "handlers.h"
#include "log.h"

#include <string.h>

/* A session whose end the daemon has not noticed yet; NULL: there is none of that token. */
static session *find_alive(const session *s, const uint8_t token[PARKING_TOKEN_SIZE])
{
    const handle_table *sessions = &s->shared->sessions;
    session *found = NULL;
    for (uint32_t i = 0; i < sessions->capacity; i++) {
        session *other = handle_at(sessions, i);
        if (other && other != s && session_is_resumable(other) && auth_equal(other->token, token, PARKING_TOKEN_SIZE)) {
            found = other;
        }
    }
    return found;
}

/* What the old session held is this one's now; its connection is told, in case somebody is still there. */
static void take_over(session *s, session *old)
{
    s->holds = old->holds;
    old->holds = (holdings){0};
    session_end_subscriptions(old);
    session_bye(old, "the session was resumed on another connection");
}

static void reply(session *s, uint64_t request)
{
    proto_message message = {.type = PROTO_RESUME_REPLY, .request = request};
    struct proto_resume_reply *r = &message.as.resume_reply;
    const holdings *h = &s->holds;
    _Static_assert(sizeof r->forests.items / sizeof r->forests.items[0] == LIMIT_SESSION_FORESTS &&
                       sizeof r->uploads.items / sizeof r->uploads.items[0] == LIMIT_SESSION_UPLOADS,
                   "everything that a session may hold has its place");
    for (uint32_t i = 0; i < h->count; i++) {
        if (registry_find(&s->shared->forests, h->attachments[i].forest)) {
            r->forests.items[r->forests.count++] = (struct proto_open_forest){.forest = h->attachments[i].forest,
                                                                              .may_drive = h->attachments[i].may_drive};
        }
    }
    for (uint32_t i = 0; i < LIMIT_SESSION_UPLOADS; i++) {
        if (h->uploads[i]) {
            r->uploads.items[r->uploads.count++] = (struct proto_begun_upload){
                .upload = h->uploads[i]->number, .received = h->uploads[i]->received, .total = h->uploads[i]->total};
        }
    }
    session_send(s, &message);
}

void session_resume(session *s, const proto_message *message)
{
    const uint8_t *token = message->as.resume.session;
    if (!holdings_are_none(&s->holds) || s->pending > 0) {
        session_error(s, message->type, message->request, PROTO_ERROR_NOT_ALLOWED,
                      "RESUME comes before anything is made or opened on a connection");
        return;
    }
    session *old = find_alive(s, token);
    if (old) {
        take_over(s, old);
    } else if (!parking_take(&s->shared->parked, token, &s->holds)) {
        session_error(s, message->type, message->request, PROTO_ERROR_NO_SESSION, NULL);
        return;
    }
    log_write(LOG_INFO, "session resumed", "peer=%s forests=%lu", s->peer, (unsigned long)s->holds.count);
    reply(s, message->request);
}
