/* parts.h: parts of jobs, which those that run the jobs offer to whoever is free (base/spread.h). The lists alone:
 * under the lock of whoever keeps them. */
#ifndef PARTS_H
#define PARTS_H

#include "base/spread.h"

#include <stdbool.h>

/* What one job offers; on the stack of who runs it, until all of its parts are done. */
typedef struct parts {
    spread_part part;
    void *work;
    uint32_t count, next; /* parts, and the first that nobody has taken */
    uint32_t running;
    struct parts *following;
} parts;

/* Offers that have parts to take, the oldest first. */
typedef struct parts_list {
    parts *first, *last;
} parts_list;

void parts_offer(parts_list *list, parts *offered);
/* Takes a part of `from`, or with NULL of the oldest offer. NULL: there is none to take. */
parts *parts_take(parts_list *list, parts *from, uint32_t *index);
/* A part that was taken is done. True: it was the last, and nobody holds `of` any more. */
bool parts_end(parts *of);

#endif
