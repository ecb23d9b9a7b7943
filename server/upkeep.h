/* upkeep.h: what only the clock brings about in the service as a whole: PROGRESS for those who wait for hair, the end
 * of what was parked, the end of forests that nobody has had open for long, the rounds of bringing forests to the
 * disk. Under the service's lock. */
#ifndef UPKEEP_H
#define UPKEEP_H

#include "service.h"

/* Monotonic time at which upkeep_do has something to do; INT64_MAX: never. */
int64_t upkeep_due_us(const service *shared);
/* Does what is due. */
void upkeep_do(service *shared, int64_t now_us);

/* Has every forest that changed brought to the disk, now, and those that could not be when it was tried last; nothing
 * without a keeper. */
void upkeep_keep_all(service *shared);
/* True if every change that upkeep_keep_all was asked for has been offered to the keeper. */
bool upkeep_kept_all(const service *shared);
/* How many are not kept as they are: the keeper did not get them, for want of memory or because too much waits for the
 * disk. upkeep_keep_all tries again. */
uint32_t upkeep_unkept(const service *shared);

#endif
