/* session_greeting.c: HELLO, AUTH, PING, PONG, BYE: how a connection begins, stays and ends. */
#include "handlers.h"
#include "base/version.h"
#include "log.h"
#include "random.h"

#include <string.h>

static void welcome(session *s, uint64_t request)
{
    proto_message reply = {.type = PROTO_WELCOME, .request = request};
    struct proto_welcome *w = &reply.as.welcome;
    w->version = PROTO_VERSION;
    w->auth_required = s->shared->options.auth_required;
    w->greatest_payload = PROTO_MAX_REQUEST;
    w->server = proto_str_of("awtd " AWTD_VERSION);
    memcpy(w->nonce, s->nonce, sizeof w->nonce);
    memcpy(w->session, s->token, sizeof w->session);
    s->state = SESSION_AUTH;
    if (w->auth_required || session_enter(s, PROTO_HELLO, request, accounts_owner(&s->shared->accounts))) {
        session_send(s, &reply);
    }
}

void session_hello(session *s, const proto_message *message)
{
    const struct proto_hello *hello = &message->as.hello;
    char quoted[LOG_QUOTED];
    log_write(LOG_INFO, "hello", "peer=%s client=%s", s->peer,
              log_quote(hello->client.text, hello->client.length, quoted));
    if (memcmp(hello->magic, PROTO_MAGIC, sizeof hello->magic) != 0) {
        session_error(s, PROTO_HELLO, message->request, PROTO_ERROR_BAD_MAGIC, NULL);
    } else if (hello->lowest_version > PROTO_VERSION || hello->highest_version < PROTO_VERSION) {
        session_error(s, PROTO_HELLO, message->request, PROTO_ERROR_BAD_VERSION,
                      "this daemon speaks version %d of the protocol, the client %u to %u", PROTO_VERSION,
                      (unsigned)hello->lowest_version, (unsigned)hello->highest_version);
    } else if (!random_fill(s->nonce, sizeof s->nonce) || !random_fill(s->token, sizeof s->token)) {
        session_error(s, PROTO_HELLO, message->request, PROTO_ERROR_BUSY, NULL);
    } else {
        welcome(s, message->request);
    }
}

void session_auth(session *s, const proto_message *message)
{
    const struct proto_auth *auth = &message->as.auth;
    account *who = accounts_prove(&s->shared->accounts, s->nonce, auth);
    if (!who) {
        log_write(LOG_WARN, "wrong token", "peer=%s", s->peer);
        session_error(s, PROTO_AUTH, message->request, PROTO_ERROR_WRONG_TOKEN, NULL);
        return;
    }
    proto_message reply = {.type = PROTO_AUTH_REPLY, .request = message->request};
    auth_server_proof(who->is.token, s->nonce, auth->nonce, reply.as.auth_reply.proof);
    if (session_enter(s, PROTO_AUTH, message->request, who)) {
        session_send(s, &reply);
    }
}

void session_ping(session *s, const proto_message *message)
{
    proto_message reply = {.type = PROTO_PONG, .request = message->request};
    reply.as.pong.sent_us = message->as.ping.sent_us;
    reply.as.pong.received_us = s->shared->options.clock_us();
    reply.as.pong.answered_us = s->shared->options.clock_us();
    session_send(s, &reply);
}

/* That it came says all (session_heard). */
void session_pong(session *s, const proto_message *message)
{
    (void)s;
    (void)message;
}

void session_client_bye(session *s, const proto_message *message)
{
    char quoted[LOG_QUOTED];
    log_write(LOG_DEBUG, "bye", "peer=%s reason=%s", s->peer,
              log_quote(message->as.bye.reason.text, message->as.bye.reason.length, quoted));
    s->state = SESSION_CLOSING;
}
