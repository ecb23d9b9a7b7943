/* log_limit.c: see log_limit.h. */
#include "log_limit.h"

#include <string.h>

static log_limit_event *find_event(log_limiter *limiter, const char *name)
{
    for (size_t i = 0; i < limiter->count; i++) {
        if (strcmp(limiter->events[i].name, name) == 0) {
            return &limiter->events[i];
        }
    }
    if (limiter->count == LIMIT_LOG_EVENTS) {
        return &limiter->events[LIMIT_LOG_EVENTS - 1];
    }
    limiter->events[limiter->count] = (log_limit_event){.name = name};
    return &limiter->events[limiter->count++];
}

bool log_limit_take(log_limiter *limiter, const char *event, int64_t now_us, uint64_t *suppressed)
{
    const int64_t line_us = 1000000 / LIMIT_LOG_PER_S;
    log_limit_event *e = find_event(limiter, event);
    int64_t free_us = e->free_us > now_us ? e->free_us : now_us;
    if (free_us + line_us > now_us + LIMIT_LOG_BURST * line_us) {
        e->suppressed++;
        return false;
    }
    e->free_us = free_us + line_us;
    *suppressed = e->suppressed;
    e->suppressed = 0;
    return true;
}
