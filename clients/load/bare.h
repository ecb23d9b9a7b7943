/* bare.h: the members that load the bare server (floor.h), each the counterpart of one that loads the daemon: the same
 * sizes, the same times, and nothing but a length to read. NULL: why is in the run's book. */
#ifndef LOAD_BARE_H
#define LOAD_BARE_H

#include "load/member.h"

/* Asks for as many bytes as a frame of its head has. */
member *bare_asker_create(load_run *run, uint32_t head, int64_t phase_ns, int64_t period_ns);
/* Has a frame written to all who watch its head. */
member *bare_driver_create(load_run *run, uint32_t head, uint32_t viewers, int64_t phase_ns, int64_t period_ns);
/* Watches its head. */
member *bare_viewer_create(load_run *run, uint32_t head);
/* Comes, asks once and goes. */
member *bare_visitor_create(load_run *run, int64_t phase_ns, int64_t period_ns);

#endif
