/* connection_turn.c: see connection.h: a connection's turn. Bytes are received without the lock; all else is done
 * under it. */
#include "connection_parts.h"
#include "clock.h"
#include "metrics.h"
#include "net.h"
#include "protocol.h"

#include <poll.h>

/* ---- receiving --------------------------------------------------------------------------------------------------- */

typedef struct arrival {
    net_result result; /* NET_EXHAUSTED: no memory */
    size_t size;
    bool more; /* there may be more in the socket */
} arrival;

/* Into the input or, after the last word, into nothing. */
static arrival receive(connection *c)
{
    arrival came = {.result = NET_LATER};
    unsigned char thrown_away[4096], *room = thrown_away;
    size_t size = sizeof thrown_away;
    if (c->reads == READS_NOTHING) {
        return came;
    }
    if (c->reads != READS_AWAY) {
        size = input_room(&c->in, c->reads == READS_OPEN ? LIMIT_INPUT_OPEN : PROTO_HEADER_SIZE + PROTO_MAX_GREETING,
                          &room);
    }
    if (size == 0) {
        came.result = NET_EXHAUSTED;
        return came;
    }
    came.result = net_receive(c->fd, room, size, &came.size);
    metrics_count(METRIC_BYTES_RECEIVED, came.size);
    came.more = came.result == NET_DONE && came.size == size;
    if (came.result == NET_DONE && c->reads != READS_AWAY) {
        input_came(&c->in, came.size);
    }
    return came;
}

static void take_arrival(connection *c, net_result result)
{
    if (result == NET_ENDED) {
        c->input_ended = true;
    } else if (result == NET_FAILED) {
        connection_drop(c, "connection lost");
    } else if (result == NET_EXHAUSTED) {
        connection_drop(c, "no memory");
    }
}

/* ---- under the lock ---------------------------------------------------------------------------------------------- */

/* Whether a message is of those that only keep a connection open. */
static bool is_light(uint16_t type)
{
    return type == PROTO_PING || type == PROTO_PONG || type == PROTO_HELLO || type == PROTO_AUTH;
}

static void note_activity(connection *c, uint16_t type)
{
    int64_t now_us = connection_now_us(c);
    if (now_us >= c->light_from_us + 1000000) {
        c->light_from_us = now_us;
        c->light = 0;
    }
    c->light += is_light(type);
    if (!is_light(type) || c->light > LIMIT_IDLE_MESSAGES) {
        c->busy_us = now_us;
    }
}

/* Does what whole messages ask, a bounded number of them. */
static void process(connection *c)
{
    for (int n = 0; n < LIMIT_TURN_MESSAGES && !connection_is_discarding(c) && !connection_is_paused(c) && !c->over;
         n++) {
        uint16_t done = 0;
        if (!protocol_step(&c->talk, &c->in, &done)) {
            return;
        }
        if (done != 0) {
            note_activity(c, done);
        }
    }
}

/* Whether it has come to its end, in the way that is the case. */
static void check_end(connection *c)
{
    if (!connection_is_ending(c)) {
        return;
    }
    if (c->input_ended) {
        connection_drop(c, "the peer closed");
    } else if (c->output_failed) {
        connection_drop(c, "connection lost");
    } else {
        c->lingering_us = connection_now_us(c);
        net_end_sending(c->fd);
    }
}

static void check_clock(connection *c)
{
    int64_t now_us = connection_now_us(c);
    if (c->lingering_us && now_us >= c->lingering_us + LIMIT_LINGER_US) {
        connection_drop(c, "the conversation ended");
    } else if (c->out.first && clock_is_over(&c->progress_us, LIMIT_WRITE_STALL_US, now_us)) {
        connection_drop(c, "the peer does not read");
    } else if (c->talk.state < SESSION_OPEN && clock_is_over(&c->opened_us, LIMIT_HANDSHAKE_US, now_us)) {
        session_error(&c->talk, 0, 0, PROTO_ERROR_TIMED_OUT, "no HELLO and AUTH within %d s",
                      (int)(LIMIT_HANDSHAKE_US / 1000000));
    }
    if (now_us >= c->wake_us) {
        c->wake_us = INT64_MAX; /* this is that turn */
    }
}

static void take_revents(connection *c, int revents)
{
    c->hung_up = c->hung_up || (revents & (POLLHUP | POLLERR | POLLNVAL));
    if (revents & (POLLOUT | POLLHUP | POLLERR)) {
        c->blocked = false;
    }
}

/* Everything that may now be done but receive. */
static void go_on(connection *c)
{
    const bool claimed = !c->sending; /* else a worker sends, what is added meanwhile too */
    c->sending = true;
    process(c);
    c->input_whole = input_ready(&c->in);
    check_clock(c);
    session_tick(&c->talk);
    if (claimed) {
        connection_send(c);
        c->sending = false;
        check_end(c);
    }
}

static connection_reads may_read(const connection *c)
{
    if (c->over || c->input_ended) {
        return READS_NOTHING;
    }
    if (connection_is_discarding(c)) {
        return READS_AWAY;
    }
    if (connection_is_paused(c) || c->input_whole) {
        return READS_NOTHING;
    }
    return c->talk.state == SESSION_OPEN ? READS_OPEN : READS_GREETING;
}

/* What the loop has to know until the next turn. */
static void leave_word(connection *c)
{
    c->reads = may_read(c);
    c->events = connection_wants_events(c);
    int64_t due_us = connection_due_us(c);
    c->wake_us = due_us < c->wake_us ? due_us : c->wake_us; /* one that comes too early does no harm */
    c->fate = connection_decide(c);
    if (!c->over && connection_has_work(c)) {
        home_tell(c->home, c->talk.shared, &c->link);
    }
}

/* ---- the turn ---------------------------------------------------------------------------------------------------- */

void connection_turn(connection *c, int revents)
{
    arrival came = {.result = NET_LATER, .more = revents & (POLLIN | POLLHUP | POLLERR)};
    size_t total = 0;
    do {
        came = came.more ? receive(c) : came;
        total += came.size;
        service_lock(c->talk.shared);
        take_revents(c, revents);
        take_arrival(c, came.result);
        go_on(c);
        leave_word(c);
        service_unlock(c->talk.shared);
        revents = 0;
    } while (came.more && total < LIMIT_TURN_READ);
    if (c->home->is_cold) {
        input_rest(&c->in);
    }
}
