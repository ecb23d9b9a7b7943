/* hand.h: one thread of the load: a small poll set, in which the daemon's members and the bare server's take turns.
 * Private to crew.c. */
#ifndef LOAD_HAND_H
#define LOAD_HAND_H

#include "load/member.h"

#include <poll.h>
#include <pthread.h>

/* The members of one side of one hand. Those that send come in the order of their phases, so that the next one due is
 * always the one after the last. */
typedef struct group {
    member **members; /* [count] heap */
    size_t count, capacity;
    size_t next; /* whose request is due next */
    bool over;   /* no more are due in this run */
} group;

typedef struct hand {
    load_run *run;
    group groups[LOAD_SIDES];
    struct pollfd *polls; /* [capacity of both groups] */
    uint32_t slice;
    pthread_t thread;
} hand;

/* Takes the member. False: no memory, and it stays the caller's. */
bool hand_add(hand *h, member *m);
/* All members leave. */
void hand_leave(hand *h);

/* All members may be measured. */
bool hand_ready(const hand *h);
/* Lets what comes within a moment have its turn, in the caller's thread. */
void hand_gather(hand *h);

/* Before a run. */
void hand_begin(hand *h);
/* The thread of a run: through run->line, then until all answers are there, but not long. */
void *hand_run(void *hand);

#endif
