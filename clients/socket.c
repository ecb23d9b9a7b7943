/* socket.c: the one file of the client library with a socket.
 *
 * The socket never blocks: every wait is a poll with what is left of the deadline, so that a peer who is slow, silent
 * or never stops costs the caller no more. SIGPIPE is not touched: MSG_NOSIGNAL asks for an error instead. */
#include "socket.h"
#include "codec.h"
#include "base/options.h"

#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

int64_t socket_now_us(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

int socket_left_ms(int64_t deadline_us)
{
    int64_t left = deadline_us - socket_now_us();
    return left > 0 ? (int)((left + 999) / 1000) : 0;
}

/* Waits until the descriptor is ready for `events` (or has failed, which the next call on it will tell). */
static bool wait_for(int descriptor, short events, int64_t deadline_us)
{
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

static bool connect_within(int descriptor, const struct addrinfo *place, int64_t deadline_us)
{
    if (connect(descriptor, place->ai_addr, place->ai_addrlen) == 0) {
        return true;
    }
    if (errno != EINPROGRESS && errno != EINTR) {
        return false;
    }
    if (!wait_for(descriptor, POLLOUT, deadline_us)) {
        errno = ETIMEDOUT;
        return false;
    }
    int failure = 0;
    socklen_t size = sizeof failure;
    if (getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &failure, &size) != 0) {
        return false;
    }
    errno = failure;
    return failure == 0;
}

static bool make_ready(int descriptor)
{
    int yes = 1;
    int flags = fcntl(descriptor, F_GETFL);
    return flags >= 0 && fcntl(descriptor, F_SETFL, flags | O_NONBLOCK) == 0 &&
           fcntl(descriptor, F_SETFD, FD_CLOEXEC) == 0 &&
           setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes) == 0;
}

/* A connected descriptor, or -1 with the reason of the last place tried in errno. */
static int connect_any(const struct addrinfo *places, int64_t deadline_us)
{
    for (const struct addrinfo *place = places; place; place = place->ai_next) {
        int descriptor = socket(place->ai_family, place->ai_socktype, place->ai_protocol);
        if (descriptor < 0) {
            continue;
        }
        if (make_ready(descriptor) && connect_within(descriptor, place, deadline_us)) {
            return descriptor;
        }
        int failure = errno;
        close(descriptor);
        errno = failure;
    }
    return -1;
}

int socket_open(const char *address, int64_t deadline_us, awtclient_error *error)
{
    char host[256], port[32];
    if (!address || !options_split_address(address, host, sizeof host, port, sizeof port)) {
        awtcodec_fail(error, AWTCLIENT_ADDRESS, "\"%.100s\" is not an address: HOST:PORT is wanted",
                      address ? address : "");
        return -1;
    }
    struct addrinfo hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM};
    struct addrinfo *places = NULL;
    int failure = getaddrinfo(host[0] ? host : "localhost", port, &hints, &places);
    if (failure != 0) {
        awtcodec_fail(error, AWTCLIENT_ADDRESS, "%.100s cannot be found: %s", address, gai_strerror(failure));
        return -1;
    }
    int descriptor = connect_any(places, deadline_us);
    int reason = errno;
    freeaddrinfo(places);
    if (descriptor < 0) {
        awtcodec_fail(error, AWTCLIENT_ADDRESS, "nobody answers at %.100s (%s): is awtd running there?", address,
                      strerror(reason));
    }
    return descriptor;
}

void socket_close(int descriptor)
{
    if (descriptor >= 0) {
        close(descriptor);
    }
}

/* Takes `sent` bytes off the front of two pieces. */
static void advance(struct iovec pieces[2], size_t sent)
{
    for (int i = 0; i < 2; i++) {
        size_t part = sent < pieces[i].iov_len ? sent : pieces[i].iov_len;
        if (part > 0) {
            pieces[i].iov_base = (char *)pieces[i].iov_base + part;
            pieces[i].iov_len -= part;
            sent -= part;
        }
    }
}

/* POSIX gives iovec no const; sendmsg only reads. */
static struct iovec piece_of(proto_blob blob)
{
    return (struct iovec){.iov_base = blob.length > 0 ? (void *)(uintptr_t)blob.bytes : NULL, .iov_len = blob.length};
}

socket_result socket_send(int descriptor, proto_blob head, proto_blob tail, int64_t deadline_us)
{
    struct iovec pieces[2] = {piece_of(head), piece_of(tail)};
    while (pieces[0].iov_len + pieces[1].iov_len > 0) {
        struct msghdr header = {.msg_iov = pieces, .msg_iovlen = 2};
        ssize_t sent = sendmsg(descriptor, &header, MSG_NOSIGNAL);
        if (sent >= 0) {
            advance(pieces, (size_t)sent);
        } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
            if (!wait_for(descriptor, POLLOUT, deadline_us)) {
                return SOCKET_LATE;
            }
        } else if (errno != EINTR) {
            return SOCKET_ENDED;
        }
    }
    return SOCKET_DONE;
}

socket_result socket_receive(int descriptor, void *bytes, size_t size, size_t *got, int64_t deadline_us)
{
    while (wait_for(descriptor, POLLIN, deadline_us)) {
        ssize_t taken = recv(descriptor, bytes, size, 0);
        if (taken > 0) {
            *got = (size_t)taken;
            return SOCKET_DONE;
        }
        if (taken == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) {
            return SOCKET_ENDED;
        }
    }
    return SOCKET_LATE;
}
