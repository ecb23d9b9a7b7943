/* connection.c: see connection.h. */
#include "connection.h"
#include "input.h"
#include "log.h"
#include "metrics.h"
#include "net.h"
#include "output.h"
#include "protocol.h"

#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

struct connection {
    int fd;
    session talk;
    input in;
    output out;
    int64_t opened_us;
    int64_t progress_us;  /* when the peer last took a byte, or there was nothing to take */
    int64_t lingering_us; /* when sending ended; 0: it has not */
    bool input_ended;     /* the peer sends no more */
    bool output_failed;   /* the peer takes no more */
    bool blocked;         /* the socket takes no more for now: POLLOUT will tell */
    bool hung_up;         /* POLLHUP or POLLERR was seen; what is unread is still read */
    const char *over;     /* why it is over; NULL: it is not */
};

static int64_t now_us(const connection *c)
{
    return c->talk.shared->options.clock_us();
}

static void end(connection *c, const char *why)
{
    c->over = c->over ? c->over : why;
}

/* ---- the session's sink ------------------------------------------------------------------------------------------ */

static void before_output(connection *c)
{
    if (!c->out.first) {
        c->progress_us = now_us(c);
    }
}

static void sink_message(void *context, const proto_message *message)
{
    connection *c = context;
    before_output(c);
    if (!c->output_failed && !output_add_message(&c->out, message)) {
        end(c, "no memory");
    }
}

static void sink_picture(void *context, picture *shown, const view *v, const delivery *to)
{
    connection *c = context;
    before_output(c);
    if (c->output_failed) {
        picture_release(shown);
    } else if (!output_add_picture(&c->out, shown, v, to)) {
        end(c, "no memory");
    }
}

static bool sink_drained(void *context)
{
    const connection *c = context;
    return !c->out.first;
}

/* ---- life -------------------------------------------------------------------------------------------------------- */

connection *connection_create(service *shared, int fd, const char *peer)
{
    connection *c = calloc(1, sizeof *c);
    session_sink sink = {.context = c, .message = sink_message, .picture = sink_picture, .drained = sink_drained};
    if (!c || !session_init(&c->talk, shared, &sink, peer)) {
        free(c);
        close(fd);
        return NULL;
    }
    c->fd = fd;
    c->opened_us = c->progress_us = now_us(c);
    metrics_count(METRIC_CONNECTIONS_TAKEN, 1);
    log_write(LOG_DEBUG, "connection opened", "peer=%s", peer);
    return c;
}

void connection_destroy(connection *c)
{
    log_write(LOG_INFO, "connection closed", "peer=%s why=\"%s\" bytes_sent=%llu", c->talk.peer,
              c->over ? c->over : "the daemon stops", (unsigned long long)c->out.bytes_sent);
    session_fini(&c->talk);
    input_fini(&c->in);
    output_fini(&c->out);
    close(c->fd);
    free(c);
}

int connection_descriptor(const connection *c)
{
    return c->fd;
}

bool connection_is_over(const connection *c)
{
    return c->over != NULL;
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

/* True while the client has enough unanswered. */
static bool is_paused(const connection *c)
{
    return c->talk.pending >= LIMIT_SESSION_PENDING || c->out.segments >= LIMIT_OUTPUT_SEGMENTS ||
           c->out.bytes >= LIMIT_OUTPUT_BYTES;
}

/* After the last word: what still comes is thrown away, so that closing does not destroy what the peer has not read. */
static bool is_discarding(const connection *c)
{
    return c->talk.state == SESSION_CLOSING;
}

static bool wants_bytes(const connection *c)
{
    return !c->input_ended && (is_discarding(c) || (!is_paused(c) && !input_ready(&c->in)));
}

int connection_events(const connection *c)
{
    int events = (wants_bytes(c) ? POLLIN : 0) | (c->blocked ? POLLOUT : 0);
    return events == 0 && c->hung_up ? -1 : events; /* poll reports a hang-up even where nothing was asked */
}

bool connection_has_work(const connection *c)
{
    bool messages = !is_discarding(c) && !is_paused(c) && input_ready(&c->in);
    return messages || (c->out.first && !c->blocked);
}

int64_t connection_deadline_us(const connection *c)
{
    int64_t deadline_us = session_due_us(&c->talk);
    if (c->out.first) {
        deadline_us = c->progress_us + LIMIT_WRITE_STALL_US; /* streams wait for it too */
    }
    if (c->lingering_us) {
        deadline_us = c->lingering_us + LIMIT_LINGER_US;
    }
    int64_t handshake_us = c->talk.state < SESSION_OPEN ? c->opened_us + LIMIT_HANDSHAKE_US : INT64_MAX;
    return handshake_us < deadline_us ? handshake_us : deadline_us;
}

/* ---- one turn ---------------------------------------------------------------------------------------------------- */

/* Does what whole messages ask, a bounded number of them. */
static void process(connection *c)
{
    proto_header header;
    const unsigned char *payload = NULL;
    for (int n = 0; n < LIMIT_TURN_MESSAGES && !is_discarding(c) && !is_paused(c) && !c->over; n++) {
        switch (input_next(&c->in, &header, &payload)) {
        case INPUT_MORE:
            return;
        case INPUT_HEADER:
            switch (protocol_judge(&c->talk, &header)) {
            case PROTOCOL_TAKE:
                input_take(&c->in, &header);
                break;
            case PROTOCOL_SKIP:
                input_skip(&c->in, &header);
                break;
            case PROTOCOL_REFUSE:
                return;
            }
            break;
        case INPUT_MESSAGE:
            protocol_receive(&c->talk, &header, payload);
            input_done(&c->in);
            break;
        }
    }
}

/* Reads what has come, into the input or, after the last word, into nothing. */
static net_result receive(connection *c, size_t *got)
{
    unsigned char thrown_away[4096], *room = thrown_away;
    size_t size = sizeof thrown_away;
    if (!is_discarding(c)) {
        bool open = c->talk.state == SESSION_OPEN;
        size = input_room(&c->in, open ? LIMIT_INPUT_OPEN : PROTO_HEADER_SIZE + PROTO_MAX_GREETING, &room);
    }
    if (size == 0) {
        end(c, "no memory");
        return NET_FAILED;
    }
    net_result result = net_receive(c->fd, room, size, got);
    metrics_count(METRIC_BYTES_RECEIVED, *got);
    if (result == NET_DONE && !is_discarding(c)) {
        input_came(&c->in, *got);
    }
    return result;
}

static void read_turn(connection *c)
{
    for (size_t total = 0, got = 0; total < LIMIT_TURN_READ && wants_bytes(c) && !c->over; total += got) {
        switch (receive(c, &got)) {
        case NET_DONE:
            process(c);
            break;
        case NET_ENDED:
            c->input_ended = true;
            return;
        case NET_LATER:
            return;
        default:
            end(c, "connection lost");
            return;
        }
    }
}

static void write_turn(connection *c)
{
    if (c->blocked || c->output_failed) {
        return;
    }
    uint64_t frames = c->out.frames_sent, bytes = c->out.bytes_sent;
    net_result result = output_write(&c->out, c->fd, LIMIT_TURN_WRITE, c->talk.shared->options.clock_us);
    c->blocked = result == NET_LATER;
    c->talk.last_write_us = c->out.last_write_us;
    c->talk.shared->counters.frames_sent += c->out.frames_sent - frames;
    c->talk.shared->counters.bytes_sent += c->out.bytes_sent - bytes;
    if (c->out.bytes_sent > bytes) {
        c->progress_us = now_us(c);
    }
    if (result == NET_FAILED) { /* what it sent before it went may still be read and done */
        c->output_failed = true;
        output_discard(&c->out);
    }
}

/* Whether it has come to its end, in the way that is the case. */
static void check_end(connection *c)
{
    bool quiet = !c->out.first && c->talk.pending == 0 && !input_ready(&c->in);
    if (c->input_ended && (quiet || is_discarding(c))) {
        end(c, "the peer closed");
    } else if (is_discarding(c) && c->output_failed) {
        end(c, "connection lost");
    } else if (is_discarding(c) && !c->out.first && !c->lingering_us) {
        c->lingering_us = now_us(c);
        net_end_sending(c->fd);
    }
}

static void check_clock(connection *c)
{
    int64_t now = now_us(c);
    if (c->lingering_us && now >= c->lingering_us + LIMIT_LINGER_US) {
        end(c, "the conversation ended");
    } else if (c->out.first && now >= c->progress_us + LIMIT_WRITE_STALL_US) {
        end(c, "the peer does not read");
    } else if (c->talk.state < SESSION_OPEN && now >= c->opened_us + LIMIT_HANDSHAKE_US) {
        session_error(&c->talk, 0, 0, PROTO_ERROR_TIMED_OUT, "no HELLO and AUTH within %d s",
                      (int)(LIMIT_HANDSHAKE_US / 1000000));
    }
}

void connection_turn(connection *c, int revents)
{
    c->hung_up = c->hung_up || (revents & (POLLHUP | POLLERR | POLLNVAL));
    if (revents & (POLLOUT | POLLHUP | POLLERR)) {
        c->blocked = false;
    }
    process(c);
    if (revents & (POLLIN | POLLHUP | POLLERR) || c->hung_up) {
        read_turn(c);
    }
    check_clock(c);
    write_turn(c);
    session_tick(&c->talk);
    write_turn(c);
    check_end(c);
}
