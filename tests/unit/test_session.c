/* test_session.c: sessions that come back after their connection was lost, and clients that ask for it; against
 * scripted daemons, and in memory where time is to pass. */
#include "check.h"
#include "backoff.h"
#include "fake_daemon.h"
#include "socket.h"

#include <stdlib.h>
#include <string.h>

enum { LONG_MS = FAKE_PATIENCE_MS };

/* ---- scripts -------------------------------------------------------------------------------------------- */

static bool reply_created(fake *self, uint64_t forest)
{
    proto_message reply = {.type = PROTO_CREATE_REPLY};
    if (!fake_read(self) || self->got.type != PROTO_CREATE) {
        return false;
    }
    reply.request = self->got.request;
    reply.as.create_reply.forest = forest;
    memset(reply.as.create_reply.drive_token, (int)forest, sizeof reply.as.create_reply.drive_token);
    return script_send(self, &reply);
}

/* Takes RESUME of that session. */
static bool asked_to_resume(fake *self, uint8_t session)
{
    uint8_t token[16];
    memset(token, session, sizeof token);
    return fake_read(self) && self->got.type == PROTO_RESUME &&
           memcmp(self->got.as.resume.session, token, sizeof token) == 0;
}

/* What came is LIST, the last thing that the client asks for. */
static void answer_list(fake *self)
{
    if (self->got.type == PROTO_LIST) {
        proto_message reply = {.type = PROTO_LIST_REPLY, .request = self->got.request};
        script_send(self, &reply);
        fake_read(self);
    }
}

static void script_cut_and_resumed(fake *self)
{
    if (fake_welcome(self, false) && reply_created(self, 7) && fake_hang_up(self) && fake_welcome(self, false) &&
        asked_to_resume(self, 1)) {
        proto_message reply = {.type = PROTO_RESUME_REPLY, .request = self->got.request};
        reply.as.resume_reply.forests.count = 1;
        reply.as.resume_reply.forests.items[0].forest = 7;
        reply.as.resume_reply.forests.items[0].may_drive = 1;
        script_send(self, &reply);
        if (fake_read(self)) {
            answer_list(self);
        }
    }
}

/* Another daemon by now: forest 7 is there by its token, 8 is not, and a wrong token for 9 ends the connection. */
static void script_started_anew(fake *self)
{
    if (!fake_welcome(self, false) || !reply_created(self, 7) || !reply_created(self, 8) || !reply_created(self, 9)) {
        return;
    }
    while (fake_hang_up(self) && fake_welcome(self, false) && fake_read(self)) {
        fake_error(self, self->got.request, PROTO_RESUME, PROTO_ERROR_NO_SESSION, "");
        while (fake_read(self) && self->got.type == PROTO_ATTACH) {
            proto_message reply = {.type = PROTO_ATTACH_REPLY, .request = self->got.request};
            const uint64_t forest = self->got.as.attach.forest;
            reply.as.attach_reply.may_drive = self->got.as.attach.token[0] == forest;
            if (forest == 7) {
                script_send(self, &reply);
            } else {
                fake_error(self, reply.request, PROTO_ATTACH,
                           forest == 8 ? PROTO_ERROR_NO_FOREST : PROTO_ERROR_WRONG_TOKEN, "");
            }
        }
        if (self->got.type == PROTO_LIST) {
            answer_list(self);
            return;
        }
    }
}

static void script_refuses_later(fake *self)
{
    if (fake_welcome(self, false) && fake_hang_up(self) && fake_read(self)) {
        fake_error(self, self->got.request, PROTO_HELLO, PROTO_ERROR_BAD_VERSION, "");
    }
}

static void script_leaves(fake *self)
{
    fake_welcome(self, false);
}

/* ---- what is tested ------------------------------------------------------------------------------------- */

static awtsession *open_session(const fake *server, int patience_ms)
{
    const awtsession_options options = {.link = {.address = server->address, .timeout_ms = LONG_MS},
                                        .patience_ms = patience_ms};
    awtclient_error error = {.text = ""};
    awtsession *session = awtsession_open(&options, awtclient_now_us(), &error);
    CHECK_TEXT(error.text, "");
    return session;
}

/* Turns a caller's loop until there is news; AWTSESSION_NOTHING: it has been given up. */
static awtsession_news next_news(awtsession *session, proto_message *message, awtclient_error *error)
{
    for (;;) {
        const awtsession_news news = awtsession_next(session, message, error);
        if (news != AWTSESSION_NOTHING) {
            return news;
        }
        const int64_t due_us = awtsession_deadline_us(session), last_us = awtclient_now_us() + INT64_C(1000) * LONG_MS;
        socket_wait(awtsession_descriptor(session), awtsession_wanted(session),
                    awtsession_pending(session) ? 0
                    : due_us < last_us          ? due_us
                                                : last_us);
        if (!awtsession_pump(session, awtclient_now_us(), error)) {
            return AWTSESSION_NOTHING;
        }
    }
}

static void create(awtsession *session, proto_message *message)
{
    awtclient_error error = {.text = ""};
    proto_message request = {.type = PROTO_CREATE};
    request.as.create.head.orientation[3] = request.as.create.body.orientation[3] = 1;
    CHECK(awtsession_queue(session, &request, &error));
    CHECK_INT(next_news(session, message, &error), AWTSESSION_MESSAGE);
    CHECK_INT(message->type, PROTO_CREATE_REPLY);
    CHECK_TEXT(error.text, "");
}

/* It can be used again. */
static void list(awtsession *session, proto_message *message)
{
    awtclient_error error = {.text = ""};
    proto_message request = {.type = PROTO_LIST};
    CHECK(awtsession_queue(session, &request, &error));
    CHECK_INT(next_news(session, message, &error), AWTSESSION_MESSAGE);
    CHECK_INT(message->type, PROTO_LIST_REPLY);
}

TEST(session_that_is_cut_off_comes_back_and_is_resumed)
{
    static proto_message message;
    fake server;
    awtclient_error error = {.code = 0};
    uint32_t count;
    CHECK(fake_start(&server, script_cut_and_resumed));
    awtsession *session = open_session(&server, LONG_MS);
    CHECK(session != NULL);
    if (session) {
        proto_message early = {.type = PROTO_LIST};
        CHECK(!awtsession_queue(session, &early, &error));
        CHECK_INT(error.code, AWTCLIENT_FULL);
        CHECK_INT(next_news(session, &message, &error), AWTSESSION_OPENED);
        create(session, &message);
        CHECK_INT(next_news(session, &message, &error), AWTSESSION_LOST);
        CHECK_INT(error.code, AWTCLIENT_CLOSED);
        CHECK_INT(next_news(session, &message, &error), AWTSESSION_OPENED);
        const awtsession_forest *forests = awtsession_forests(session, &count);
        CHECK(count == 1 && forests[0].forest == 7 && forests[0].may_drive && forests[0].open);
        list(session, &message);
    }
    awtsession_close(session);
    fake_stop(&server);
}

TEST(session_opens_forests_by_their_tokens_where_the_daemon_is_another_and_tells_those_gone)
{
    static proto_message message;
    fake server;
    awtclient_error error = {.code = 0};
    uint32_t count;
    CHECK(fake_start(&server, script_started_anew));
    awtsession *session = open_session(&server, LONG_MS);
    CHECK(session && next_news(session, &message, &error) == AWTSESSION_OPENED);
    if (session) {
        for (int n = 0; n < 3; n++) {
            create(session, &message);
        }
        CHECK_INT(next_news(session, &message, &error), AWTSESSION_LOST);
        CHECK_INT(next_news(session, &message, &error), AWTSESSION_OPENED);
        const awtsession_forest *forests = awtsession_forests(session, &count);
        CHECK_INT(count, 3);
        for (uint32_t i = 0; i < count; i++) {
            CHECK_INT(forests[i].open, forests[i].forest == 7);
        }
        list(session, &message);
    }
    awtsession_close(session);
    fake_stop(&server);
}

TEST(session_is_given_up_where_trying_again_cannot_help_or_patience_is_over)
{
    static proto_message message;
    fake server;
    awtclient_error error = {.code = 0};
    CHECK(fake_start(&server, script_refuses_later));
    awtsession *session = open_session(&server, 0);
    CHECK(session && next_news(session, &message, &error) == AWTSESSION_OPENED);
    CHECK(session && next_news(session, &message, &error) == AWTSESSION_LOST);
    CHECK(session && next_news(session, &message, &error) == AWTSESSION_NOTHING);
    CHECK_INT(error.code, PROTO_ERROR_BAD_VERSION);
    awtsession_close(session);
    fake_stop(&server);
    CHECK(fake_start(&server, script_leaves));
    session = open_session(&server, 150);
    CHECK(session && next_news(session, &message, &error) == AWTSESSION_OPENED);
    fake_stop(&server); /* nobody is there from now on */
    CHECK(session && next_news(session, &message, &error) == AWTSESSION_LOST);
    CHECK(session && next_news(session, &message, &error) == AWTSESSION_NOTHING);
    CHECK_INT(error.code, AWTCLIENT_ADDRESS);
    awtsession_close(session);
}

TEST(client_that_waits_comes_back_when_it_asks_for_it)
{
    static proto_message answer;
    fake server;
    awtclient_error error = {.code = 0};
    uint32_t count = 0;
    CHECK(fake_start(&server, script_cut_and_resumed));
    awtclient *client = fake_open(&server, NULL, LONG_MS, &error);
    CHECK(client != NULL);
    if (client) {
        proto_message create = {.type = PROTO_CREATE}, ask = {.type = PROTO_LIST};
        create.as.create.head.orientation[3] = create.as.create.body.orientation[3] = 1;
        CHECK(awtclient_call(client, &create, &answer, &error));
        CHECK(!awtclient_receive(client, &answer, &error));
        CHECK_INT(error.code, AWTCLIENT_CLOSED);
        CHECK(!awtclient_call(client, &ask, &answer, &error)); /* not by itself */
        CHECK(awtclient_reopen(client, LONG_MS, &error));
        const awtsession_forest *forests = awtsession_forests(awtclient_session(client), &count);
        CHECK(count == 1 && forests[0].open);
        ask.request = 0;
        CHECK(awtclient_call(client, &ask, &answer, &error));
    }
    awtclient_close(client);
    fake_stop(&server);
    CHECK(!(client = fake_open(&server, NULL, LONG_MS, &error)));
}

/* ---- in memory, by a clock of our own ------------------------------------------------------------------- */

/* What a connection's other end has sent; it reads everything and hears nothing. */
typedef struct pipe_end {
    unsigned char in[1024];
    size_t size, used;
    unsigned made;
    bool refuses;
} pipe_end;

static long pipe_send(void *context, const void *bytes, size_t size, awtclient_error *error)
{
    (void)context, (void)bytes, (void)error;
    return (long)size;
}

static long pipe_receive(void *context, void *bytes, size_t size, awtclient_error *error)
{
    pipe_end *self = context;
    const size_t left = self->size - self->used, taken = left < size ? left : size;
    (void)error;
    memcpy(bytes, self->in + self->used, taken);
    self->used += taken;
    return taken > 0 ? (long)taken : AWTLINK_WANT_READ;
}

/* A connection to a daemon that lets one in, and then says no more. */
static bool pipe_make(void *context, awtlink_transport *out, awtclient_error *error)
{
    pipe_end *self = context;
    proto_message welcome = {.type = PROTO_WELCOME};
    welcome.as.welcome.version = PROTO_VERSION;
    welcome.as.welcome.greatest_payload = PROTO_MAX_REQUEST;
    self->size = proto_encode(&welcome, self->in, sizeof self->in);
    self->used = 0;
    self->made++;
    *out = (awtlink_transport){.context = self, .send = pipe_send, .receive = pipe_receive};
    if (self->refuses) {
        *error = (awtclient_error){.code = AWTCLIENT_ADDRESS, .retry = true};
    }
    return !self->refuses;
}

TEST(session_notices_a_daemon_that_has_fallen_silent)
{
    static proto_message message;
    pipe_end far = {.size = 0};
    const awtsession_options options = {
        .link = {.timeout_ms = 1000}, .make_transport = pipe_make, .context = &far, .patience_ms = 100000};
    awtclient_error error = {.code = 0};
    awtsession *session = awtsession_open(&options, 0, &error);
    CHECK(session && awtsession_pump(session, 10, &error));
    CHECK_INT(awtsession_next(session, &message, &error), AWTSESSION_OPENED);
    CHECK_INT(awtsession_deadline_us(session), 500010);
    CHECK(awtsession_pump(session, 500010, &error)); /* asks */
    CHECK(awtsession_pump(session, 500020, &error));
    CHECK_INT(awtsession_next(session, &message, &error), AWTSESSION_NOTHING);
    CHECK_INT(awtsession_deadline_us(session), 1500020);
    CHECK(awtsession_pump(session, 1500020, &error));
    CHECK_INT(awtsession_next(session, &message, &error), AWTSESSION_LOST);
    CHECK_INT(error.code, AWTCLIENT_TIMEOUT);
    CHECK_INT(awtsession_descriptor(session), -1);
    const int64_t again_us = awtsession_deadline_us(session);
    CHECK(again_us >= 1500020 + 50000 && again_us <= 1500020 + 100000);
    CHECK(awtsession_pump(session, again_us, &error));
    CHECK_INT(far.made, 2);
    for (int turns = 0; turns < 4; turns++) { /* RESUME is not answered: that, too, ends */
        CHECK_INT(awtsession_next(session, &message, &error), AWTSESSION_NOTHING);
        CHECK(awtsession_pump(session, again_us + turns * 600000, &error));
    }
    CHECK_INT(far.made, 3);
    awtsession_close(session);
}

TEST(session_never_comes_back_in_the_open_where_its_transport_was_brought)
{
    static proto_message message;
    pipe_end far = {.size = 0};
    awtlink_transport transport;
    awtclient_error error = {.code = 0};
    CHECK(pipe_make(&far, &transport, &error));
    const awtsession_options options = {.link = {.address = "127.0.0.1:1", .transport = &transport}};
    awtsession *session = awtsession_open(&options, 0, &error);
    CHECK(session && awtsession_pump(session, 10, &error));
    CHECK_INT(awtsession_next(session, &message, &error), AWTSESSION_OPENED);
    awtsession_return(session, 0, 20);
    CHECK(!awtsession_pump(session, 20, &error));
    CHECK_INT(error.code, AWTCLIENT_ADDRESS);
    CHECK(strstr(error.text, "make_transport") != NULL);
    awtsession_close(session);
}

TEST(session_tries_again_later_and_later_and_not_at_the_same_time_as_others)
{
    backoff a = {.random = 1}, b = {.random = 2};
    int64_t greatest_us = 50000;
    bool differ = false;
    for (int i = 0; i < 12; i++) {
        const int64_t wait_us = backoff_failed(&a, 0), other_us = backoff_failed(&b, 0);
        greatest_us = greatest_us < 2500000 ? 2 * greatest_us : 5000000;
        CHECK(wait_us >= greatest_us / 2 && wait_us <= greatest_us);
        differ = differ || llabs(wait_us - other_us) > 10000;
    }
    CHECK(differ);
    CHECK_INT(backoff_failed(&a, 30000), 30000000);
}

TEST(link_answers_what_the_daemon_does_not_answer)
{
    static proto_message message;
    pipe_end far = {.size = 0};
    awtlink_transport transport;
    awtclient_error error = {.code = 0};
    CHECK(pipe_make(&far, &transport, &error));
    const awtclient_options options = {.transport = &transport, .timeout_ms = 1000};
    awtlink *link = awtlink_open(&options, 0, &error);
    CHECK(link && awtlink_pump(link, 0, &error) && awtlink_ready(link));
    proto_message create = {.type = PROTO_CREATE}, ask = {.type = PROTO_LIST}, motion = {.type = PROTO_MOTION};
    create.as.create.head.orientation[3] = create.as.create.body.orientation[3] = 1;
    motion.as.motion.head = motion.as.motion.body = create.as.create.head;
    CHECK(awtlink_queue(link, &create, &error) && awtlink_queue(link, &ask, &error) &&
          awtlink_queue(link, &motion, &error));
    CHECK(awtlink_pump(link, 5000000, &error)); /* the time begins when they go out, not when they were written */
    CHECK(!awtlink_next(link, &message, &error) && error.code == 0);
    CHECK_INT(awtlink_deadline_us(link), 6000000);
    proto_message progress = {.type = PROTO_PROGRESS, .request = create.request};
    far.used = 0;
    far.size = proto_encode(&progress, far.in, sizeof far.in);
    CHECK(awtlink_pump(link, 5500000, &error) && awtlink_next(link, &message, &error)); /* of that work goes on */
    CHECK_INT(message.type, PROTO_PROGRESS);
    CHECK(awtlink_pump(link, 6000000, &error) && awtlink_next(link, &message, &error));
    CHECK_INT(message.type, PROTO_ERROR);
    CHECK_U64(message.request, ask.request);
    CHECK_INT(message.as.error.code, PROTO_ERROR_TIMED_OUT);
    CHECK_INT(message.as.error.about, PROTO_LIST);
    CHECK(!awtlink_next(link, &message, &error) && error.code == 0);
    CHECK(awtlink_pump(link, 7000000, &error) && awtlink_next(link, &message, &error));
    CHECK_U64(message.request, create.request);
    CHECK_INT(awtlink_deadline_us(link), INT64_MAX); /* MOTION is not answered */
    awtlink_close(link);
}
