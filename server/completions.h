/* completions.h: what workers have done, brought to those who asked. */
#ifndef COMPLETIONS_H
#define COMPLETIONS_H

#include "service.h"

/* Takes every finished job: answers CREATE, QUERY and BINDING, offers pictures to subscribers, reports refused motions,
 * frees doomed forests, has the next jobs run. Under the service's lock. True if there were any. */
bool completions_take(service *shared);

#endif
