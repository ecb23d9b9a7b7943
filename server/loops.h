/* loops.h: all I/O threads: the hot loops, of which each has few busy connections, and the cold one with all that are
 * idle. */
#ifndef LOOPS_H
#define LOOPS_H

#include "loop.h"

#include <pthread.h>

typedef struct loops {
    service *shared;
    homes homes;
    loop *list;         /* [homes.hot_count + 1], heap */
    pthread_t *threads; /* likewise, [running] in use */
    uint32_t running;
} loops;

/* Starts `hot_count` hot loops and the cold one, with all signals blocked. False: no memory, descriptors or threads. */
bool loops_start(loops *all, service *shared, uint32_t hot_count);

/* Has a new connection (connection_create) served. Without the lock. */
void loops_add(loops *all, connection *c);

/* Has every loop end its connections, as loop_run says, and waits. */
void loops_stop(loops *all);

/* After loops_stop, and when no worker runs any more: workers ring the bells. Accepts a zeroed one. */
void loops_fini(loops *all);

#endif
