/* connection_parts.h: what connection*.c know of a connection and nobody else. */
#ifndef CONNECTION_PARTS_H
#define CONNECTION_PARTS_H

#include "connection.h"
#include "input.h"
#include "output.h"

/* What the loop may read without asking. */
typedef enum connection_reads {
    READS_NOTHING,
    READS_GREETING, /* into a small buffer */
    READS_OPEN,
    READS_AWAY /* after the last word: what still comes is thrown away */
} connection_reads;

struct connection {
    /* the loop's alone: no lock */
    input in;
    connection_reads reads; /* as it was when the last turn ended */
    connection_fate fate;
    connection_seat seat;

    /* written by the loop under the lock, so that it may read them without */
    int fd;
    int events;       /* that it is polled for; -1: it is not */
    int64_t wake_us;  /* when it has a turn whatever happens; INT64_MAX: never */
    bool hung_up;     /* POLLHUP or POLLERR was seen; what is unread is still read */
    bool input_ended; /* the peer sends no more */
    bool input_whole; /* a whole message waits in `in` */

    /* under the lock */
    session talk;
    output out;
    home *home;
    home_link link;     /* in its home's list */
    home_link reply;    /* in the service's list of those that a worker sends to */
    bool sending;       /* a thread has claimed it to send: it may let the lock go, and the connection stays */
    bool output_failed; /* the peer takes no more */
    bool blocked;       /* the socket takes no more for now: POLLOUT will tell */
    const char *over;   /* why it is over; NULL: it is not */
    int64_t opened_us;
    int64_t progress_us;   /* when the peer last took a byte, or there was nothing to take */
    int64_t lingering_us;  /* when sending ended; 0: it has not */
    int64_t busy_us;       /* when it last did more than stay open */
    int64_t light_from_us; /* a second begins, in which ... */
    uint32_t light;        /* ... so many messages came that only keep it open */
};

/* All under the lock. */

int64_t connection_now_us(const connection *c);
/* What it has done so far decides where it lives: see connection_fate. */
connection_fate connection_decide(const connection *c);
/* The client has enough unanswered. */
bool connection_is_paused(const connection *c);
/* Its last word is said. */
bool connection_is_discarding(const connection *c);
/* It has come to the end of listening, or of sending, and does not act on that yet. */
bool connection_is_ending(const connection *c);
/* It has work that no poll would announce. */
bool connection_has_work(const connection *c);
/* POLLIN and POLLOUT as it needs them, or -1: not to be polled now, though the peer has hung up. */
int connection_wants_events(const connection *c);
/* When it must have a turn whatever poll says; INT64_MAX: never. */
int64_t connection_due_us(const connection *c);
/* Asks for a turn if it needs one earlier than its loop would give it. */
void connection_settle(connection *c);

/* Sends while the socket takes it, at most LIMIT_TURN_WRITE; lets the lock go meanwhile. The caller has the claim. */
void connection_send(connection *c);

#endif
