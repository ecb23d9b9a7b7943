/* loop.h: one I/O thread: sleeps in poll, and gives its connections their turns.
 *
 * Slot 0 of the poll set is the bell of the loop's home, the rest its connections, one slot each, kept as the turns
 * leave them: a loop does nothing for a connection about which nothing is known. Turns are given to those that poll
 * names, to those that stand in the home's list, and to those whose time has come.
 *
 * A hot loop hands a connection that has become idle to the cold one, the cold one hands one that has become busy to
 * the hot loop with the fewest. The cold loop looks at all its sockets only now and then when it has many, so that
 * however often one of them says something, looking costs a small part of a processor. */
#ifndef LOOP_H
#define LOOP_H

#include "connection.h"

#include <poll.h>

typedef struct loop {
    service *shared;
    homes *all;
    home *own;
    uint32_t count, room;
    connection **seated;   /* [room], [count] in use: who has the slot after */
    struct pollfd *polled; /* [room + 1] */
    deadlines waits;
    bool stops;           /* has seen that the homes are stopping */
    int64_t look_from_us; /* no look at the sockets before */
} loop;

/* False: no memory. */
bool loop_init(loop *l, service *shared, homes *all, home *own);
/* After loop_run. Accepts a zeroed one. */
void loop_fini(loop *l);

/* Serves until homes_stop; then says BYE to everyone and returns when that is sent, or after LIMIT_STOP_FLUSH_US. No
 * connection is left then. */
void loop_run(loop *l);

#endif
