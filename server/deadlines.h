/* deadlines.h: many times at which something is due, and the earliest of them at hand: a heap. A deadline is a member
 * of the thing that waits. One thread's. */
#ifndef DEADLINES_H
#define DEADLINES_H

#include <stdbool.h>
#include <stdint.h>

typedef struct deadline {
    void *owner;
    int64_t at_us;
    uint32_t place; /* in the heap, from 1; 0: not there */
} deadline;

typedef struct deadlines {
    deadline **heap; /* [room], heap */
    uint32_t count, room;
} deadlines;

/* Frees; accepts a zeroed one. A zeroed one is empty. */
void deadlines_fini(deadlines *all);

/* Room for so many, so that deadlines_set does not fail. False: no memory. */
bool deadlines_reserve(deadlines *all, uint32_t count);

/* Sets or moves it; INT64_MAX: takes it out. */
void deadlines_set(deadlines *all, deadline *d, int64_t at_us);

/* The earliest; NULL: there is none. */
deadline *deadlines_first(const deadlines *all);

#endif
