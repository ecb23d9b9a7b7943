/* test_e2e_half_open.c: peers that vanish without a word: the line to them takes everything and brings nothing, as
 * where a machine lost its power or a router its memory. */
#include "check.h"
#include "e2e/bare.h"
#include "e2e/daemon.h"

#include <signal.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { PATIENCE = 3000 /* hundredths of a second */ };

/* A daemon, a client behind a line who has a forest and has begun an upload, and one who sees how the daemon is. */
typedef struct scene {
    daemon_process daemon;
    line_process line;
    int far, near;
    unsigned char session[BARE_SESSION];
    uint64_t forest;
} scene;

static void scene_init(scene *s, const char *const *arguments)
{
    static const unsigned char piece[64];
    proto_message upload = {.type = PROTO_UPLOAD, .flags = PROTO_FLAG_REQUIRED, .request = 4}, answer = {0};
    upload.as.upload.upload = 1;
    upload.as.upload.total = 1000;
    upload.as.upload.piece = (proto_blob){piece, sizeof piece};
    CHECK(daemon_start(&s->daemon, 1, arguments));
    CHECK(line_start(&s->line, s->daemon.address, "0", "0", "0"));
    s->near = bare_open(s->daemon.address, NULL);
    s->far = bare_open(s->line.address, s->session);
    s->forest = bare_create(s->far, 1);
    CHECK(s->forest != 0);
    CHECK(bare_ask(s->far, &upload, &answer) && answer.type == PROTO_UPLOAD_REPLY);
    CHECK_INT(bare_stats(s->near).connections, 2);
}

static void scene_fini(scene *s)
{
    kill(s->line.pid, SIGCONT);
    line_stop(&s->line);
    close(s->far);
    close(s->near);
    CHECK_INT(daemon_stop(&s->daemon), 0);
}

/* Nothing goes through the line any more, and neither end hears of it. Waits until the daemon has let the far one go.
 */
static void vanish(scene *s)
{
    struct proto_stats_reply stats = {.connections = 2};
    kill(s->line.pid, SIGSTOP);
    for (int n = 0; n < PATIENCE && stats.connections > 1; n++) {
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
        stats = bare_stats(s->near);
    }
    CHECK_INT(stats.connections, 1);
}

static proto_message resume(const scene *s)
{
    proto_message message = {.type = PROTO_RESUME, .flags = PROTO_FLAG_REQUIRED, .request = 7};
    memcpy(message.as.resume.session, s->session, sizeof message.as.resume.session);
    return message;
}

TEST(e2e_session_of_a_peer_that_vanished_without_a_word_can_be_resumed)
{
    const char *const arguments[] = {"--no-auth", "--drain-grace", "0", "--quiet-timeout", "1", NULL};
    proto_message answer = {0}, query = {.type = PROTO_QUERY, .flags = PROTO_FLAG_REQUIRED, .request = 8};
    scene s = {0};
    scene_init(&s, arguments);
    vanish(&s);
    CHECK_INT(bare_stats(s.near).forests, 1);
    const proto_message back = resume(&s);
    const int again = bare_open(s.daemon.address, NULL);
    CHECK(bare_ask(again, &back, &answer) && answer.type == PROTO_RESUME_REPLY);
    CHECK_INT(answer.as.resume_reply.forests.count, 1);
    CHECK_U64(answer.as.resume_reply.forests.items[0].forest, s.forest);
    CHECK_INT(answer.as.resume_reply.forests.items[0].may_drive, 1);
    CHECK_INT(answer.as.resume_reply.uploads.count, 1);
    CHECK_INT(answer.as.resume_reply.uploads.items[0].received, 64);
    query.as.query.forest = s.forest;
    query.as.query.time_us = 10000;
    CHECK(bare_ask(again, &query, &answer) && answer.type == PROTO_FRAME);
    CHECK_INT(answer.as.frame.time_us, 10000);
    close(again);
    scene_fini(&s);
}

TEST(e2e_what_a_peer_held_that_vanished_without_a_word_is_freed_after_the_graces)
{
    const char *const arguments[] = {
        "--no-auth", "--drain-grace", "0", "--quiet-timeout", "1", "--resume-grace", "1", "--forest-grace", "1", NULL};
    proto_message answer = {0};
    scene s = {0};
    scene_init(&s, arguments);
    vanish(&s);
    for (int n = 0; n < PATIENCE && bare_stats(s.near).forests > 0; n++) {
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    }
    CHECK_INT(bare_stats(s.near).forests, 0);
    const proto_message back = resume(&s);
    CHECK(bare_ask(s.near, &back, &answer) && answer.type == PROTO_ERROR);
    CHECK_INT(answer.as.error.code, PROTO_ERROR_NO_SESSION);
    scene_fini(&s);
}
