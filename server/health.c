/* health.c: see health.h. */
#include "health.h"
#include "wake.h"

#include <stdatomic.h>
#include <stddef.h>

static atomic_bool serving, refusing;

void health_set_serving(void)
{
    atomic_store(&serving, true);
}

void health_set_overloaded(bool overloaded)
{
    atomic_store(&refusing, overloaded);
}

const char *health_unready(void)
{
    if (wake_stop_asked()) {
        return "draining";
    }
    if (!atomic_load(&serving)) {
        return "starting";
    }
    return atomic_load(&refusing) ? "overloaded" : NULL;
}
