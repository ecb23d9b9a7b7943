/* connection.h: one client's socket with the session behind it.
 *
 * Reading stops while the client has enough unanswered: unsent output or requests that wait for a worker. So its
 * memory here is bounded however fast it asks and however slowly it reads.
 *
 * A connection belongs to one loop, which alone polls it, reads from it, gives it turns and destroys it. Others reach
 * it through its session, under the service's lock: they add output and ask for a turn (home.h). Sending is done by
 * whoever has claimed the connection, one thread at a time: gathered under the lock, sent without. */
#ifndef CONNECTION_H
#define CONNECTION_H

#include "deadlines.h"
#include "home.h"
#include "session.h"

typedef struct connection connection;

/* What a loop keeps about a connection of its own. */
typedef struct connection_seat {
    uint32_t slot; /* in the poll set, from 1; 0: none yet */
    deadline wait;
} connection_seat;

/* Takes the descriptor (closed where this fails); it lives nowhere yet. Without the lock. NULL: no memory, or too many
 * sessions. */
connection *connection_create(service *shared, int fd, const char *peer);
/* Closes the socket and frees; after connection_close, without the lock. */
void connection_destroy(connection *c);

/* ---- its loop's, without the lock -------------------------------------------------------------------------------- */

connection_seat *connection_seat_of(connection *c);
int connection_descriptor(const connection *c);
/* What to poll for (POLLIN, POLLOUT), or -1: not to be polled now. As the last turn left it. */
int connection_events(const connection *c);
/* Monotonic time at which it must have a turn whatever poll says; INT64_MAX: never. As the last turn left it. */
int64_t connection_wake_us(const connection *c);

/* What is to become of it: to be ended (connection_close), to be moved to where connections of its kind live, or
 * neither. As the last turn left it. */
typedef enum connection_fate { CONNECTION_STAYS, CONNECTION_MOVES, CONNECTION_ENDS } connection_fate;
connection_fate connection_fate_of(const connection *c);

/* One turn: reads if `revents` allows it, does what messages ask, sends, watches the clock. Bounded by LIMIT_TURN_*. */
void connection_turn(connection *c, int revents);

/* ---- under the lock ---------------------------------------------------------------------------------------------- */

/* It lives in `h` from now on, and has its next turn there. */
void connection_enter(connection *c, home *h);
/* It leaves its home, to enter another before the lock is let go. False: someone sends to it, or a turn waits for it;
 * that turn comes. */
bool connection_leave(connection *c);
/* It leaves its home, and nobody knows it any more. False: as above. */
bool connection_close(connection *c);

/* Says BYE; the connection ends when that is sent. */
void connection_end(connection *c, const char *reason);
/* Says ERROR; the connection ends when that is sent. */
void connection_refuse(connection *c, int code, const char *text);
/* It is over; `why` is a literal. Its loop ends it. */
void connection_drop(connection *c, const char *why);

/* Sends the answers that were given since the lock was taken (session_prompt); lets it go meanwhile. For workers. */
void connections_send_replies(service *shared);

#endif
