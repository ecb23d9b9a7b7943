/* test_e2e_flood.c: clients that send as fast as they can, and read or do not: the daemon's memory stays within bounds,
 * and another client's frames keep coming, with the same bits. */
#define _DEFAULT_SOURCE /* MAP_ANONYMOUS */
#include "check.h"
#include "e2e/bare.h"
#include "e2e/kept.h"

#include <poll.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

enum { STEPS = 40, ROUNDS = 3, GROWTH_KIB = 64 * 1024, LEAST_FLOOD = 1 << 20 /* bytes */ };

/* What a flood is made of, and whether the answers are read. */
typedef enum flood_kind { POSES_AND_STEPS, LOOKS_UNREAD, PINGS, PINGS_UNREAD, POSES_UNREAD, FLOODS } flood_kind;

typedef struct flood {
    flood_kind kind;
    int fd;
    uint64_t forest;
    uint32_t said;
    size_t size, at; /* of what is being sent */
    unsigned char bytes[BARE_MESSAGE];
} flood;

static bool is_read(flood_kind kind)
{
    return kind == POSES_AND_STEPS || kind == PINGS;
}

static void say_pose(flood *f, proto_message *message)
{
    struct proto_motion *motion = &message->as.motion;
    message->type = PROTO_MOTION;
    motion->forest = f->forest;
    motion->sequence = f->said;
    motion->time_us = (int64_t)f->said * 1000;
    motion->head.position[0] = motion->body.position[0] = 0.01 * (f->said % 5);
    motion->head.orientation[3] = motion->body.orientation[3] = 1;
}

static void say_next(flood *f)
{
    proto_message message = {.type = PROTO_PING, .flags = PROTO_FLAG_REQUIRED, .request = ++f->said};
    const bool looks = f->kind == LOOKS_UNREAD, moves = f->kind == POSES_AND_STEPS || f->kind == POSES_UNREAD;
    if (moves && f->said % 4 != 0) {
        say_pose(f, &message);
    } else if (looks || moves) {
        message.type = PROTO_QUERY;
        message.as.query.forest = f->forest;
        message.as.query.latest = looks;
        message.as.query.time_us = (int64_t)(f->said - 1) * 1000;
    }
    f->size = proto_encode(&message, f->bytes, sizeof f->bytes);
    f->at = 0;
}

/* Sends and reads what goes. How many bytes went out. */
static size_t pour(flood *f)
{
    static unsigned char heard[65536];
    size_t poured = 0;
    while (is_read(f->kind) && recv(f->fd, heard, sizeof heard, MSG_DONTWAIT) > 0) {
    }
    for (int n = 0; n < 1000; n++) {
        if (f->at == f->size) {
            say_next(f);
        }
        const ssize_t sent = send(f->fd, f->bytes + f->at, f->size - f->at, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (sent <= 0) {
            break;
        }
        f->at += (size_t)sent;
        poured += (size_t)sent;
    }
    return poured;
}

/* Goes on until it is killed. */
static void pour_all(flood *floods, atomic_ullong *poured)
{
    for (;;) {
        struct pollfd polled[FLOODS];
        for (int i = 0; i < FLOODS; i++) {
            *poured += pour(&floods[i]);
            polled[i] = (struct pollfd){.fd = floods[i].fd,
                                        .events = (short)(POLLOUT | (is_read(floods[i].kind) ? POLLIN : 0))};
        }
        poll(polled, FLOODS, 1000);
    }
}

/* A process of its own; bytes that it has sent are counted in *poured. */
static pid_t start_floods(const daemon_process *daemon, flood floods[FLOODS], atomic_ullong *poured)
{
    for (int i = 0; i < FLOODS; i++) {
        floods[i] = (flood){.kind = (flood_kind)i, .fd = bare_open(daemon->address, NULL)};
        floods[i].forest = bare_create(floods[i].fd, (uint64_t)i);
        CHECK(floods[i].fd >= 0 && floods[i].forest != 0);
    }
    const pid_t pid = fork();
    if (pid == 0) {
        pour_all(floods, poured);
    }
    return pid;
}

/* With as little as can be of what was freed held back: the sanitizer's is memory too. */
static bool start_lean(daemon_process *daemon, const char *const *arguments)
{
    char options[512];
    const char *before = getenv("ASAN_OPTIONS");
    snprintf(options, sizeof options, "%s", before ? before : "");
    setenv("ASAN_OPTIONS", "quarantine_size_mb=1", 1);
    const bool up = daemon_start(daemon, 1, arguments);
    CHECK_INT(before ? setenv("ASAN_OPTIONS", options, 1) : unsetenv("ASAN_OPTIONS"), 0);
    return up;
}

TEST(e2e_floods_take_bounded_memory_and_nobody_elses_frames_change)
{
    const char *const arguments[] = {"--no-auth", NULL};
    daemon_process daemon;
    flood floods[FLOODS];
    uint32_t calm = 0, flooded = 0;
    uint64_t forests[1 + ROUNDS];
    CHECK(start_lean(&daemon, arguments));
    atomic_ullong *poured = mmap(NULL, sizeof *poured, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    CHECK(poured != MAP_FAILED);
    awtclient *client = daemon_client(&daemon);
    /* Before the floods: new forests are refused where the workers have too much to do. */
    for (int k = 0; k <= ROUNDS; k++) {
        forests[k] = kept_create(client, 3).forest;
    }
    CHECK(kept_drive(client, forests[ROUNDS], 1, STEPS, &calm));
    const pid_t pid = start_floods(&daemon, floods, poured);
    const long before = bare_resident_kib(daemon.pid);
    long most = before;
    for (int round = 0; round < ROUNDS; round++) {
        CHECK(kept_drive(client, forests[round], 1, STEPS, &flooded));
        CHECK_INT(flooded, calm);
        const long now = bare_resident_kib(daemon.pid);
        most = now > most ? now : most;
    }
    CHECK(waitpid(pid, NULL, WNOHANG) == 0); /* they go on to the end */
    kill(pid, SIGKILL);
    waitpid(pid, NULL, 0);
    printf("   %llu KiB sent in floods; the daemon grew by %ld KiB\n", *poured / 1024, most - before);
    CHECK(*poured > LEAST_FLOOD);
    CHECK(most - before < GROWTH_KIB);
    for (int i = 0; i < FLOODS; i++) {
        close(floods[i].fd);
    }
    munmap(poured, sizeof *poured);
    awtclient_close(client);
    CHECK_INT(daemon_stop(&daemon), 0);
}
