/* connection.h: one client's socket with the session behind it.
 *
 * Reading stops while the client has enough unanswered: unsent output or requests that wait for a worker. So its
 * memory here is bounded however fast it asks and however slowly it reads. */
#ifndef CONNECTION_H
#define CONNECTION_H

#include "session.h"

typedef struct connection connection;

/* Takes the descriptor (closed where this fails). NULL: no memory, or too many sessions. */
connection *connection_create(service *shared, int fd, const char *peer);
/* Closes and frees. */
void connection_destroy(connection *c);

int connection_descriptor(const connection *c);
/* What to poll for (POLLIN, POLLOUT), or -1: not to be polled now, though the peer has hung up. */
int connection_events(const connection *c);
/* True if it has work that no poll would announce. */
bool connection_has_work(const connection *c);
/* Monotonic time at which it must have a turn whatever poll says; INT64_MAX: never. */
int64_t connection_deadline_us(const connection *c);

/* One turn: reads if `revents` allows it, does what messages ask, sends, watches the clock. Bounded by LIMIT_TURN_*. */
void connection_turn(connection *c, int revents);

/* True if it is to be destroyed. */
bool connection_is_over(const connection *c);

/* Says BYE; the connection ends when that is sent. */
void connection_end(connection *c, const char *reason);
/* Says ERROR; the connection ends when that is sent. */
void connection_refuse(connection *c, int code, const char *text);

#endif
