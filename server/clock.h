/* clock.h: the monotonic clock, in the one unit of time there is. */
#ifndef SERVER_CLOCK_H
#define SERVER_CLOCK_H

#include <stdint.h>

/* Microseconds since some fixed moment. Any thread. */
int64_t clock_monotonic_us(void);

/* The time between two readings as the wire's u32 wants it: 0 .. UINT32_MAX. */
uint32_t clock_between_us(int64_t from_us, int64_t to_us);

#endif
