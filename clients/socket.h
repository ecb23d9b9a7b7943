/* socket.h: a TCP connection whose every wait ends at a deadline. It knows no message. */
#ifndef AWTCLIENT_SOCKET_H
#define AWTCLIENT_SOCKET_H

#include "awtclient.h"

/* Microseconds of the monotonic clock. */
int64_t socket_now_us(void);
/* Milliseconds until the deadline, rounded up; 0: it has passed. */
int socket_left_ms(int64_t deadline_us);

/* Connects to "HOST:PORT" (host empty: localhost): a descriptor that does not block, closed on exec; -1: `error` says
 * why (AWTCLIENT_ADDRESS). Resolving the name is the system's and may take longer than the deadline. */
int socket_open(const char *address, int64_t deadline_us, awtclient_error *error);

/* Accepts -1. */
void socket_close(int descriptor);

typedef enum socket_result { SOCKET_DONE, SOCKET_LATE, SOCKET_ENDED } socket_result;

/* Sends `head`, then `tail`, whole. After anything but SOCKET_DONE part of them may have gone out. */
socket_result socket_send(int descriptor, proto_blob head, proto_blob tail, int64_t deadline_us);
/* Waits for bytes and takes those that are there, *got > 0 of them and at most `size`. */
socket_result socket_receive(int descriptor, void *bytes, size_t size, size_t *got, int64_t deadline_us);

#endif
