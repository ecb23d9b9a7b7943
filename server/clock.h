/* clock.h: the monotonic clock, in the one unit of time there is. */
#ifndef SERVER_CLOCK_H
#define SERVER_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

/* Microseconds since some fixed moment. Any thread. */
int64_t clock_monotonic_us(void);

/* Milliseconds that poll may sleep until then, at most a minute (whoever wakes too early sleeps again); INT64_MAX: -1,
 * as long as nothing happens. */
int clock_poll_ms(int64_t now_us, int64_t until_us);

/* Whether the patience since *since_us is over. Where it has been for more than LIMIT_SLEPT_US nobody was there to
 * look: the machine slept, or the process was stopped, and so whoever is waited for could do nothing either. Then it
 * begins anew (false). */
bool clock_is_over(int64_t *since_us, int64_t patience_us, int64_t now_us);

/* The time between two readings as the wire's u32 wants it: 0 .. UINT32_MAX. */
uint32_t clock_between_us(int64_t from_us, int64_t to_us);

#endif
