/* openrequests.h: the requests of a link that nobody has answered yet, and until when each may wait. Memory is taken
 * for those that are open at once. */
#ifndef CLIENTS_OPENREQUESTS_H
#define CLIENTS_OPENREQUESTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { OPENREQUESTS_MAX = 4096 };

typedef struct open_request {
    uint64_t request; /* 0: it has been answered */
    uint16_t type;
    int64_t deadline_us; /* INT64_MAX until openrequests_stamp */
} open_request;

/* A ring in order of deadlines, for all wait equally long. Zeroed: empty. */
typedef struct openrequests {
    open_request *ring; /* heap */
    size_t capacity, first, count;
} openrequests;

void openrequests_fini(openrequests *open);

/* Room for one more. False: there are OPENREQUESTS_MAX, or no memory. */
bool openrequests_reserve(openrequests *open);
/* Adds one, after openrequests_reserve. */
void openrequests_add(openrequests *open, uint64_t request, uint16_t type);
/* It has been answered; one that is not open is passed over. */
void openrequests_remove(openrequests *open, uint64_t request);
/* Work on it goes on: it waits anew. */
void openrequests_prolong(openrequests *open, uint64_t request);
/* Those that wait since the last call wait until `deadline_us`, which is no earlier than any before. */
void openrequests_stamp(openrequests *open, int64_t deadline_us);

/* The one whose deadline is first; NULL: none is open. */
const open_request *openrequests_first(const openrequests *open);

#endif
