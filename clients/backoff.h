/* backoff.h: how long to wait before trying again: 0.1 s, twice as long each time, up to 5 s; half of it by chance, so
 * that many who lost the same daemon do not come back at once. */
#ifndef CLIENTS_BACKOFF_H
#define CLIENTS_BACKOFF_H

#include <stdint.h>

/* Zeroed but for `random`, which should differ between those who wait. */
typedef struct backoff {
    unsigned tries;
    uint64_t random;
} backoff;

/* Another try has failed: microseconds until the next one, no fewer than `least_ms` make. */
int64_t backoff_failed(backoff *self, uint32_t least_ms);

#endif
