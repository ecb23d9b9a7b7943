/* wait.h: the generator's clock, and waiting by it until a descriptor is ready or a time has come. */
#ifndef LOAD_WAIT_H
#define LOAD_WAIT_H

#include <poll.h>
#include <stdint.h>

/* Nanoseconds of the monotonic clock. */
int64_t wait_now_ns(void);

/* For each thread that waits, before it does: as exact as the system lets it. */
void wait_exactly(void);

/* As poll(), until a time of that clock. Linux wakes within microseconds of it; plain POSIX counts in milliseconds, so
 * that there the last one is waited through in turns of poll() that do not wait. */
int wait_poll(struct pollfd *polls, nfds_t count, int64_t until_ns);

#endif
