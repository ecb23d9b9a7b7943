/* making.h: how far forests have come that are being made, told to those who want to know (CREATE's `progress`).
 *
 * The worker only leaves a note; the main thread looks at the notes now and then while there is someone to tell. So
 * neither waits for the other, and what a slow client is told is not queued. */
#ifndef MAKING_H
#define MAKING_H

#include "service.h"

/* Monotonic time at which making_tell has something to say; INT64_MAX: never. */
int64_t making_due_us(const service *shared);

/* Sends every PROGRESS that is due. Under the service's lock. */
void making_tell(service *shared, int64_t now_us);

#endif
