/* relay.c: awt-relay: a bad line between a client and a daemon, for tests and for trying: it forwards TCP connections
 * with a delay, jitter and a limit of bytes a second in each direction.
 *
 * One thread, one poll. A connection is two sockets and two lanes (lane.h); when one end has closed and its lane has
 * run dry, both are closed. On SIGTERM it says by how much it was late itself: then the machine was busy, not the line
 * bad. */
#include "relay/lane.h"

#include "base/options.h"

#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { RELAY_CONNECTIONS = 64, RELAY_MIN_QUEUE = LANE_PIECE };

/* One end: what it reads goes into `lane`, whose due bytes are written to the other end. */
typedef struct relay_end {
    int fd;
    bool ended; /* it sends no more */
    lane lane;
} relay_end;

typedef struct relay_pair {
    bool used;
    relay_end ends[2]; /* the client's, the daemon's */
} relay_pair;

typedef struct relay {
    int listener;
    struct addrinfo *target;
    lane_rules rules;
    uint64_t seed;
    int64_t latest_us; /* after a piece was due it was sent */
    relay_pair pairs[RELAY_CONNECTIONS];
} relay;

static volatile sig_atomic_t ended;

static void end(int signal_number)
{
    (void)signal_number;
    ended = 1;
}

static int64_t now_us(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

static bool make_ready(int fd)
{
    int yes = 1, flags = fcntl(fd, F_GETFL);
    return flags >= 0 && fcntl(fd, F_SETFL, flags | O_NONBLOCK) == 0 &&
           setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes) == 0;
}

/* ---- connections ----------------------------------------------------------------------------------------- */

static void close_pair(relay_pair *pair)
{
    for (int i = 0; i < 2; i++) {
        if (pair->ends[i].fd >= 0) {
            close(pair->ends[i].fd);
        }
        lane_fini(&pair->ends[i].lane);
    }
    *pair = (relay_pair){.used = false};
}

/* A connection to the daemon, or -1. The daemon is near: it is the relay that makes the way long. */
static int connect_target(const relay *self)
{
    int fd = socket(self->target->ai_family, SOCK_STREAM, 0);
    if (fd >= 0 && (connect(fd, self->target->ai_addr, self->target->ai_addrlen) != 0 || !make_ready(fd))) {
        close(fd);
        fd = -1;
    }
    return fd;
}

static void accept_client(relay *self)
{
    int fd = accept(self->listener, NULL, NULL);
    relay_pair *pair = NULL;
    for (int i = 0; i < RELAY_CONNECTIONS && !pair; i++) {
        pair = self->pairs[i].used ? NULL : &self->pairs[i];
    }
    if (fd < 0 || !pair || !make_ready(fd)) {
        if (fd >= 0) {
            close(fd);
        }
        return;
    }
    pair->used = true;
    pair->ends[0].fd = fd;
    pair->ends[1].fd = connect_target(self);
    const bool made = lane_init(&pair->ends[0].lane, &self->rules, self->seed++) &&
                      lane_init(&pair->ends[1].lane, &self->rules, self->seed++);
    if (!made || pair->ends[1].fd < 0) {
        close_pair(pair);
    }
}

/* ---- forwarding ------------------------------------------------------------------------------------------ */

static void read_end(relay_end *end)
{
    unsigned char *room;
    while (!end->ended && (room = lane_room(&end->lane)) != NULL) {
        ssize_t got = recv(end->fd, room, LANE_PIECE, 0);
        if (got > 0) {
            lane_put(&end->lane, (size_t)got, now_us());
        } else if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) {
            return;
        } else {
            end->ended = true;
        }
    }
}

/* Writes what is due of one end's lane to the other. False: that one is gone. */
static bool write_due(relay_end *from, const relay_end *to, int64_t *latest_us)
{
    size_t size;
    const unsigned char *bytes;
    while ((bytes = lane_due(&from->lane, now_us(), &size)) != NULL) {
        const int64_t late_us = now_us() - lane_next_us(&from->lane);
        *latest_us = late_us > *latest_us ? late_us : *latest_us;
        ssize_t sent = send(to->fd, bytes, size, MSG_NOSIGNAL);
        if (sent < 0) {
            return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
        }
        lane_sent(&from->lane, (size_t)sent);
    }
    return true;
}

static void forward(relay_pair *pair, int64_t *latest_us)
{
    bool lost = false, drained = false;
    for (int i = 0; i < 2; i++) {
        relay_end *from = &pair->ends[i];
        read_end(from);
        lost = lost || !write_due(from, &pair->ends[1 - i], latest_us);
        drained = drained || (from->ended && from->lane.count == 0);
    }
    if (lost || drained) {
        close_pair(pair);
    }
}

/* ---- the loop -------------------------------------------------------------------------------------------- */

static int fill_polls(relay *self, struct pollfd *polls, int64_t *next_us)
{
    int count = 0;
    polls[count++] = (struct pollfd){.fd = self->listener, .events = POLLIN};
    *next_us = INT64_MAX;
    const int64_t now = now_us();
    for (relay_pair *pair = self->pairs; pair < self->pairs + RELAY_CONNECTIONS; pair++) {
        for (int i = 0; pair->used && i < 2; i++) {
            const relay_end *end = &pair->ends[i], *other = &pair->ends[1 - i];
            size_t waiting;
            lane_due(&other->lane, now, &waiting);
            const bool full = end->lane.count == end->lane.capacity;
            const int wanted = (end->ended || full ? 0 : POLLIN) | (waiting > 0 ? POLLOUT : 0);
            if (wanted) {
                polls[count++] = (struct pollfd){.fd = end->fd, .events = (short)wanted};
            }
            if (waiting == 0 && lane_next_us(&other->lane) < *next_us) {
                *next_us = lane_next_us(&other->lane);
            }
        }
    }
    return count;
}

static void run(relay *self)
{
    struct pollfd polls[1 + 2 * RELAY_CONNECTIONS];
    while (!ended) {
        int64_t next_us;
        const int count = fill_polls(self, polls, &next_us);
        const int64_t left_us = next_us == INT64_MAX ? INT64_MAX : next_us - now_us();
        const int left_ms = next_us == INT64_MAX ? -1 : left_us > 0 ? (int)((left_us + 999) / 1000) : 0;
        if (poll(polls, (nfds_t)count, left_ms) < 0) {
            continue; /* a signal: `polls` say nothing */
        }
        if (polls[0].revents) {
            accept_client(self);
        }
        for (relay_pair *pair = self->pairs; pair < self->pairs + RELAY_CONNECTIONS; pair++) {
            if (pair->used) {
                forward(pair, &self->latest_us);
            }
        }
    }
}

/* ---- the beginning --------------------------------------------------------------------------------------- */

static struct addrinfo *resolve(const char *address, int flags)
{
    char host[256], port[32];
    struct addrinfo hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM, .ai_flags = flags}, *list = NULL;
    if (!options_split_address(address, host, sizeof host, port, sizeof port) ||
        getaddrinfo(host[0] ? host : "localhost", port, &hints, &list) != 0) {
        return NULL;
    }
    return list;
}

static bool listen_at(relay *self, const char *address)
{
    struct addrinfo *place = resolve(address, AI_PASSIVE);
    int yes = 1;
    if (!place) {
        return false;
    }
    self->listener = socket(place->ai_family, SOCK_STREAM, 0);
    bool good = self->listener >= 0 && setsockopt(self->listener, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) == 0 &&
                bind(self->listener, place->ai_addr, place->ai_addrlen) == 0 && listen(self->listener, 16) == 0 &&
                make_ready(self->listener);
    freeaddrinfo(place);
    return good;
}

static bool print_place(const relay *self)
{
    struct sockaddr_storage place;
    socklen_t size = sizeof place;
    char host[64], port[16];
    if (getsockname(self->listener, (struct sockaddr *)&place, &size) != 0 ||
        getnameinfo((struct sockaddr *)&place, size, host, sizeof host, port, sizeof port,
                    NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
        return false;
    }
    printf(place.ss_family == AF_INET6 ? "listening on [%s]:%s\n" : "listening on %s:%s\n", host, port);
    return fflush(stdout) == 0;
}

int main(int argc, char **argv)
{
    static relay self;
    const char *listen_text = "127.0.0.1:0", *target = "";
    double delay_ms = 0, jitter_ms = 0, rate = 0;
    long long queue = 256 << 10, seed = 1;
    const option options[] = {
        {"listen", OPTION_TEXT, "HOST:PORT", &listen_text, 0, 0, "where clients come; port 0: any"},
        {"connect", OPTION_TEXT, "HOST:PORT", &target, 0, 0, "where the daemon is"},
        {"delay", OPTION_REAL, "MS", &delay_ms, 0, 60000, "in each direction"},
        {"jitter", OPTION_REAL, "MS", &jitter_ms, 0, 60000, "added to the delay, uniform from 0; order is kept"},
        {"rate", OPTION_REAL, "BYTES_PER_S", &rate, 0, 1e12, "in each direction; 0: no limit"},
        {"queue", OPTION_INTEGER, "BYTES", &queue, RELAY_MIN_QUEUE, 1 << 28, "on the way in each direction at most"},
        {"seed", OPTION_INTEGER, "N", &seed, 0, 1LL << 53, "of the jitter"},
    };
    const option_program program = {"awt-relay", "forwards TCP connections over a line as bad as you like", NULL,
                                    options, sizeof options / sizeof options[0]};
    size_t operands;
    int code;
    if (!options_begin(&program, argc - 1, argv + 1, NULL, 0, &operands, &code)) {
        return code;
    }
    self.rules = (lane_rules){(int64_t)(delay_ms * 1000), (int64_t)(jitter_ms * 1000), rate, (size_t)queue};
    self.seed = (uint64_t)seed;
    self.target = resolve(target, 0);
    if (!self.target) {
        fprintf(stderr, "awt-relay: --connect \"%s\" is no address that can be found: HOST:PORT is wanted\n", target);
        return 1;
    }
    if (!listen_at(&self, listen_text) || !print_place(&self)) {
        fprintf(stderr, "awt-relay: cannot listen on %s: %s\n", listen_text, strerror(errno));
        return 1;
    }
    struct sigaction action = {.sa_handler = end};
    sigaction(SIGTERM, &action, NULL);
    run(&self);
    printf("late by %.1f ms at most\n", (double)self.latest_us / 1000);
    return 0;
}
