/* socket.h: the one file of the client library with a socket: TCP as a transport of links, and waiting. */
#ifndef AWTCLIENT_SOCKET_H
#define AWTCLIENT_SOCKET_H

#include "awtlink.h"

/* Microseconds of the monotonic clock. */
int64_t socket_now_us(void);
/* Milliseconds until the deadline, rounded up; 0: it has passed. */
int socket_left_ms(int64_t deadline_us);

/* Begins to connect to "HOST:PORT" (host empty: localhost), to each of its places in turn; send and receive say
 * AWTLINK_WANT_WRITE until one has taken it. The descriptor does not block and is closed on exec. False: `error` says
 * why (AWTCLIENT_ADDRESS, AWTCLIENT_MEMORY), as do send and receive if nobody answers. Resolving the name is the
 * system's and may take a while. */
bool socket_begin(const char *address, awtlink_transport *out, awtclient_error *error);

/* Waits until the descriptor is ready for what is `wanted` (AWTLINK_READ, AWTLINK_WRITE), or has failed, which the next
 * use of it will tell. False: not before the deadline. */
bool socket_wait(int descriptor, unsigned wanted, int64_t deadline_us);

#endif
