/* log_limit.h: how many lines of one event the log takes, so that no peer fills a disk by doing one thing again and
 * again. Every event has LIMIT_LOG_BURST lines at once and LIMIT_LOG_PER_S a second from then on. Pure: no clock. */
#ifndef SERVER_LOG_LIMIT_H
#define SERVER_LOG_LIMIT_H

#include "limits.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct log_limit_event {
    const char *name;    /* a literal */
    int64_t free_us;     /* as if lines were written up to here */
    uint64_t suppressed; /* lines left out since the last one written */
} log_limit_event;

/* A zeroed one is fresh. */
typedef struct log_limiter {
    size_t count;
    log_limit_event events[LIMIT_LOG_EVENTS]; /* those beyond share the last */
} log_limiter;

/* True: the line may be written; *suppressed lines of the event were left out before it. `now_us` is monotonic. */
bool log_limit_take(log_limiter *limiter, const char *event, int64_t now_us, uint64_t *suppressed);

#endif
