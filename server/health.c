/* health.c: see health.h. */
#include "health.h"
#include "limits.h"
#include "wake.h"

#include <stdatomic.h>
#include <stddef.h>

static atomic_bool serving;
static _Atomic int64_t refusing_until_us = INT64_MIN;

void health_set_serving(void)
{
    atomic_store(&serving, true);
}

void health_set_overloaded(bool overloaded, int64_t now_us)
{
    atomic_store(&refusing_until_us, overloaded ? now_us + LIMIT_OVERLOADED_US : INT64_MIN);
}

const char *health_unready(int64_t now_us)
{
    if (wake_stop_asked()) {
        return "draining";
    }
    if (!atomic_load(&serving)) {
        return "starting";
    }
    return now_us < atomic_load(&refusing_until_us) ? "overloaded" : NULL;
}
