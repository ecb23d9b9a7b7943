/* admin.c: see admin.h. */
#include "admin.h"
#include "admin_page.h"
#include "clock.h"
#include "limits.h"
#include "net.h"
#include "thread.h"
#include "wake.h"

#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SLOT_WAKE, SLOT_LISTENER, SLOT_VISITS };

/* One connection. */
typedef struct visit {
    int fd;
    int64_t deadline_us;
    bool ended;   /* the peer sends no more */
    size_t used;  /* of `request` */
    char *answer; /* NULL: the request is not whole */
    size_t size, sent;
    char request[LIMIT_ADMIN_REQUEST];
} visit;

struct admin {
    admin_def def;
    wake *bell;
    atomic_bool stopping;
    pthread_t thread;
    int64_t accept_from_us; /* no accept before: descriptors had run out */
    size_t count;
    visit *visits[LIMIT_ADMIN_CONNECTIONS]; /* the oldest first */
};

/* ---- one connection ---------------------------------------------------------------------------------------------- */

static void end_visit(admin *a, size_t i)
{
    close(a->visits[i]->fd);
    free(a->visits[i]->answer);
    free(a->visits[i]);
    a->count--;
    memmove(&a->visits[i], &a->visits[i + 1], (a->count - i) * sizeof a->visits[0]);
}

static void begin_visit(admin *a, int fd)
{
    visit *v = calloc(1, sizeof *v);
    if (!v) {
        close(fd);
        return;
    }
    if (a->count == LIMIT_ADMIN_CONNECTIONS) {
        end_visit(a, 0);
    }
    v->fd = fd;
    v->deadline_us = clock_monotonic_us() + LIMIT_ADMIN_US;
    a->visits[a->count++] = v;
}

static bool is_answering(const visit *v)
{
    return v->answer && v->sent < v->size;
}

/* What comes after the request is thrown away, so that closing does not destroy what the peer has not read. */
static net_result receive(visit *v)
{
    char thrown_away[1024];
    size_t got = 0;
    if (v->answer) {
        return net_receive(v->fd, thrown_away, sizeof thrown_away, &got);
    }
    net_result result = net_receive(v->fd, v->request + v->used, sizeof v->request - v->used, &got);
    v->used += got;
    if (result == NET_DONE) {
        int status = 0;
        v->answer = admin_page(v->request, v->used, v->used == sizeof v->request, &status, &v->size);
        result = !v->answer && status != 0 ? NET_FAILED : NET_DONE;
    }
    return result;
}

static net_result send_some(visit *v)
{
    const struct iovec rest = {.iov_base = v->answer + v->sent, .iov_len = v->size - v->sent};
    size_t sent = 0;
    net_result result = net_send(v->fd, &rest, 1, &sent);
    v->sent += sent;
    if (v->sent == v->size) {
        net_end_sending(v->fd);
    }
    return result;
}

/* False: it is over. */
static bool turn_visit(visit *v, int revents)
{
    net_result result = NET_LATER;
    if (revents & (POLLIN | POLLHUP | POLLERR)) {
        result = receive(v);
        v->ended = v->ended || result == NET_ENDED;
    }
    if (result != NET_FAILED && is_answering(v)) {
        result = send_some(v);
    }
    const bool done = v->ended && !is_answering(v);
    return result != NET_FAILED && !done && clock_monotonic_us() < v->deadline_us;
}

/* ---- the thread -------------------------------------------------------------------------------------------------- */

static void accept_visits(admin *a)
{
    for (int n = 0; n < LIMIT_TURN_ACCEPTS; n++) {
        int fd = -1;
        char peer[NET_ADDRESS];
        switch (net_accept(a->def.listener, &fd, peer)) {
        case NET_DONE:
            begin_visit(a, fd);
            break;
        case NET_EXHAUSTED:
            a->accept_from_us = clock_monotonic_us() + LIMIT_ACCEPT_PAUSE_US;
            return;
        case NET_FAILED:
            break;
        default:
            return;
        }
    }
}

/* When the oldest connection's time is over, or there may be accepted again; INT64_MAX: neither. */
static int64_t due_us(const admin *a, int64_t now_us)
{
    int64_t until_us = a->count ? a->visits[0]->deadline_us : INT64_MAX;
    if (a->accept_from_us > now_us && a->accept_from_us < until_us) {
        until_us = a->accept_from_us;
    }
    return until_us;
}

static void turn(admin *a)
{
    struct pollfd slots[SLOT_VISITS + LIMIT_ADMIN_CONNECTIONS];
    const size_t count = a->count;
    const int64_t now_us = clock_monotonic_us();
    slots[SLOT_WAKE] = (struct pollfd){.fd = a->bell->ends[0], .events = POLLIN};
    slots[SLOT_LISTENER] = (struct pollfd){.fd = now_us < a->accept_from_us ? -1 : a->def.listener, .events = POLLIN};
    for (size_t i = 0; i < count; i++) {
        const visit *v = a->visits[i];
        const int events = (v->ended ? 0 : POLLIN) | (is_answering(v) ? POLLOUT : 0);
        slots[SLOT_VISITS + i] = (struct pollfd){.fd = v->fd, .events = (short)events};
    }
    if (poll(slots, SLOT_VISITS + count, clock_poll_ms(now_us, due_us(a, now_us))) < 0) {
        return; /* EINTR, or no memory for a moment */
    }
    for (size_t i = count; i-- > 0;) {
        if (!turn_visit(a->visits[i], slots[SLOT_VISITS + i].revents)) {
            end_visit(a, i);
        }
    }
    if (slots[SLOT_LISTENER].revents & POLLIN) {
        accept_visits(a);
    }
}

static void *admin_main(void *argument)
{
    admin *a = argument;
    while (!atomic_load(&a->stopping)) {
        turn(a);
        wake_clear(a->bell);
        if (wake_take_hangup()) {
            a->def.reload(a->def.context);
        }
    }
    return NULL;
}

/* ---- life -------------------------------------------------------------------------------------------------------- */

admin *admin_create(const admin_def *def)
{
    static wake bell; /* outlives all: a signal may come at any time */
    admin *a = calloc(1, sizeof *a);
    if (a && (bell.ends[1] > 0 || wake_init(&bell))) {
        a->def = *def;
        a->bell = &bell;
        wake_on_hangup(&bell);
        if (thread_start(&a->thread, admin_main, a)) {
            return a;
        }
    }
    if (def->listener >= 0) {
        close(def->listener);
    }
    free(a);
    return NULL;
}

void admin_destroy(admin *a)
{
    if (!a) {
        return;
    }
    atomic_store(&a->stopping, true);
    wake_ring(a->bell);
    pthread_join(a->thread, NULL);
    while (a->count > 0) {
        end_visit(a, a->count - 1);
    }
    if (a->def.listener >= 0) {
        close(a->def.listener);
    }
    free(a);
}
