/* caller.h: the members that load the daemon. NULL: why is in the run's book. */
#ifndef LOAD_CALLER_H
#define LOAD_CALLER_H

#include "load/member.h"

/* Opens its head to look at, and asks for its latest frame. */
member *caller_asker_create(load_run *run, uint32_t head, int64_t phase_ns, int64_t period_ns);
/* Moves its head on by a step, of which so many viewers get a frame. */
member *caller_driver_create(load_run *run, uint32_t head, uint32_t viewers, int64_t phase_ns, int64_t period_ns);
/* Subscribes to its head. `stalls`: reads nothing in laden slices, and is not measured. */
member *caller_viewer_create(load_run *run, uint32_t head, bool stalls);
/* Comes, opens its head, asks once and goes. */
member *caller_visitor_create(load_run *run, uint32_t head, int64_t phase_ns, int64_t period_ns);
/* Comes in each of the daemon's slices, makes a head of its own, asks once, ends it and goes. Not measured. */
member *caller_maker_create(load_run *run);

#endif
