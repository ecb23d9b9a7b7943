/* net.c: see net.h. */
#include "net.h"
#include "limits.h"

#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

static bool make_polite(int fd)
{
    int flags = fcntl(fd, F_GETFL);
    return flags >= 0 && fcntl(fd, F_SETFL, flags | O_NONBLOCK) == 0 && fcntl(fd, F_SETFD, FD_CLOEXEC) == 0;
}

bool net_pipe(int ends[2])
{
    if (pipe(ends) != 0) {
        return false;
    }
    if (make_polite(ends[0]) && make_polite(ends[1])) {
        return true;
    }
    close(ends[0]);
    close(ends[1]);
    return false;
}

uint64_t net_raise_descriptors(void)
{
    struct rlimit limit;
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0) {
        return 0;
    }
    const rlim_t before = limit.rlim_cur;
    limit.rlim_cur = limit.rlim_max;
    return setrlimit(RLIMIT_NOFILE, &limit) == 0 ? limit.rlim_cur : before;
}

static bool is_loopback(const struct sockaddr *address)
{
    if (address->sa_family == AF_INET) {
        struct sockaddr_in in;
        memcpy(&in, address, sizeof in);
        return ntohl(in.sin_addr.s_addr) >> 24 == 127;
    }
    if (address->sa_family == AF_INET6) {
        struct sockaddr_in6 in6;
        memcpy(&in6, address, sizeof in6);
        return IN6_IS_ADDR_LOOPBACK(&in6.sin6_addr);
    }
    return false;
}

static void address_text(const struct sockaddr *address, socklen_t size, char text[NET_ADDRESS])
{
    char host[64], port[8];
    if (getnameinfo(address, size, host, sizeof host, port, sizeof port, NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
        snprintf(text, NET_ADDRESS, "unknown");
        return;
    }
    snprintf(text, NET_ADDRESS, strchr(host, ':') ? "[%s]:%s" : "%s:%s", host, port);
}

/* -1 with errno. */
static int listen_on(const struct addrinfo *at)
{
    int fd = socket(at->ai_family, at->ai_socktype, at->ai_protocol);
    if (fd < 0) {
        return -1;
    }
    int yes = 1;
    if (make_polite(fd) && setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) == 0 &&
        bind(fd, at->ai_addr, at->ai_addrlen) == 0 && listen(fd, LIMIT_BACKLOG) == 0) {
        return fd;
    }
    int reason = errno;
    close(fd);
    errno = reason;
    return -1;
}

/* The place's addresses, every one of them allowed; NULL: `error` says why not. */
static struct addrinfo *find_addresses(const net_place *place, char *error, size_t error_size)
{
    struct addrinfo hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM, .ai_flags = AI_PASSIVE};
    struct addrinfo *found = NULL;
    int failure = getaddrinfo(place->host[0] ? place->host : NULL, place->port, &hints, &found);
    if (failure != 0) {
        snprintf(error, error_size, "--%s: %s:%s is not an address: %s", place->option, place->host, place->port,
                 gai_strerror(failure));
        return NULL;
    }
    for (const struct addrinfo *at = found; at; at = at->ai_next) {
        if (place->loopback_why && !is_loopback(at->ai_addr)) {
            snprintf(error, error_size, "--%s: %s can be reached from other machines; %s", place->option,
                     place->host[0] ? place->host : "an empty host", place->loopback_why);
            freeaddrinfo(found);
            return NULL;
        }
    }
    return found;
}

bool net_check(const net_place *place, char *error, size_t error_size)
{
    struct addrinfo *found = find_addresses(place, error, error_size);
    if (found) {
        freeaddrinfo(found);
    }
    return found != NULL;
}

int net_listen(const net_place *place, char bound[NET_ADDRESS], char *error, size_t error_size)
{
    struct addrinfo *found = find_addresses(place, error, error_size);
    int fd = -1;
    for (const struct addrinfo *at = found; at && fd < 0; at = at->ai_next) {
        fd = listen_on(at);
        if (fd < 0) {
            snprintf(error, error_size, "--%s: cannot listen on %s:%s: %s", place->option, place->host, place->port,
                     strerror(errno));
        }
    }
    if (found) {
        freeaddrinfo(found);
    }
    if (fd >= 0) {
        struct sockaddr_storage own = {0};
        socklen_t size = sizeof own;
        getsockname(fd, (struct sockaddr *)&own, &size);
        address_text((const struct sockaddr *)&own, size, bound);
    }
    return fd;
}

net_result net_accept(int listener, int *fd, char peer[NET_ADDRESS])
{
    struct sockaddr_storage far = {0};
    socklen_t size = sizeof far;
    *fd = accept(listener, (struct sockaddr *)&far, &size);
    if (*fd < 0) {
        switch (errno) {
        case EAGAIN:
            return NET_LATER;
        case EMFILE:
        case ENFILE:
        case ENOBUFS:
        case ENOMEM:
            return NET_EXHAUSTED;
        default:
            return NET_FAILED;
        }
    }
    int yes = 1;
    if (!make_polite(*fd) || setsockopt(*fd, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes) != 0) {
        close(*fd);
        return NET_FAILED;
    }
    address_text((const struct sockaddr *)&far, size, peer);
    return NET_DONE;
}

net_result net_receive(int fd, void *bytes, size_t size, size_t *got)
{
    ssize_t result;
    do {
        result = recv(fd, bytes, size, 0);
    } while (result < 0 && errno == EINTR);
    *got = result > 0 ? (size_t)result : 0;
    if (result < 0) {
        return errno == EAGAIN ? NET_LATER : NET_FAILED;
    }
    return result == 0 ? NET_ENDED : NET_DONE;
}

net_result net_send(int fd, const struct iovec *pieces, size_t count, size_t *sent)
{
    /* sendmsg does not write through msg_iov, but its type does not say so */
    struct msghdr message = {.msg_iov = (struct iovec *)(uintptr_t)pieces};
    message.msg_iovlen = count;
    ssize_t result;
    do {
        result = sendmsg(fd, &message, MSG_NOSIGNAL);
    } while (result < 0 && errno == EINTR);
    *sent = result > 0 ? (size_t)result : 0;
    if (result < 0) {
        return errno == EAGAIN || errno == ENOBUFS ? NET_LATER : NET_FAILED;
    }
    return NET_DONE;
}

void net_end_sending(int fd)
{
    shutdown(fd, SHUT_WR);
}
