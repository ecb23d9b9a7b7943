/* test_e2e_faults.c: a daemon that runs out of what it needs, and clients that mean it no good: nobody else notices,
 * and when it is over all is as before. */
#define _GNU_SOURCE /* prlimit */
#include "check.h"
#include "e2e/bare.h"
#include "e2e/daemon.h"

#include <dirent.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { SOCKETS = 24, PATIENCE = 3000 /* hundredths of a second */ };

static void pause_cs(void)
{
    nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
}

/* Descriptors that a process has open; -1: nobody knows. */
static int descriptors_of(pid_t pid)
{
    char path[64];
    snprintf(path, sizeof path, "/proc/%ld/fd", (long)pid);
    DIR *folder = opendir(path);
    int count = folder ? 0 : -1;
    while (folder && readdir(folder)) {
        count++;
    }
    if (folder) {
        closedir(folder);
    }
    return count < 2 ? -1 : count - 2; /* . and .. */
}

static bool is_served(awtclient *client)
{
    proto_message answer;
    awtclient_error error = {0};
    proto_message stats = {.type = PROTO_STATS};
    bool answered = client && awtclient_call(client, &stats, &answer, &error);
    CHECK_TEXT(error.text, "");
    return answered;
}

TEST(e2e_daemon_out_of_descriptors_serves_whom_it_has_and_takes_others_again)
{
    daemon_process daemon;
    CHECK(daemon_start(&daemon, 1, NULL));
    awtclient *early = daemon_client(&daemon);
    const int open = descriptors_of(daemon.pid);
    if (open < 0) {
        check_skip("/proc does not say what a process has open");
        awtclient_close(early);
        daemon_stop(&daemon);
        return;
    }
    struct rlimit before, few = {.rlim_cur = (rlim_t)open + 3};
    CHECK_INT(prlimit(daemon.pid, RLIMIT_NOFILE, NULL, &before), 0);
    few.rlim_max = before.rlim_max;
    CHECK_INT(prlimit(daemon.pid, RLIMIT_NOFILE, &few, NULL), 0);
    int sockets[SOCKETS];
    for (int i = 0; i < SOCKETS; i++) {
        sockets[i] = daemon_socket(&daemon); /* into the listener's queue */
        CHECK(sockets[i] >= 0);
    }
    for (int n = 0; n < PATIENCE && descriptors_of(daemon.pid) <= open; n++) {
        pause_cs();
    }
    for (int n = 0; n < 50; n++) {
        CHECK(is_served(early));
        pause_cs(); /* over several pauses of the door */
    }
    const int taken = descriptors_of(daemon.pid) - open;
    CHECK(taken > 0 && taken < SOCKETS); /* there was not one left for the others */
    for (int i = 0; i < SOCKETS; i++) {
        close(sockets[i]);
    }
    awtclient *late = daemon_client(&daemon); /* with as few descriptors as before */
    CHECK(is_served(late));
    CHECK(is_served(early));
    awtclient_close(late);
    awtclient_close(early);
    CHECK_INT(daemon_stop(&daemon), 0);
}

/* A HELLO as a client writes it. */
static size_t write_hello(unsigned char *bytes, size_t capacity)
{
    proto_message message = {.type = PROTO_HELLO, .request = 1};
    struct proto_hello *hello = &message.as.hello;
    memcpy(hello->magic, PROTO_MAGIC, sizeof hello->magic);
    hello->lowest_version = hello->highest_version = PROTO_VERSION;
    hello->client = proto_str_of("one that takes its time");
    hello->length = (uint16_t)(proto_encoded_size(&message) - PROTO_HEADER_SIZE);
    return proto_encode(&message, bytes, capacity);
}

/* Sends another byte. False: the daemon has ended it. */
static bool drip(int descriptor, const unsigned char *byte)
{
    unsigned char said[512];
    ssize_t got;
    while ((got = recv(descriptor, said, sizeof said, MSG_DONTWAIT)) > 0) {
    }
    return got != 0 && send(descriptor, byte, 1, MSG_NOSIGNAL | MSG_DONTWAIT) == 1;
}

TEST(e2e_handshakes_that_drip_in_are_ended_and_nobody_waits_for_them)
{
    daemon_process daemon;
    CHECK(daemon_start(&daemon, 1, NULL));
    awtclient *client = daemon_client(&daemon);
    int sockets[SOCKETS], left = SOCKETS;
    unsigned char hello[256];
    CHECK(write_hello(hello, sizeof hello) > PATIENCE / 100); /* a byte a second: it is never whole */
    for (int i = 0; i < SOCKETS; i++) {
        sockets[i] = daemon_socket(&daemon);
        CHECK(sockets[i] >= 0);
    }
    for (int n = 0; n < PATIENCE && left > 0; n++) {
        for (int i = 0; i < SOCKETS && n % 100 == 0; i++) {
            if (sockets[i] >= 0 && !drip(sockets[i], &hello[n / 100])) {
                close(sockets[i]);
                sockets[i] = -1;
                left--;
            }
        }
        CHECK(n % 100 != 0 || is_served(client));
        pause_cs();
    }
    CHECK_INT(left, 0);
    CHECK(is_served(client));
    awtclient_close(client);
    CHECK_INT(daemon_stop(&daemon), 0);
}

/* Asks for more than it takes, and takes nothing. */
static int deaf_client(const daemon_process *daemon)
{
    enum { LOOKS = 2000 };
    const int fd = bare_open(daemon->address, NULL);
    proto_message look = {.type = PROTO_QUERY, .flags = PROTO_FLAG_REQUIRED, .request = 5};
    look.as.query.forest = bare_create(fd, 1);
    look.as.query.latest = 1;
    for (int n = 0; n < LOOKS; n++) {
        CHECK(bare_send(fd, &look));
    }
    return fd;
}

TEST(e2e_daemon_stops_though_clients_take_nothing_and_have_gone)
{
    const char *const arguments[] = {"--no-auth", "--drain-grace", "0", NULL};
    daemon_process daemon;
    CHECK(daemon_start(&daemon, 1, arguments));
    const int stays = deaf_client(&daemon), goes = deaf_client(&daemon);
    close(goes);
    CHECK_INT(daemon_stop(&daemon), 0);
    close(stays);
}
