/* socket.c: the one file of the client library with a socket.
 *
 * The socket never blocks: whoever wants to wait does so in socket_wait, by a poll with what is left of a deadline.
 * SIGPIPE is not touched: MSG_NOSIGNAL asks for an error instead. */
#include "socket.h"
#include "codec.h"
#include "base/options.h"

#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#define LONGEST_WAIT_US INT64_C(3600000000) /* of one poll; whoever waits longer polls again */

typedef struct socket_state {
    struct addrinfo *places; /* where the address may be; NULL once connected */
    const struct addrinfo *next;
    int descriptor; /* -1: none */
    int reason;     /* errno of the last place that did not take it */
    char address[128];
} socket_state;

int64_t socket_now_us(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

int64_t awtclient_now_us(void)
{
    return socket_now_us();
}

int socket_left_ms(int64_t deadline_us)
{
    int64_t left_us = deadline_us - socket_now_us();
    if (left_us <= 0) {
        return 0;
    }
    return left_us < LONGEST_WAIT_US ? (int)((left_us + 999) / 1000) : (int)(LONGEST_WAIT_US / 1000);
}

bool socket_wait(int descriptor, unsigned wanted, int64_t deadline_us)
{
    short events = (short)((wanted & AWTLINK_READ ? POLLIN : 0) | (wanted & AWTLINK_WRITE ? POLLOUT : 0));
    for (;;) {
        struct pollfd entry = {.fd = descriptor, .events = events};
        int left = socket_left_ms(deadline_us);
        int ready = poll(&entry, 1, left);
        if (ready > 0) {
            return true;
        }
        if (left == 0 || (ready < 0 && errno != EINTR)) {
            return false;
        }
    }
}

/* ---- connecting -------------------------------------------------------------------------------------- */

static bool make_ready(int descriptor)
{
    int yes = 1;
    int flags = fcntl(descriptor, F_GETFL);
    return flags >= 0 && fcntl(descriptor, F_SETFL, flags | O_NONBLOCK) == 0 &&
           fcntl(descriptor, F_SETFD, FD_CLOEXEC) == 0 &&
           setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes) == 0;
}

/* The failure may pass. */
static bool not_yet(awtclient_error *error)
{
    if (error) {
        error->retry = true;
    }
    return false;
}

static void drop_descriptor(socket_state *self)
{
    if (self->descriptor >= 0) {
        close(self->descriptor);
        self->descriptor = -1;
    }
}

static bool begin_at(socket_state *self, const struct addrinfo *place)
{
    self->descriptor = socket(place->ai_family, place->ai_socktype, place->ai_protocol);
    if (self->descriptor >= 0 && make_ready(self->descriptor) &&
        (connect(self->descriptor, place->ai_addr, place->ai_addrlen) == 0 || errno == EINPROGRESS || errno == EINTR)) {
        return true;
    }
    self->reason = errno;
    drop_descriptor(self);
    return false;
}

/* Begins at the next place that does not refuse at once. False: there is none left. */
static bool begin_next(socket_state *self, awtclient_error *error)
{
    while (self->next) {
        const struct addrinfo *place = self->next;
        self->next = place->ai_next;
        if (begin_at(self, place)) {
            return true;
        }
    }
    awtcodec_fail(error, AWTCLIENT_ADDRESS, "nobody answers at %.100s (%s): is awtd running there?", self->address,
                  strerror(self->reason));
    return not_yet(error);
}

/* Positive: connected; else what send and receive are to answer. */
static long connected(socket_state *self, awtclient_error *error)
{
    while (self->places) {
        if (self->descriptor >= 0 && !socket_wait(self->descriptor, AWTLINK_WRITE, 0)) {
            return AWTLINK_WANT_WRITE;
        }
        int failure = self->reason; /* of the last place, where none is left */
        socklen_t size = sizeof failure;
        if (self->descriptor >= 0 && getsockopt(self->descriptor, SOL_SOCKET, SO_ERROR, &failure, &size) == 0 &&
            failure == 0) {
            freeaddrinfo(self->places);
            self->places = NULL;
            break;
        }
        self->reason = failure;
        drop_descriptor(self);
        if (!begin_next(self, error)) {
            return AWTLINK_FAILED;
        }
    }
    return 1;
}

/* ---- the transport ----------------------------------------------------------------------------------- */

static bool would_block(void)
{
    return errno == EAGAIN || errno == EWOULDBLOCK;
}

static long transport_send(void *context, const void *bytes, size_t size, awtclient_error *error)
{
    socket_state *self = context;
    long state = connected(self, error);
    while (state > 0) {
        ssize_t sent = send(self->descriptor, bytes, size, MSG_NOSIGNAL);
        if (sent > 0) {
            return (long)sent;
        }
        if (sent == 0 || would_block()) {
            return AWTLINK_WANT_WRITE;
        }
        if (errno != EINTR) {
            return AWTLINK_FAILED;
        }
    }
    return state;
}

static long transport_receive(void *context, void *bytes, size_t size, awtclient_error *error)
{
    socket_state *self = context;
    long state = connected(self, error);
    while (state > 0) {
        ssize_t taken = recv(self->descriptor, bytes, size, 0);
        if (taken >= 0) {
            return (long)taken; /* 0 is AWTLINK_ENDED */
        }
        if (would_block()) {
            return AWTLINK_WANT_READ;
        }
        if (errno != EINTR) {
            return AWTLINK_FAILED;
        }
    }
    return state;
}

static int transport_descriptor(void *context)
{
    return ((const socket_state *)context)->descriptor;
}

static void transport_close(void *context)
{
    socket_state *self = context;
    drop_descriptor(self);
    if (self->places) {
        freeaddrinfo(self->places);
    }
    free(self);
}

static bool resolve(socket_state *self, const char *address, awtclient_error *error)
{
    char host[256], port[32];
    if (!address || !options_split_address(address, host, sizeof host, port, sizeof port)) {
        return awtcodec_fail(error, AWTCLIENT_ADDRESS, "\"%.100s\" is not an address: HOST:PORT is wanted",
                             address ? address : "");
    }
    struct addrinfo hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM};
    int failure = getaddrinfo(host[0] ? host : "localhost", port, &hints, &self->places);
    if (failure != 0) {
        self->places = NULL;
        awtcodec_fail(error, AWTCLIENT_ADDRESS, "%.100s cannot be found: %s", address, gai_strerror(failure));
        return not_yet(error);
    }
    self->next = self->places;
    proto_str_copy(proto_str_of(address), self->address, sizeof self->address);
    return true;
}

bool socket_begin(const char *address, awtlink_transport *out, awtclient_error *error)
{
    socket_state *self = calloc(1, sizeof *self);
    if (!self) {
        return awtcodec_fail(error, AWTCLIENT_MEMORY, "not enough memory");
    }
    self->descriptor = -1;
    if (!resolve(self, address, error) || !begin_next(self, error)) {
        transport_close(self);
        return false;
    }
    *out = (awtlink_transport){.context = self,
                               .send = transport_send,
                               .receive = transport_receive,
                               .descriptor = transport_descriptor,
                               .close = transport_close};
    return true;
}
