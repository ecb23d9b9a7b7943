/* idle.h: connections that are in and say nothing, held by a thread of their own. */
#ifndef LOAD_IDLE_H
#define LOAD_IDLE_H

#include "load/member.h"

typedef struct idle idle;

/* Opens up to `count`; as many as the daemon and the system take, at least one, else NULL: the book says why. *held is
 * how many they are. */
idle *idle_open(load_run *run, uint32_t count, uint32_t *held);
/* Accepts NULL. Those that the daemon let go meanwhile are counted as errors. */
void idle_close(idle *i);

#endif
