/* reload.h: settings read again while the daemon runs: all of what has changed, or nothing.
 *
 * What may change: log-level, log-format, max-forests up to what it was at the start, and the accounts. Clients whose
 * token was taken back are sent away. Where anything else has
 * changed, or the settings are wrong, everything stays as it was, and the log says why. */
#ifndef RELOAD_H
#define RELOAD_H

#include "config.h"
#include "service.h"

typedef struct reload {
    config running; /* what holds now; at the start, what was asked */
    uint32_t most_forests;
    service *shared;
} reload;

/* Reads the settings as they were read at the start, and takes them over or refuses them. `context` is a reload. One
 * thread alone, without the service's lock. */
void reload_settings(void *context);

#endif
