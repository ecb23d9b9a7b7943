/* loop.c: see loop.h. */
#include "loop.h"
#include "log.h"
#include "upkeep.h"
#include "net.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SLOT_WAKE, SLOT_LISTENER, SLOT_CONNECTIONS };

bool loop_init(loop *l, service *shared, wake *bell, int listener, uint32_t greatest)
{
    uint32_t room = greatest + LIMIT_CONNECTIONS_REFUSED;
    *l = (loop){.shared = shared,
                .bell = bell,
                .listener = listener,
                .greatest = greatest,
                .room = room,
                .connections = calloc(room, sizeof *l->connections),
                .polled = calloc(room + SLOT_CONNECTIONS, sizeof *l->polled)};
    if (!l->connections || !l->polled) {
        loop_fini(l);
        return false;
    }
    return true;
}

static void stop_listening(loop *l)
{
    if (l->listener >= 0) {
        close(l->listener);
        l->listener = -1;
    }
}

void loop_fini(loop *l)
{
    if (l->count > 0) {
        service_lock(l->shared);
        while (l->count > 0) {
            connection_destroy(l->connections[--l->count]);
        }
        service_unlock(l->shared);
    }
    stop_listening(l);
    free(l->connections);
    free(l->polled);
    *l = (loop){.listener = -1};
}

/* ---- sleeping ---------------------------------------------------------------------------------------------------- */

static bool may_accept(const loop *l, int64_t now_us)
{
    return l->listener >= 0 && l->count < l->room && now_us >= l->accept_from_us;
}

static void fill_slots(loop *l, int64_t now_us)
{
    l->polled[SLOT_WAKE] = (struct pollfd){.fd = l->bell->ends[0], .events = POLLIN};
    l->polled[SLOT_LISTENER] = (struct pollfd){.fd = may_accept(l, now_us) ? l->listener : -1, .events = POLLIN};
    for (uint32_t i = 0; i < l->count; i++) {
        int events = connection_events(l->connections[i]);
        l->polled[SLOT_CONNECTIONS + i] =
            (struct pollfd){.fd = events < 0 ? -1 : connection_descriptor(l->connections[i]),
                            .events = (short)(events < 0 ? 0 : events)};
    }
}

/* Milliseconds that poll may sleep; -1: as long as nothing happens. */
static int sleep_ms(const loop *l, int64_t now_us, int64_t until_us)
{
    if (l->accept_from_us > now_us && l->accept_from_us < until_us) {
        until_us = l->accept_from_us;
    }
    for (uint32_t i = 0; i < l->count; i++) {
        if (connection_has_work(l->connections[i]) || connection_is_over(l->connections[i])) {
            return 0;
        }
        int64_t deadline_us = connection_deadline_us(l->connections[i]);
        until_us = deadline_us < until_us ? deadline_us : until_us;
    }
    if (until_us == INT64_MAX) {
        return -1;
    }
    int64_t left_us = until_us - now_us;
    return left_us <= 0 ? 0 : left_us >= 60000000 ? 60000 : (int)((left_us + 999) / 1000);
}

/* ---- one turn ---------------------------------------------------------------------------------------------------- */

static void accept_connections(loop *l, int64_t now_us)
{
    for (int n = 0; n < LIMIT_TURN_ACCEPTS && l->count < l->room; n++) {
        int fd = -1;
        char peer[NET_ADDRESS];
        net_result result = net_accept(l->listener, &fd, peer);
        if (result == NET_EXHAUSTED) {
            log_write(LOG_ERROR, "cannot accept", "why=\"%s\"", strerror(errno));
            l->accept_from_us = now_us + LIMIT_ACCEPT_PAUSE_US;
        }
        if (result == NET_LATER || result == NET_EXHAUSTED) {
            return;
        }
        connection *c = result == NET_DONE ? connection_create(l->shared, fd, peer) : NULL;
        if (!c) {
            continue;
        }
        if (l->count >= l->greatest) {
            log_write(LOG_WARN, "too many connections", "peer=%s", peer);
            connection_refuse(c, PROTO_ERROR_BUSY, "the daemon has as many connections as it takes");
        }
        l->connections[l->count++] = c;
    }
}

static void remove_ended(loop *l)
{
    for (uint32_t i = l->count; i-- > 0;) {
        if (connection_is_over(l->connections[i])) {
            connection_destroy(l->connections[i]);
            l->connections[i] = l->connections[--l->count];
        }
    }
}

/* `all`: a worker's result may concern any of them. */
static void give_turns(loop *l, uint32_t count, bool all, int64_t now_us)
{
    for (uint32_t i = 0; i < count; i++) {
        connection *c = l->connections[i];
        int revents = l->polled[SLOT_CONNECTIONS + i].revents;
        if (revents || all || connection_has_work(c) || connection_deadline_us(c) <= now_us) {
            connection_turn(c, revents);
        }
    }
}

/* Under the lock, which it lets go while it sleeps. */
static void turn(loop *l, int64_t until_us)
{
    int64_t before_us = l->shared->options.clock_us();
    uint32_t count = l->count;
    int64_t due_us = upkeep_due_us(l->shared);
    fill_slots(l, before_us);
    int patience_ms = sleep_ms(l, before_us, due_us < until_us ? due_us : until_us);
    service_unlock(l->shared);
    int ready = poll(l->polled, SLOT_CONNECTIONS + count, patience_ms);
    service_lock(l->shared);
    if (ready < 0) { /* EINTR, or no memory for a moment: nobody has anything to say */
        for (uint32_t i = 0; i < SLOT_CONNECTIONS + count; i++) {
            l->polled[i].revents = 0;
        }
    }
    int64_t now_us = l->shared->options.clock_us();
    bool results = l->polled[SLOT_WAKE].revents != 0;
    wake_clear(l->bell);
    upkeep_do(l->shared, now_us);
    give_turns(l, count, results, now_us);
    if (l->polled[SLOT_LISTENER].revents & POLLIN) {
        accept_connections(l, now_us);
    }
    remove_ended(l);
}

void loop_run(loop *l)
{
    service_lock(l->shared);
    while (!wake_stop_asked()) {
        turn(l, INT64_MAX);
    }
    log_write(LOG_INFO, "stopping", "connections=%lu", (unsigned long)l->count);
    stop_listening(l);
    for (uint32_t i = 0; i < l->count; i++) {
        connection_end(l->connections[i], "the daemon stops");
    }
    int64_t until_us = l->shared->options.clock_us() + LIMIT_STOP_FLUSH_US;
    while (l->count > 0 && l->shared->options.clock_us() < until_us) {
        turn(l, until_us);
    }
    service_unlock(l->shared);
}
