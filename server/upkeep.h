/* upkeep.h: what only the clock brings about in the service as a whole: PROGRESS for those who wait for hair, the end
 * of what was parked, the end of forests that nobody has had open for long. Under the service's lock. */
#ifndef UPKEEP_H
#define UPKEEP_H

#include "service.h"

/* Monotonic time at which upkeep_do has something to do; INT64_MAX: never. */
int64_t upkeep_due_us(const service *shared);
/* Does what is due. */
void upkeep_do(service *shared, int64_t now_us);

#endif
