/* pose_delay.h: when the poses of a free-running forest are taken, so that uneven arrivals give even motion.
 *
 * The head moves between two poses, so a pose must be there before the one ahead of it is reached; where a client
 * stamps its poses with the present time they come too late for that. So all poses of a forest are shown later by a
 * delay, which grows at once to what the latest pose would have needed, and shrinks slowly. A client that gives its
 * poses ahead of time has no delay: they are taken at just their times. */
#ifndef POSE_DELAY_H
#define POSE_DELAY_H

#include <stdbool.h>
#include <stdint.h>

/* Zeroed: nothing has come yet. */
typedef struct pose_delay {
    bool began;
    int64_t last_us;  /* time of the last pose, as its sender gave it */
    int64_t delay_us; /* 0 .. LIMIT_POSE_DELAY_US */
} pose_delay;

/* The time at which a pose is taken that its sender gave for `time_us`, later than any before, and that came at the
 * simulated time `arrived_us`. Times so given rise too. */
int64_t pose_delay_map(pose_delay *d, int64_t time_us, int64_t arrived_us);

#endif
