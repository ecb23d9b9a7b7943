/* awtpace.c: see awtpace.h. */
#include "awtpace.h"

#define SLEW 0.05
#define JUMP_US 1e6
#define LONGEST_GAP_US 250000 /* between frames of one motion */

void awtpace_arrived(awtpace *pace, int64_t now_us, int64_t time_us)
{
    const bool follows = pace->count > 0 && time_us > pace->newest_us && time_us - pace->newest_us < LONGEST_GAP_US;
    pace->behind_us[pace->count++ % AWTPACE_SAMPLES] = now_us - (follows ? pace->newest_us : time_us);
    pace->newest_us = time_us;
}

/* What the latest frame of those remembered needed, within the bound. */
static double wanted(const awtpace *pace, int64_t greatest_us)
{
    int64_t least = INT64_MAX, most = INT64_MIN;
    for (uint32_t i = 0; i < AWTPACE_SAMPLES && i < pace->count; i++) {
        least = pace->behind_us[i] < least ? pace->behind_us[i] : least;
        most = pace->behind_us[i] > most ? pace->behind_us[i] : most;
    }
    return (double)(most - least > greatest_us ? least + greatest_us : most);
}

bool awtpace_time(awtpace *pace, int64_t now_us, int64_t greatest_us, int64_t *time_us)
{
    if (pace->count == 0) {
        return false;
    }
    const double target = wanted(pace, greatest_us), off = target - pace->behind;
    const double most = SLEW * (double)(now_us - pace->last_now_us);
    if (!pace->running || off > JUMP_US || off < -JUMP_US) {
        pace->behind = target;
    } else {
        pace->behind += off > most ? most : off < -most ? -most : off;
    }
    const int64_t at_us = now_us - (int64_t)pace->behind;
    pace->shown_us = pace->running && at_us < pace->shown_us ? pace->shown_us : at_us;
    pace->running = true;
    pace->last_now_us = now_us;
    *time_us = pace->shown_us;
    return true;
}
