/* pose_delay.c: see pose_delay.h. */
#include "pose_delay.h"
#include "awt.h"
#include "limits.h"

enum { SHRINK = 512 /* of the time that passes, the part by which the delay shrinks at most */ };

/* The delay with which the pose before would still have been ahead of the last step when this one came. One that
 * begins a motion has none before it: it must be ahead itself. */
static int64_t needed_us(const pose_delay *d, int64_t time_us, int64_t arrived_us)
{
    const bool goes_on = d->began && time_us - d->last_us <= LIMIT_POSE_DELAY_US;
    const int64_t needed = arrived_us + AWT_STEP_US - (goes_on ? d->last_us : time_us);
    return needed < 0 ? 0 : needed > LIMIT_POSE_DELAY_US ? LIMIT_POSE_DELAY_US : needed;
}

int64_t pose_delay_map(pose_delay *d, int64_t time_us, int64_t arrived_us)
{
    const int64_t needed = needed_us(d, time_us, arrived_us);
    const int64_t shrunk = d->delay_us - (d->began ? (time_us - d->last_us) / SHRINK : 0);
    d->delay_us = needed > shrunk ? needed : shrunk;
    d->began = true;
    d->last_us = time_us;
    return time_us + d->delay_us;
}
