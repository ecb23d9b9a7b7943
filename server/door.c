/* door.c: see door.h. */
#include "door.h"
#include "clock.h"
#include "log.h"
#include "net.h"
#include "upkeep.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

enum { SLOT_BELL, SLOT_LISTENER, SLOTS };

/* ---- accepting --------------------------------------------------------------------------------------------------- */

static uint32_t count_connections(door *d)
{
    service_lock(d->shared);
    uint32_t count = d->shared->counters.sessions;
    service_unlock(d->shared);
    return count;
}

static void admit(door *d, int fd, const char *peer)
{
    const bool full = count_connections(d) >= d->greatest;
    connection *c = connection_create(d->shared, fd, peer);
    if (!c) {
        return;
    }
    if (full) {
        log_write(LOG_WARN, "too many connections", "peer=%s", peer);
        service_lock(d->shared);
        connection_refuse(c, PROTO_ERROR_BUSY, "the daemon has as many connections as it takes");
        service_unlock(d->shared);
    }
    loops_add(d->inside, c);
}

static void accept_connections(door *d, int64_t now_us)
{
    for (int n = 0; n < LIMIT_TURN_ACCEPTS; n++) {
        int fd = -1;
        char peer[NET_ADDRESS];
        net_result result = net_accept(d->listener, &fd, peer);
        if (result == NET_EXHAUSTED) {
            log_write(LOG_ERROR, "cannot accept", "why=\"%s\"", strerror(errno));
            d->accept_from_us = now_us + LIMIT_ACCEPT_PAUSE_US;
        }
        if (result == NET_LATER || result == NET_EXHAUSTED) {
            return;
        }
        if (result == NET_DONE) {
            admit(d, fd, peer);
        }
    }
}

/* False for a while when descriptors have run out, or too many connections are being refused already. */
static bool may_accept(door *d, int64_t now_us)
{
    if (now_us >= d->accept_from_us && count_connections(d) >= d->greatest + LIMIT_CONNECTIONS_REFUSED) {
        d->accept_from_us = now_us + LIMIT_ACCEPT_PAUSE_US;
    }
    return now_us >= d->accept_from_us;
}

/* ---- turns ------------------------------------------------------------------------------------------------------- */

/* Does what is due; when something is due next. */
static int64_t keep_up(door *d, int64_t now_us)
{
    service_lock(d->shared);
    home_wakes(&d->own);
    upkeep_do(d->shared, now_us);
    int64_t due_us = upkeep_due_us(d->shared);
    home_falls_asleep(&d->own);
    service_unlock(d->shared);
    return due_us;
}

static void turn(door *d)
{
    int64_t now_us = d->shared->options.clock_us();
    int64_t due_us = keep_up(d, now_us);
    const bool open = may_accept(d, now_us);
    if (!open && d->accept_from_us < due_us) {
        due_us = d->accept_from_us;
    }
    struct pollfd polled[SLOTS] = {{.fd = d->own.bell.ends[0], .events = POLLIN},
                                   {.fd = open ? d->listener : -1, .events = POLLIN}};
    if (poll(polled, SLOTS, clock_poll_ms(now_us, due_us)) <= 0) {
        return;
    }
    if (polled[SLOT_BELL].revents) {
        wake_clear(&d->own.bell);
    }
    if (polled[SLOT_LISTENER].revents & POLLIN) {
        accept_connections(d, now_us);
    }
}

static void save_now(door *d)
{
    service_lock(d->shared);
    log_write(LOG_INFO, "saving forests", "why=\"asked by a signal\"%s",
              d->shared->options.keeper ? "" : " result=\"there is no state directory\"");
    upkeep_keep_all(d->shared);
    service_unlock(d->shared);
}

void door_run(door *d)
{
    service_lock(d->shared);
    d->shared->door = &d->own;
    service_unlock(d->shared);
    while (!wake_stop_asked()) {
        turn(d);
        if (wake_save_asked()) {
            save_now(d);
        }
    }
    close(d->listener);
    service_lock(d->shared);
    d->shared->door = NULL;
    log_write(LOG_INFO, "stopping", "connections=%lu", (unsigned long)d->shared->counters.sessions);
    service_unlock(d->shared);
}
