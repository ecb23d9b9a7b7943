/* load_watch.h: looks now and then at what the forests cost, and puts into force what load.h decides. */
#ifndef LOAD_WATCH_H
#define LOAD_WATCH_H

#include "service.h"

/* A job is done: its cost is its forest's. Looks at all forests if that is due. Under the service's lock. */
void load_watch_count(service *shared, resident *r);

/* True if no new forest should be taken. Under the service's lock. */
bool load_watch_is_full(service *shared);

#endif
