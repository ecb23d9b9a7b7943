/* wire_fixture.c: see wire_fixture.h. */
#include "unit/wire_fixture.h"

#include "base/assert.h"
#include "completions.h"
#include "unit/server_fixture.h"
#include "upkeep.h"

#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { BEGIN_US = 1000000, GRACE_US = 5000000, SETTLED = 10000 /* turns after which nothing may move any more */ };

bool wire_begin(wire *w, uint32_t max_forests)
{
    w->homes = (homes){0};
    fake_now_us = BEGIN_US;
    for (int i = 0; i < WIRE_CLIENTS; i++) {
        w->clients[i].served = NULL;
        w->clients[i].fd = -1;
    }
    if (!fake_service_init(&w->shared, 0, max_forests, true)) {
        return false;
    }
    w->shared.options.resume_grace_us = GRACE_US;
    if (!homes_init(&w->homes, 1)) {
        service_fini(&w->shared);
        return false;
    }
    return true;
}

void wire_end(wire *w)
{
    for (int i = 0; i < WIRE_CLIENTS; i++) {
        wire_cut(w, i);
    }
    wire_settle(w);
    wire_pass(w, GRACE_US); /* nobody comes back */
    service_fini(&w->shared);
    homes_fini(&w->homes);
    fake_now_us = BEGIN_US;
}

/* ---- the clients' ends ------------------------------------------------------------------------------------------- */

bool wire_connect(wire *w, int i, void (*hear)(void *context, const proto_message *message), void *context)
{
    int ends[2];
    wire_client *c = &w->clients[i];
    ASSERT(!c->served && c->fd < 0);
    ASSERT(socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0);
    for (int k = 0; k < 2; k++) {
        ASSERT(fcntl(ends[k], F_SETFL, fcntl(ends[k], F_GETFL) | O_NONBLOCK) == 0);
    }
    c->served = connection_create(&w->shared, ends[0], "test");
    if (!c->served) {
        close(ends[1]);
        return false;
    }
    c->fd = ends[1];
    c->hear = hear;
    c->context = context;
    c->size = 0;
    c->idle = c->deaf = false;
    service_lock(&w->shared);
    connection_enter(c->served, homes_hot(&w->homes));
    service_unlock(&w->shared);
    return true;
}

void wire_cut(wire *w, int i)
{
    wire_client *c = &w->clients[i];
    if (c->fd >= 0) {
        close(c->fd);
        c->fd = -1;
    }
}

bool wire_is_there(const wire *w, int i)
{
    return w->clients[i].fd >= 0;
}

/* What has come whole. */
static void take_messages(wire_client *c)
{
    size_t at = 0;
    while (c->size - at >= PROTO_HEADER_SIZE) {
        static proto_message message;
        const proto_header header = proto_header_read(c->bytes + at);
        ASSERT(header.length <= WIRE_BYTES - PROTO_HEADER_SIZE);
        if (c->size - at < PROTO_HEADER_SIZE + (size_t)header.length) {
            break;
        }
        ASSERT(proto_decode(&header, c->bytes + at + PROTO_HEADER_SIZE, &message, NULL) == 0);
        c->hear(c->context, &message);
        at += PROTO_HEADER_SIZE + header.length;
    }
    memmove(c->bytes, c->bytes + at, c->size - at);
    c->size -= at;
}

/* False: nothing has come. */
static bool hear(wire *w, int i)
{
    wire_client *c = &w->clients[i];
    if (c->fd < 0 || c->deaf) {
        return false;
    }
    const ssize_t got = recv(c->fd, c->bytes + c->size, WIRE_BYTES - c->size, 0);
    if (got == 0) {
        wire_cut(w, i);
    } else if (got > 0) {
        c->size += (size_t)got;
        take_messages(c);
    }
    return got >= 0;
}

/* ---- the daemon's ------------------------------------------------------------------------------------------------ */

static wire_client *client_of(wire *w, const connection *served)
{
    for (int i = 0; i < WIRE_CLIENTS; i++) {
        if (w->clients[i].served == served) {
            return &w->clients[i];
        }
    }
    ASSERT(false);
    return NULL;
}

/* As a loop does. */
static void give_turn(wire *w, connection *c, int revents)
{
    wire_client *client = client_of(w, c);
    connection_turn(c, revents);
    const connection_fate fate = connection_fate_of(c);
    service_lock(&w->shared);
    const bool leaves = fate == CONNECTION_MOVES && connection_leave(c);
    const bool closed = fate == CONNECTION_ENDS && connection_close(c);
    if (leaves) {
        client->idle = !client->idle;
        connection_enter(c, client->idle ? homes_cold(&w->homes) : homes_hot(&w->homes));
    }
    service_unlock(&w->shared);
    if (closed) {
        client->served = NULL;
        connection_destroy(c);
    }
}

static bool give_told_turns(wire *w, home *h)
{
    bool moved = false;
    for (connection *c; (c = home_take(h)) != NULL; moved = true) {
        give_turn(w, c, 0);
    }
    return moved;
}

static bool give_turns(wire *w)
{
    bool moved = false;
    for (int i = 0; i < WIRE_CLIENTS; i++) {
        connection *c = w->clients[i].served;
        const int events = c ? connection_events(c) : -1;
        struct pollfd p = {.fd = events < 0 ? -1 : connection_descriptor(c),
                           .events = (short)(events < 0 ? 0 : events)};
        const bool ready = poll(&p, 1, 0) == 1, due = c && connection_wake_us(c) <= fake_now_us;
        if (ready || due) {
            give_turn(w, c, ready ? p.revents : 0);
            moved = true;
        }
    }
    moved = give_told_turns(w, homes_hot(&w->homes)) || moved;
    return give_told_turns(w, homes_cold(&w->homes)) || moved;
}

/* As a worker does. */
static bool work(wire *w)
{
    const bool any = worker_pool_run_one(w->shared.pool);
    if (any) {
        service_lock(&w->shared);
        completions_take(&w->shared);
        connections_send_replies(&w->shared);
        service_unlock(&w->shared);
    }
    return any;
}

void wire_turns(wire *w)
{
    for (int n = 0; give_turns(w); n++) {
        ASSERT(n < SETTLED);
    }
}

void wire_settle(wire *w)
{
    bool moved = true;
    for (int n = 0; moved; n++) {
        ASSERT(n < SETTLED);
        moved = give_turns(w);
        moved = work(w) || moved;
        for (int i = 0; i < WIRE_CLIENTS; i++) {
            moved = hear(w, i) || moved;
        }
    }
}

void wire_pass(wire *w, int64_t us)
{
    fake_now_us += us;
    service_lock(&w->shared);
    upkeep_do(&w->shared, fake_now_us);
    service_unlock(&w->shared);
    wire_settle(w);
}

/* ---- sending ----------------------------------------------------------------------------------------------------- */

void wire_send_bytes(wire *w, int i, const unsigned char *bytes, size_t size)
{
    for (size_t sent = 0; sent < size && w->clients[i].fd >= 0;) {
        const ssize_t now = send(w->clients[i].fd, bytes + sent, size - sent, MSG_NOSIGNAL);
        if (now > 0) {
            sent += (size_t)now;
        } else {
            wire_settle(w); /* takes what is there, or finds that nobody does */
        }
    }
}

void wire_send(wire *w, int i, const proto_message *message)
{
    static unsigned char bytes[WIRE_BYTES];
    const size_t size = proto_encoded_size(message);
    ASSERT(size > 0 && size <= sizeof bytes);
    proto_encode(message, bytes, size);
    wire_send_bytes(w, i, bytes, size);
}
