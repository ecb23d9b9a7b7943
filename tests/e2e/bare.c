/* bare.c: see bare.h. */
#include "e2e/bare.h"

#include "check.h"
#include "e2e/daemon.h"

#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

enum { PATIENCE_S = 30, STRANDS = 200, ANSWER = 1 << 20 };

bool bare_send(int fd, const proto_message *message)
{
    unsigned char bytes[BARE_MESSAGE];
    const size_t size = proto_encode(message, bytes, sizeof bytes);
    return size > 0 && send(fd, bytes, size, MSG_NOSIGNAL) == (ssize_t)size;
}

static bool receive(int fd, unsigned char *bytes, size_t size)
{
    for (size_t got = 0; got < size;) {
        const ssize_t now = recv(fd, bytes + got, size - got, 0);
        if (now <= 0) {
            return false;
        }
        got += (size_t)now;
    }
    return true;
}

bool bare_ask(int fd, const proto_message *message, proto_message *answer)
{
    static unsigned char bytes[ANSWER];
    if (!bare_send(fd, message)) {
        return false;
    }
    for (;;) {
        if (!receive(fd, bytes, PROTO_HEADER_SIZE)) {
            return false;
        }
        const proto_header header = proto_header_read(bytes);
        if (header.length > sizeof bytes - PROTO_HEADER_SIZE ||
            !receive(fd, bytes + PROTO_HEADER_SIZE, header.length) ||
            proto_decode(&header, bytes + PROTO_HEADER_SIZE, answer, NULL) != 0) {
            return false;
        }
        if (answer->request == message->request && answer->type != PROTO_PROGRESS) {
            return true;
        }
    }
}

int bare_open(const char *address, unsigned char session[BARE_SESSION])
{
    const struct timeval patience = {.tv_sec = PATIENCE_S};
    proto_message hello = {.type = PROTO_HELLO, .flags = PROTO_FLAG_REQUIRED, .request = 1}, answer;
    memcpy(hello.as.hello.magic, PROTO_MAGIC, sizeof hello.as.hello.magic);
    hello.as.hello.lowest_version = hello.as.hello.highest_version = PROTO_VERSION;
    hello.as.hello.client = proto_str_of("bare");
    hello.as.hello.length = (uint16_t)(proto_encoded_size(&hello) - PROTO_HEADER_SIZE);
    const int fd = daemon_socket_to(address);
    if (fd < 0) {
        return -1;
    }
    setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    if (!bare_ask(fd, &hello, &answer) || answer.type != PROTO_WELCOME) {
        close(fd);
        return -1;
    }
    if (session) {
        memcpy(session, answer.as.welcome.session, BARE_SESSION);
    }
    return fd;
}

uint64_t bare_create(int fd, uint64_t seed)
{
    proto_message create = {.type = PROTO_CREATE, .flags = PROTO_FLAG_REQUIRED, .request = 2}, answer;
    create.as.create.style = proto_str_of("long");
    create.as.create.seed = seed;
    create.as.create.strands = STRANDS;
    create.as.create.head.orientation[3] = create.as.create.body.orientation[3] = 1;
    return bare_ask(fd, &create, &answer) && answer.type == PROTO_CREATE_REPLY ? answer.as.create_reply.forest : 0;
}

struct proto_stats_reply bare_stats(int fd)
{
    const proto_message stats = {.type = PROTO_STATS, .flags = PROTO_FLAG_REQUIRED, .request = 3};
    proto_message answer = {0};
    CHECK(bare_ask(fd, &stats, &answer) && answer.type == PROTO_STATS_REPLY);
    return answer.as.stats_reply;
}

long bare_resident_kib(long pid)
{
    char path[64], line[256];
    long kib = 0;
    snprintf(path, sizeof path, "/proc/%ld/status", pid);
    FILE *status = fopen(path, "r");
    while (status && kib == 0 && fgets(line, sizeof line, status)) {
        sscanf(line, "VmRSS: %ld kB", &kib);
    }
    if (status) {
        fclose(status);
    }
    return kib;
}
