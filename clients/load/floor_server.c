/* floor_server.c: the bare server's loop: see floor.h. As little as can be: one poll set, one read and one write a
 * request, answers out of one piece of zeros. */
#include "load/floor.h"

#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { PLACE_LISTENER, PLACE_LIFELINE, PLACE_FIRST };

typedef struct peer {
    bool joined, sending;
    uint32_t group;
    uint32_t sent, size; /* of the answer that is on its way */
    uint32_t used;       /* of `in` */
    unsigned char head[FLOOR_ANSWER_SIZE];
    unsigned char in[FLOOR_REQUEST_MOST];
} peer;

typedef struct server {
    struct pollfd *polls; /* [count]; places as above, then the peers' */
    peer **peers;         /* [count]; NULL for the first places */
    size_t count, capacity;
    unsigned char *zeros; /* [zeros_size] */
    size_t zeros_size;
} server;

static bool server_grow(server *s)
{
    if (s->count < s->capacity) {
        return true;
    }
    const size_t capacity = s->capacity ? 2 * s->capacity : 64;
    struct pollfd *polls = realloc(s->polls, capacity * sizeof *polls);
    s->polls = polls ? polls : s->polls;
    peer **peers = realloc(s->peers, capacity * sizeof *peers);
    s->peers = peers ? peers : s->peers;
    s->capacity = polls && peers ? capacity : s->capacity;
    return polls && peers;
}

static bool server_add(server *s, int descriptor, peer *p)
{
    if (!server_grow(s)) {
        return false;
    }
    s->polls[s->count] = (struct pollfd){.fd = descriptor, .events = POLLIN};
    s->peers[s->count++] = p;
    return true;
}

static void server_drop(server *s, size_t i)
{
    close(s->polls[i].fd);
    free(s->peers[i]);
    s->count--;
    s->polls[i] = s->polls[s->count];
    s->peers[i] = s->peers[s->count];
}

static void server_accept(server *s)
{
    int yes = 1, descriptor;
    while ((descriptor = accept(s->polls[PLACE_LISTENER].fd, NULL, NULL)) >= 0) {
        peer *p = calloc(1, sizeof *p);
        int flags = fcntl(descriptor, F_GETFL);
        if (!p || flags < 0 || fcntl(descriptor, F_SETFL, flags | O_NONBLOCK) != 0 || !server_add(s, descriptor, p)) {
            free(p);
            close(descriptor);
            return;
        }
        setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    }
}

/* ---- answers ----------------------------------------------------------------------------------------------------- */

static bool server_zeros(server *s, size_t size)
{
    if (size > s->zeros_size) {
        unsigned char *larger = calloc(1, size);
        if (!larger) {
            return false;
        }
        free(s->zeros);
        s->zeros = larger;
        s->zeros_size = size;
    }
    return true;
}

/* Writes what the socket takes. False: the peer has gone. */
static bool peer_write(server *s, size_t i)
{
    peer *p = s->peers[i];
    while (p->sent < p->size) {
        const uint32_t head = p->sent < FLOOR_ANSWER_SIZE ? FLOOR_ANSWER_SIZE - p->sent : 0;
        struct iovec pieces[2] = {{p->head + FLOOR_ANSWER_SIZE - head, head}, {s->zeros, p->size - p->sent - head}};
        struct msghdr message = {.msg_iov = pieces, .msg_iovlen = 2};
        ssize_t sent = sendmsg(s->polls[i].fd, &message, MSG_NOSIGNAL);
        if (sent < 0 && errno != EINTR) {
            s->polls[i].events = POLLOUT; /* nothing more is read until this is out */
            return errno == EAGAIN || errno == EWOULDBLOCK;
        }
        p->sent += sent > 0 ? (uint32_t)sent : 0;
    }
    p->sending = false;
    s->polls[i].events = POLLIN;
    return true;
}

static bool peer_answer(server *s, size_t i, uint32_t size, uint64_t id)
{
    peer *p = s->peers[i];
    p->size = size;
    p->sent = 0;
    p->sending = true;
    floor_answer_write(&(floor_answer){size, id}, p->head);
    return peer_write(s, i);
}

/* Who still has a frame on the way is passed over; who has gone is found out by the next poll. */
static void server_fan(server *s, const floor_request *r)
{
    for (size_t i = PLACE_FIRST; i < s->count; i++) {
        if (s->peers[i]->joined && s->peers[i]->group == r->group && !s->peers[i]->sending) {
            peer_answer(s, i, r->answer, r->id);
        }
    }
}

static bool server_do(server *s, size_t i, const floor_request *r)
{
    switch (r->what) {
    case FLOOR_PING:
        return peer_answer(s, i, r->answer, r->id);
    case FLOOR_JOIN:
        s->peers[i]->joined = true;
        s->peers[i]->group = r->group;
        return true;
    case FLOOR_FAN:
        server_fan(s, r);
        return peer_answer(s, i, r->answer, r->id);
    default:
        return false;
    }
}

/* ---- requests ---------------------------------------------------------------------------------------------------- */

/* Does what has come whole, until an answer does not go out at once. False: the peer is to be dropped. */
static bool peer_requests(server *s, size_t i)
{
    peer *p = s->peers[i];
    uint32_t taken = 0;
    bool good = true;
    while (good && !p->sending && p->used - taken >= FLOOR_REQUEST_SIZE) {
        const floor_request r = floor_request_read(p->in + taken);
        if (r.size < FLOOR_REQUEST_SIZE || r.size > FLOOR_REQUEST_MOST || r.answer < FLOOR_ANSWER_SIZE ||
            r.answer > FLOOR_ANSWER_MOST || !server_zeros(s, r.answer)) {
            return false;
        }
        if (p->used - taken < r.size) {
            break;
        }
        taken += r.size;
        good = server_do(s, i, &r);
    }
    memmove(p->in, p->in + taken, p->used - taken);
    p->used -= taken;
    return good;
}

static bool peer_read(server *s, size_t i)
{
    peer *p = s->peers[i];
    ssize_t got = recv(s->polls[i].fd, p->in + p->used, sizeof p->in - p->used, 0);
    if (got <= 0) {
        return got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
    }
    p->used += (uint32_t)got;
    return peer_requests(s, i);
}

static bool peer_turn(server *s, size_t i)
{
    if (s->peers[i]->sending) {
        return peer_write(s, i) && (s->peers[i]->sending || peer_requests(s, i));
    }
    return peer_read(s, i);
}

void floor_serve(int listener, int lifeline)
{
    server s = {0};
    if (!server_add(&s, listener, NULL) || !server_add(&s, lifeline, NULL)) {
        return;
    }
    while (poll(s.polls, (nfds_t)s.count, -1) >= 0 || errno == EINTR) {
        if (s.polls[PLACE_LIFELINE].revents) {
            break;
        }
        for (size_t i = s.count; i-- > PLACE_FIRST;) {
            if (s.polls[i].revents && !peer_turn(&s, i)) {
                server_drop(&s, i);
            }
        }
        if (s.polls[PLACE_LISTENER].revents) {
            server_accept(&s);
        }
    }
    while (s.count > PLACE_FIRST) {
        server_drop(&s, s.count - 1);
    }
    close(listener);
    free(s.polls);
    free(s.peers);
    free(s.zeros);
}
