/* clock_seam.c: see clock_seam.h. */
#include "unit/clock_seam.h"

#include <stdatomic.h>
#include <time.h>

static atomic_int_fast64_t shift_s;
static atomic_uint_fast64_t readings;

int __real_clock_gettime(clockid_t clock, struct timespec *now);
int __wrap_clock_gettime(clockid_t clock, struct timespec *now);
int __wrap_clock_gettime(clockid_t clock, struct timespec *now)
{
    const int result = __real_clock_gettime(clock, now);
    if (result == 0 && clock == CLOCK_REALTIME) {
        readings++;
        now->tv_sec += (time_t)shift_s;
    }
    return result;
}

time_t __real_time(time_t *now);
time_t __wrap_time(time_t *now);
time_t __wrap_time(time_t *now)
{
    const time_t shifted = __real_time(NULL) + (time_t)shift_s;
    readings++;
    if (now) {
        *now = shifted;
    }
    return shifted;
}

void clock_shift_wall(int64_t seconds)
{
    shift_s = seconds;
}

uint64_t clock_wall_readings(void)
{
    return readings;
}
