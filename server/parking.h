/* parking.h: what clients held whose connections were cut off, kept for a time under their session's token, until
 * RESUME asks for it. Bounded: where too many are parked, the one that would be given up first makes room. Under the
 * service's lock. */
#ifndef PARKING_H
#define PARKING_H

#include "holdings.h"

enum { PARKING_TOKEN_SIZE = 16 };

struct parked;

/* Zeroed: nobody is parked. */
typedef struct parking {
    struct parked *first, *last; /* the one to be given up first comes first */
    uint32_t count;
} parking;

/* Gives up all. */
void parking_fini(parking *p, const registry *forests, int64_t now_us);

/* Takes `left` (which is nothing then) and keeps it until then; where there is no memory, it is given up now. */
void parking_leave(parking *p, const uint8_t token[PARKING_TOKEN_SIZE], holdings *left, const registry *forests,
                   int64_t now_us, int64_t until_us);

/* Hands over what is parked under the token, into a zeroed *out. False: nothing is. */
bool parking_take(parking *p, const uint8_t token[PARKING_TOKEN_SIZE], holdings *out);

/* When the next one's time is over; INT64_MAX: nobody is parked. */
int64_t parking_due_us(const parking *p);
/* Gives up those whose time is over; where that was slept through (LIMIT_SLEPT_US), all have `grace_us` anew. */
void parking_expire(parking *p, const registry *forests, int64_t now_us, int64_t grace_us);

#endif
