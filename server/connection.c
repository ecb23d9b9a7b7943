/* connection.c: see connection.h: its life, what its session gives it, and what it waits for. */
#include "connection_parts.h"
#include "log.h"
#include "metrics.h"

#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

int64_t connection_now_us(const connection *c)
{
    return c->talk.shared->options.clock_us();
}

void connection_drop(connection *c, const char *why)
{
    c->over = c->over ? c->over : why;
}

/* ---- the session's sink ------------------------------------------------------------------------------------------ */

static void before_output(connection *c)
{
    if (!c->out.first) {
        c->progress_us = connection_now_us(c);
    }
}

/* An answer that nobody takes is one that is not waited for any more: then too there may be something to do. */
static void after_output(connection *c, bool added)
{
    if (!added) {
        connection_drop(c, "no memory");
    }
    connection_settle(c);
}

static void sink_message(void *context, const proto_message *message)
{
    connection *c = context;
    before_output(c);
    after_output(c, c->output_failed || output_add_message(&c->out, message));
}

static void sink_picture(void *context, picture *shown, const view *v, const delivery *to)
{
    connection *c = context;
    before_output(c);
    if (c->output_failed) {
        picture_release(shown);
    }
    after_output(c, c->output_failed || output_add_picture(&c->out, shown, v, to));
}

static bool sink_drained(void *context)
{
    const connection *c = context;
    return !c->out.first;
}

static void sink_touched(void *context)
{
    connection_settle(context);
}

/* Claims it for the worker that answers. */
static void sink_prompt(void *context)
{
    connection *c = context;
    if (c->sending || c->blocked || c->output_failed) {
        return; /* the sender, or POLLOUT, sees to it */
    }
    c->sending = true;
    c->reply.next = c->talk.shared->replies_waiting;
    c->talk.shared->replies_waiting = &c->reply;
}

/* ---- life -------------------------------------------------------------------------------------------------------- */

connection *connection_create(service *shared, int fd, const char *peer)
{
    connection *c = calloc(1, sizeof *c);
    session_sink sink = {.context = c,
                         .message = sink_message,
                         .picture = sink_picture,
                         .drained = sink_drained,
                         .prompt = sink_prompt,
                         .touched = sink_touched};
    service_lock(shared);
    bool begun = c && session_init(&c->talk, shared, &sink, peer);
    service_unlock(shared);
    if (!begun) {
        free(c);
        close(fd);
        return NULL;
    }
    c->fd = fd;
    c->events = -1;
    c->wake_us = c->seat.wait.at_us = INT64_MAX;
    c->link.owner = c->reply.owner = c->seat.wait.owner = c;
    c->opened_us = c->progress_us = connection_now_us(c);
    c->busy_us = c->opened_us - LIMIT_IDLE_US;
    metrics_count(METRIC_CONNECTIONS_TAKEN, 1);
    log_write(LOG_DEBUG, "connection opened", "peer=%s", peer);
    return c;
}

void connection_enter(connection *c, home *h)
{
    c->home = h;
    h->count++;
    c->talk.shared->counters.idle += h->is_cold;
    const int64_t grace_us = connection_now_us(c) - LIMIT_IDLE_US + LIMIT_NEWCOMER_US; /* to become busy there */
    c->busy_us = !h->is_cold && grace_us > c->busy_us ? grace_us : c->busy_us;
    home_tell(h, c->talk.shared, &c->link);
}

bool connection_leave(connection *c)
{
    if (c->sending || c->link.listed) {
        return false;
    }
    c->home->count--;
    c->talk.shared->counters.idle -= c->home->is_cold;
    c->home = NULL;
    return true;
}

bool connection_close(connection *c)
{
    if (!connection_leave(c)) {
        return false;
    }
    log_write(LOG_INFO, "connection closed", "peer=%s why=\"%s\" bytes_sent=%llu", c->talk.peer, c->over,
              (unsigned long long)c->out.bytes_sent);
    session_fini(&c->talk);
    return true;
}

void connection_destroy(connection *c)
{
    input_fini(&c->in);
    output_fini(&c->out);
    close(c->fd);
    free(c);
}

void connection_end(connection *c, const char *reason)
{
    session_bye(&c->talk, reason);
}

void connection_refuse(connection *c, int code, const char *text)
{
    metrics_count(METRIC_CONNECTIONS_REFUSED, 1);
    session_error(&c->talk, 0, 0, code, "%s", text);
    c->talk.state = SESSION_CLOSING;
}

/* ---- what it waits for ------------------------------------------------------------------------------------------- */

/* Nothing is on its way to or from it. */
static bool is_at_rest(const connection *c)
{
    return c->talk.pending == 0 && !c->out.first && !c->hung_up && !connection_is_discarding(c);
}

connection_fate connection_decide(const connection *c)
{
    if (c->over) {
        return CONNECTION_ENDS;
    }
    const bool busy = connection_now_us(c) < c->busy_us + LIMIT_IDLE_US;
    const bool moves = c->home->is_cold ? busy : !busy && is_at_rest(c);
    return moves ? CONNECTION_MOVES : CONNECTION_STAYS;
}

bool connection_is_paused(const connection *c)
{
    const int64_t free_us = session_free_us(&c->talk);
    return (free_us != INT64_MIN && free_us > connection_now_us(c)) || c->talk.pending >= LIMIT_SESSION_PENDING ||
           c->out.segments >= LIMIT_OUTPUT_SEGMENTS || c->out.bytes >= LIMIT_OUTPUT_BYTES;
}

bool connection_is_discarding(const connection *c)
{
    return c->talk.state == SESSION_CLOSING;
}

static bool wants_bytes(const connection *c)
{
    return !c->input_ended && (connection_is_discarding(c) || (!connection_is_paused(c) && !c->input_whole));
}

int connection_wants_events(const connection *c)
{
    int events = (wants_bytes(c) ? POLLIN : 0) | (c->blocked ? POLLOUT : 0);
    bool unasked = events == 0 && c->hung_up; /* poll reports a hang-up even where nothing was asked */
    return c->over || unasked ? -1 : events;
}

bool connection_is_ending(const connection *c)
{
    bool discarding = connection_is_discarding(c), quiet = !c->out.first && c->talk.pending == 0 && !c->input_whole;
    return (c->input_ended && (quiet || discarding)) || (discarding && c->output_failed) ||
           (discarding && !c->out.first && !c->lingering_us);
}

bool connection_has_work(const connection *c)
{
    bool messages = !connection_is_discarding(c) && !connection_is_paused(c) && c->input_whole;
    return messages || (!c->sending && ((c->out.first && !c->blocked) || connection_is_ending(c)));
}

/* When it may be found idle, where that changes anything. */
static int64_t idle_us(const connection *c)
{
    return c->home && !c->home->is_cold && is_at_rest(c) ? c->busy_us + LIMIT_IDLE_US : INT64_MAX;
}

int64_t connection_due_us(const connection *c)
{
    if (c->over || c->sending) {
        return INT64_MAX; /* its loop, or whoever sends, goes on */
    }
    int64_t due_us = session_due_us(&c->talk);
    const int64_t free_us = session_free_us(&c->talk);
    if (c->out.first) {
        due_us = c->progress_us + LIMIT_WRITE_STALL_US; /* streams wait for it too */
    }
    if (free_us < due_us && free_us > connection_now_us(c)) {
        due_us = free_us; /* to be read on */
    }
    if (c->lingering_us) {
        due_us = c->lingering_us + LIMIT_LINGER_US;
    }
    int64_t handshake_us = c->talk.state < SESSION_OPEN ? c->opened_us + LIMIT_HANDSHAKE_US : INT64_MAX;
    due_us = handshake_us < due_us ? handshake_us : due_us;
    return idle_us(c) < due_us ? idle_us(c) : due_us;
}

void connection_settle(connection *c)
{
    if (c->sending || !c->home) {
        return; /* whoever sends, or has it enter a home, will do so */
    }
    if (c->over || connection_has_work(c) || connection_wants_events(c) != c->events ||
        connection_due_us(c) < c->wake_us) {
        home_tell(c->home, c->talk.shared, &c->link);
    }
}

/* ---- its loop's -------------------------------------------------------------------------------------------------- */

connection_seat *connection_seat_of(connection *c)
{
    return &c->seat;
}

int connection_descriptor(const connection *c)
{
    return c->fd;
}

int connection_events(const connection *c)
{
    return c->events;
}

connection_fate connection_fate_of(const connection *c)
{
    return c->fate;
}

int64_t connection_wake_us(const connection *c)
{
    return c->wake_us;
}
