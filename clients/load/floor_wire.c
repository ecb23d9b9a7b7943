/* floor_wire.c: the bare server's messages, and how it comes to be: see floor.h. */
#include "load/floor.h"

#include "base/options.h"

#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

enum { FLOOR_BACKLOG = 1024 };

static void put_u32(unsigned char *at, uint32_t value)
{
    for (int i = 0; i < 4; i++) {
        at[i] = (unsigned char)(value >> (8 * i));
    }
}

static uint32_t get_u32(const unsigned char *at)
{
    return at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static void put_u64(unsigned char *at, uint64_t value)
{
    put_u32(at, (uint32_t)value);
    put_u32(at + 4, (uint32_t)(value >> 32));
}

static uint64_t get_u64(const unsigned char *at)
{
    return get_u32(at) | (uint64_t)get_u32(at + 4) << 32;
}

void floor_request_write(const floor_request *r, unsigned char bytes[FLOOR_REQUEST_SIZE])
{
    put_u32(bytes, r->size);
    put_u32(bytes + 4, r->answer);
    put_u32(bytes + 8, r->what);
    put_u32(bytes + 12, r->group);
    put_u64(bytes + 16, r->id);
}

floor_request floor_request_read(const unsigned char bytes[FLOOR_REQUEST_SIZE])
{
    return (floor_request){.size = get_u32(bytes),
                           .answer = get_u32(bytes + 4),
                           .what = get_u32(bytes + 8),
                           .group = get_u32(bytes + 12),
                           .id = get_u64(bytes + 16)};
}

void floor_answer_write(const floor_answer *a, unsigned char bytes[FLOOR_ANSWER_SIZE])
{
    put_u32(bytes, a->size);
    put_u32(bytes + 4, 0);
    put_u64(bytes + 8, a->id);
}

floor_answer floor_answer_read(const unsigned char bytes[FLOOR_ANSWER_SIZE])
{
    return (floor_answer){.size = get_u32(bytes), .id = get_u64(bytes + 8)};
}

/* ---- listening --------------------------------------------------------------------------------------------------- */

static int listen_at(const struct addrinfo *place)
{
    int yes = 1, descriptor = socket(place->ai_family, place->ai_socktype, place->ai_protocol);
    if (descriptor < 0) {
        return -1;
    }
    setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    int flags = fcntl(descriptor, F_GETFL);
    if (flags >= 0 && fcntl(descriptor, F_SETFL, flags | O_NONBLOCK) == 0 &&
        fcntl(descriptor, F_SETFD, FD_CLOEXEC) == 0 && bind(descriptor, place->ai_addr, place->ai_addrlen) == 0 &&
        listen(descriptor, FLOOR_BACKLOG) == 0) {
        return descriptor;
    }
    int why = errno;
    close(descriptor);
    errno = why;
    return -1;
}

static bool name_of(int descriptor, char bound[FLOOR_ADDRESS])
{
    struct sockaddr_storage place;
    socklen_t size = sizeof place;
    char host[FLOOR_ADDRESS - 10], port[8];
    if (getsockname(descriptor, (struct sockaddr *)&place, &size) != 0 ||
        getnameinfo((struct sockaddr *)&place, size, host, sizeof host, port, sizeof port,
                    NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
        return false;
    }
    const char *form = strchr(host, ':') ? "[%s]:%s" : "%s:%s";
    return snprintf(bound, FLOOR_ADDRESS, form, host, port) < FLOOR_ADDRESS;
}

int floor_listen(const char *address, char bound[FLOOR_ADDRESS], char *error, size_t error_size)
{
    char host[256], port[32];
    struct addrinfo hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM, .ai_flags = AI_PASSIVE}, *places;
    if (!options_split_address(address, host, sizeof host, port, sizeof port)) {
        snprintf(error, error_size, "\"%.100s\" is not an address: HOST:PORT is wanted", address);
        return -1;
    }
    int failure = getaddrinfo(host[0] ? host : "127.0.0.1", port, &hints, &places);
    if (failure != 0) {
        snprintf(error, error_size, "%.100s cannot be found: %s", address, gai_strerror(failure));
        return -1;
    }
    int descriptor = listen_at(places), why = errno;
    freeaddrinfo(places);
    if (descriptor < 0 || !name_of(descriptor, bound)) {
        snprintf(error, error_size, "cannot listen at %.100s: %s", address, strerror(descriptor < 0 ? why : errno));
        if (descriptor >= 0) {
            close(descriptor);
        }
        return -1;
    }
    return descriptor;
}

/* ---- a process of its own ---------------------------------------------------------------------------------------- */

bool floor_start(floor_process *p, char *error, size_t error_size)
{
    int line[2];
    *p = (floor_process){.lifeline = -1};
    int listener = floor_listen("127.0.0.1:0", p->address, error, error_size);
    if (listener < 0) {
        return false;
    }
    if (pipe(line) != 0) {
        snprintf(error, error_size, "no pipe to the bare server: %s", strerror(errno));
        close(listener);
        return false;
    }
    fflush(NULL);
    p->pid = fork();
    if (p->pid == 0) {
        close(line[1]);
        floor_serve(listener, line[0]);
        _exit(0);
    }
    close(line[0]);
    close(listener);
    p->lifeline = line[1];
    if (p->pid < 0) {
        snprintf(error, error_size, "no process for the bare server: %s", strerror(errno));
        close(line[1]);
        *p = (floor_process){0};
        return false;
    }
    return true;
}

void floor_stop(floor_process *p)
{
    if (p->pid > 0) {
        close(p->lifeline);
        waitpid(p->pid, NULL, 0);
    }
    *p = (floor_process){0};
}
