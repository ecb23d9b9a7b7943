/* loop.h: the I/O thread: sleeps in poll, and gives every connection its turn.
 *
 * Slot 0 of the poll set is the wake pipe, slot 1 the listener, the rest the connections. Connections come and go only
 * after every slot has been looked at. The loop holds the service's lock except while it sleeps; whoever has given a
 * connection something to send rings the pipe. */
#ifndef LOOP_H
#define LOOP_H

#include "connection.h"
#include "wake.h"

#include <poll.h>

typedef struct loop {
    service *shared;
    wake *bell;
    int listener; /* -1: none is accepted any more */
    uint32_t greatest, room, count;
    connection **connections; /* [room], [count] in use */
    struct pollfd *polled;    /* [room + 2] */
    int64_t accept_from_us;   /* no accept before: descriptors had run out */
} loop;

/* The loop takes the listener. Up to `greatest` connections. False: no memory; the listener is closed then. */
bool loop_init(loop *l, service *shared, wake *bell, int listener, uint32_t greatest);
/* Closes what is open. */
void loop_fini(loop *l);

/* Serves until a signal asks to stop; then says BYE to everyone and returns when that is sent, or after
 * LIMIT_STOP_FLUSH_US. */
void loop_run(loop *l);

#endif
