/* sim_clock.c: see sim_clock.h. */
#include "sim_clock.h"
#include "base/assert.h"

#include <math.h>

int64_t sim_clock_at(const sim_clock *c, int64_t wall_us)
{
    if (c->mode != CLOCK_FREE) {
        return c->sim_us;
    }
    return c->sim_us + (int64_t)floor((double)(wall_us - c->wall_us) * c->rate);
}

int64_t sim_clock_when(const sim_clock *c, int64_t sim_us)
{
    ASSERT(c->mode == CLOCK_FREE);
    return c->wall_us + (int64_t)ceil((double)(sim_us - c->sim_us) / c->rate);
}

void sim_clock_set(sim_clock *c, clock_mode mode, double rate, int64_t least_us, int64_t wall_us)
{
    const int64_t sim_us = sim_clock_at(c, wall_us);
    *c = (sim_clock){.mode = mode, .rate = rate, .wall_us = wall_us, .sim_us = sim_us > least_us ? sim_us : least_us};
}
