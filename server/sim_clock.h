/* sim_clock.h: how a forest's simulated time goes: by the driver's requests, by the daemon's clock, or not at all. */
#ifndef SIM_CLOCK_H
#define SIM_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

/* Numbers of SET_CLOCK's `mode`. */
typedef enum clock_mode { CLOCK_LOCK_STEP, CLOCK_FREE, CLOCK_PAUSED } clock_mode;

/* Rates that a clock takes, simulated seconds per second. */
#define CLOCK_RATE_LEAST 0.01
#define CLOCK_RATE_GREATEST 10.0

/* Zeroed: lock-step. */
typedef struct sim_clock {
    clock_mode mode;
    double rate;
    int64_t wall_us, sim_us; /* free-running: at this monotonic time it was that simulated time */
} sim_clock;

/* The simulated time at a monotonic time; of a clock that does not run, the time at which it stands. */
int64_t sim_clock_at(const sim_clock *c, int64_t wall_us);
/* The monotonic time at which a free-running clock reaches a simulated time, rounded up. */
int64_t sim_clock_when(const sim_clock *c, int64_t sim_us);

/* From now on so. The time goes on from where it is, but not from before `least_us`. */
void sim_clock_set(sim_clock *c, clock_mode mode, double rate, int64_t least_us, int64_t wall_us);

#endif
