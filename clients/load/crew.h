/* crew.h: the hands that make the load: threads with a small poll set each, in which the daemon's members and the bare
 * server's take turns. */
#ifndef LOAD_CREW_H
#define LOAD_CREW_H

#include "load/member.h"

typedef struct crew crew;

/* So many hands, without a thread yet. NULL: no memory. */
crew *crew_create(load_run *run, uint32_t hands);
/* Members leave. Accepts NULL. */
void crew_destroy(crew *c);

/* Takes the member; it goes to the hand with the fewest of its side. False: no memory, and the member stays the
 * caller's. */
bool crew_add(crew *c, member *m);

/* Lets the members run without a clock until all are ready. False: one failed (the book says why), or it took longer
 * than `most_ns`. */
bool crew_gather(crew *c, int64_t most_ns);

/* Runs the load through run->line, which begins now. `show` is called about ten times a second, by the caller's thread.
 * False: a thread could not be started. */
bool crew_run(crew *c, void (*show)(load_run *run, int64_t at_ns));

#endif
