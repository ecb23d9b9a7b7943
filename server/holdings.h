/* holdings.h: what a client has here apart from its connection: the forests that it has open, and its uploads. They can
 * outlive a connection that was cut off (parking.h). Under the service's lock. */
#ifndef HOLDINGS_H
#define HOLDINGS_H

#include "registry.h"
#include "upload.h"

/* A forest that may be looked at, or moved too. */
typedef struct attachment {
    uint64_t forest;
    bool may_drive;
} attachment;

/* Zeroed: nothing. */
typedef struct holdings {
    attachment *attachments; /* [capacity], heap; some may be of forests that have ended */
    uint32_t count, capacity;
    upload *uploads[LIMIT_SESSION_UPLOADS]; /* references; NULL: free */
} holdings;

/* Leaves nothing. Forests that nobody has open any more count from `now_us`. Accepts a zeroed one. */
void holdings_fini(holdings *h, const registry *forests, int64_t now_us);
bool holdings_are_none(const holdings *h);

/* NULL: that forest is not open. */
attachment *holdings_find(const holdings *h, uint64_t forest);

/* Opens a forest, or widens what may be done there. 0, or PROTO_ERROR_LIMIT (LIMIT_SESSION_FORESTS are open) or
 * PROTO_ERROR_NO_MEMORY. */
int holdings_open(holdings *h, const registry *forests, resident *r, bool may_drive);
/* Nothing where it is not open. */
void holdings_close(holdings *h, const registry *forests, uint64_t forest, int64_t now_us);

/* Forests open that still are and may be driven. */
uint32_t holdings_driven(const holdings *h, const registry *forests);

#endif
