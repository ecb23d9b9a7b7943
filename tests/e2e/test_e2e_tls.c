/* test_e2e_tls.c: the client library through TLS, by the transport of two functions that callers bring (awtlink.h):
 * here `openssl s_client` speaks TLS at the end of a socket pair, and Python's ssl takes it before a real daemon. */
#include "check.h"
#include "e2e/daemon.h"
#include "socket.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

typedef struct tls {
    int fd;
    pid_t pid;
} tls;

/* Where TLS is taken, and who is trusted there. */
typedef struct place {
    char folder[FOLDER_PATH], certificate[128], key[128], trusted[128];
    line_process terminator;
    pid_t last; /* s_client of the latest connection */
} place;

/* ---- the transport ---------------------------------------------------------------------------------------------- */

static long answer_of(ssize_t moved, long none)
{
    return moved > 0 ? (long)moved : moved < 0 && (errno == EAGAIN || errno == EINTR) ? none : AWTLINK_FAILED;
}

static long tls_send(void *context, const void *bytes, size_t size, awtclient_error *error)
{
    (void)error;
    return answer_of(send(((tls *)context)->fd, bytes, size, MSG_NOSIGNAL), AWTLINK_WANT_WRITE);
}

static long tls_receive(void *context, void *bytes, size_t size, awtclient_error *error)
{
    (void)error;
    const ssize_t got = recv(((tls *)context)->fd, bytes, size, 0);
    return got == 0 ? AWTLINK_ENDED : answer_of(got, AWTLINK_WANT_READ);
}

static int tls_descriptor(void *context)
{
    return ((tls *)context)->fd;
}

static void tls_close(void *context)
{
    tls *self = context;
    close(self->fd);
    kill(self->pid, SIGTERM);
    waitpid(self->pid, NULL, 0);
    free(self);
}

static void run_client(const place *p, int fd)
{
    dup2(fd, STDIN_FILENO);
    dup2(fd, STDOUT_FILENO);
    dup2(open("/dev/null", O_WRONLY), STDERR_FILENO);
    execlp("openssl", "openssl", "s_client", "-quiet", "-verify_return_error", "-CAfile", p->trusted, "-connect",
           p->terminator.address, (char *)NULL);
    _exit(127);
}

static bool tls_make(void *context, awtlink_transport *out, awtclient_error *error)
{
    (void)error;
    place *p = context;
    int ends[2];
    tls *self = calloc(1, sizeof *self);
    if (!self || socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) {
        free(self);
        return false;
    }
    fcntl(ends[0], F_SETFL, O_NONBLOCK);
    fcntl(ends[0], F_SETFD, FD_CLOEXEC);
    self->fd = ends[0];
    self->pid = p->last = fork();
    if (self->pid == 0) {
        run_client(p, ends[1]);
    }
    close(ends[1]);
    *out = (awtlink_transport){self, tls_send, tls_receive, tls_descriptor, tls_close};
    return true;
}

/* ---- before the daemon ------------------------------------------------------------------------------------------ */

static bool make_certificate(const char *certificate, const char *key)
{
    char command[512];
    snprintf(command, sizeof command,
             "openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=localhost -addext "
             "subjectAltName=IP:127.0.0.1 -keyout %s -out %s 2>/dev/null",
             key, certificate);
    return system(command) == 0;
}

static bool place_make(place *p, const daemon_process *daemon)
{
    folder_make(p->folder);
    snprintf(p->certificate, sizeof p->certificate, "%s/certificate", p->folder);
    snprintf(p->key, sizeof p->key, "%s/key", p->folder);
    snprintf(p->trusted, sizeof p->trusted, "%s", p->certificate);
    const char *const terminator[] = {"/usr/bin/env",  "python3", "tests/e2e/tls_terminator.py", p->certificate, p->key,
                                      daemon->address, NULL};
    return make_certificate(p->certificate, p->key) &&
           daemon_spawn(terminator, &p->terminator.pid, p->terminator.address, sizeof p->terminator.address);
}

static bool tls_is_there(void)
{
    return system("command -v openssl >/dev/null 2>&1 && python3 -c 'import ssl' >/dev/null 2>&1") == 0;
}

/* The hair of ten steps of a head that turns, [1000 strands] ends of strands added up in order; 0: it failed. */
static double drive(awtclient *client)
{
    awtclient_error error = {.text = ""};
    awtframes_shown shown = {.strand_count = 0};
    awthair *hair = client ? awthair_create(client, "long", 1000, &error) : NULL;
    double sum = 0;
    for (int n = 1; hair && n <= 10; n++) {
        const proto_pose head = {.position = {0.01 * n, 0, 0}, .orientation = {0, 0, 0, 1}};
        CHECK(awthair_drive(hair, n * 16667, &head, NULL, &shown, &error));
        for (size_t i = 0; i < (size_t)shown.strand_count * shown.points_per_strand * 3; i++) {
            sum += (double)shown.positions[i];
        }
    }
    CHECK_TEXT(error.text, "");
    awthair_close(hair);
    return sum;
}

TEST(e2e_client_gets_the_same_hair_through_tls_and_comes_back_through_it)
{
    daemon_process daemon;
    place p = {.last = 0};
    awtclient_error error = {.text = ""};
    if (!tls_is_there()) {
        check_skip("no openssl or no python3 with ssl here");
        return;
    }
    CHECK(daemon_start(&daemon, 1, NULL));
    CHECK(place_make(&p, &daemon));
    awtclient *plain = daemon_client(&daemon);
    const double expected = drive(plain);
    awtclient_close(plain);

    awtlink_transport transport;
    CHECK(tls_make(&p, &transport, &error));
    awtclient_options options = {.token_file = daemon.token_file, .transport = &transport};
    awtclient *client = awtclient_open(&options, &error);
    CHECK_TEXT(error.text, "");
    CHECK_NEAR(drive(client), expected, 0);
    awtclient_close(client);

    static proto_message message;
    const awtsession_options again = {
        .link = {.token_file = daemon.token_file}, .patience_ms = 60000, .make_transport = tls_make, .context = &p};
    awtsession *session = awtsession_open(&again, awtclient_now_us(), &error);
    int opened = 0, lost = 0;
    while (session && opened < 2 && awtsession_pump(session, awtclient_now_us(), &error)) {
        socket_wait(awtsession_descriptor(session), awtsession_wanted(session),
                    awtsession_pending(session) ? 0 : awtsession_deadline_us(session));
        switch (awtsession_next(session, &message, &error)) {
        case AWTSESSION_OPENED:
            if (++opened == 1) {
                kill(p.last, SIGKILL); /* the connection is cut */
            }
            break;
        case AWTSESSION_LOST:
            lost++;
            break;
        default:
            break;
        }
    }
    CHECK_INT(opened, 2);
    CHECK_INT(lost, 1);
    awtsession_close(session);

    snprintf(p.trusted, sizeof p.trusted, "%s/other", p.folder); /* who has another certificate is not believed */
    CHECK(make_certificate(p.trusted, p.key) && tls_make(&p, &transport, &error));
    CHECK(!awtclient_open(&options, &error));
    CHECK_INT(error.code, AWTCLIENT_CLOSED);
    line_stop(&p.terminator);
    folder_remove(p.folder);
    CHECK_INT(daemon_stop(&daemon), 0);
}
