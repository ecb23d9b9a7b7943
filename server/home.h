/* home.h: where a connection lives, as all other threads see it.
 *
 * Every loop has a home: the list of those of its connections that others have given something to do, and the bell that
 * ends its sleep. A connection that is new, or that moves, arrives in that list too. Homes are guarded by the service's
 * lock (service.h); the bells that have to ring are rung when the lock is let go, each once, and only where a loop
 * sleeps and has not been rung already.
 *
 * The hot homes are for connections that are busy: poll's cost grows with what it looks at, so each has few. The cold
 * one has all that are idle. */
#ifndef HOME_H
#define HOME_H

#include "wake.h"

#include <stdint.h>

struct service;

/* A connection's place in a home's list. */
typedef struct home_link {
    struct home_link *next;
    void *owner;
    bool listed;
} home_link;

typedef struct home {
    wake bell;
    home_link *first, *last;
    uint32_t told;  /* in the list */
    uint32_t count; /* that live here */
    bool is_cold;
    bool asleep, rung;      /* `rung`: since it fell asleep */
    struct home *next_rung; /* in the service's list of those whose bells must ring */
} home;

typedef struct homes {
    home *list; /* [hot_count + 1], heap; the last is the cold one */
    uint32_t hot_count;
    bool stopping; /* set once; nobody moves from then on */
} homes;

/* False: no memory or no descriptors; nothing is left behind then. */
bool homes_init(homes *all, uint32_t hot_count);
/* Accepts a zeroed one. */
void homes_fini(homes *all);

home *homes_cold(const homes *all);
/* Where a busy connection should live. */
home *homes_hot(const homes *all);

/* ---- under the service's lock -------------------------------------------------------------------------------------
 */

/* The owner of `link` wants a turn of its loop. */
void home_tell(home *h, struct service *shared, home_link *link);
/* Ends the loop's sleep without naming anybody. */
void home_ring(home *h, struct service *shared);

/* The owner of the first in the list, which leaves it; NULL: the list is empty. */
void *home_take(home *h);

/* Before and after a loop sleeps. It must not sleep where the list is not empty. */
void home_falls_asleep(home *h);
void home_wakes(home *h);

#endif
