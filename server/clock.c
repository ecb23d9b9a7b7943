/* clock.c: see clock.h. */
#include "clock.h"
#include "limits.h"

#include <time.h>

enum { LONGEST_POLL_US = 60000000 };

int64_t clock_monotonic_us(void)
{
    struct timespec now = {0};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

int clock_poll_ms(int64_t now_us, int64_t until_us)
{
    if (until_us == INT64_MAX) {
        return -1;
    }
    int64_t left_us = until_us - now_us;
    return left_us <= 0 ? 0 : left_us >= LONGEST_POLL_US ? LONGEST_POLL_US / 1000 : (int)((left_us + 999) / 1000);
}

bool clock_is_over(int64_t *since_us, int64_t patience_us, int64_t now_us)
{
    const int64_t late_us = now_us - *since_us - patience_us;
    if (late_us > LIMIT_SLEPT_US) {
        *since_us = now_us;
    }
    return late_us >= 0 && late_us <= LIMIT_SLEPT_US;
}

uint32_t clock_between_us(int64_t from_us, int64_t to_us)
{
    int64_t between = to_us - from_us;
    return between <= 0 ? 0 : between >= (int64_t)UINT32_MAX ? UINT32_MAX : (uint32_t)between;
}
