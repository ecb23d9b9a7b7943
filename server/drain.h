/* drain.h: the daemon's way out: clients are told, what they still ask is done for a while, then nothing is taken any
 * more, and every forest that changed is brought to the disk. */
#ifndef DRAIN_H
#define DRAIN_H

#include "service.h"

/* Tells every client (GOAWAY) and waits until none is connected, for `grace_us` at most, or until `hurried` says that
 * it was asked to stop once more. From then on every message is refused (STOPPING). Without the lock. */
void drain_clients(service *shared, int64_t grace_us, bool (*hurried)(void));

/* Has all that changed brought to the disk, and waits until it is there. False: something could not be written (it is
 * logged). Without the lock; nobody may step forests any more but workers that finish what they have. */
bool drain_forests(service *shared);

#endif
