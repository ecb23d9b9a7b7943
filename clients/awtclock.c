/* awtclock.c: see awtclock.h. */
#include "awtclock.h"

#define UNEVEN_US 50000 /* more than this is taken for a queue, which a larger window would only lengthen */
#define LONGEST_US (INT64_C(1) << 60) /* times beyond this are no times, and sums of these do not overflow */

static bool time_good(int64_t time_us)
{
    return time_us > -LONGEST_US && time_us < LONGEST_US;
}

bool awtclock_add(awtclock *clock, int64_t sent_us, int64_t received_us, int64_t answered_us, int64_t arrived_us)
{
    if (!time_good(sent_us) || !time_good(received_us) || !time_good(answered_us) || !time_good(arrived_us)) {
        return false;
    }
    const int64_t round_us = (arrived_us - sent_us) - (answered_us - received_us);
    if (arrived_us < sent_us || answered_us < received_us || round_us < 0) {
        return false;
    }
    const uint32_t at = clock->count++ % AWTCLOCK_SAMPLES;
    clock->offset_us[at] = (received_us - sent_us) / 2 + (answered_us - arrived_us) / 2;
    clock->round_us[at] = round_us;
    return true;
}

/* The exchange of the least round; -1: none. */
static int best(const awtclock *clock)
{
    int least = -1;
    for (int i = 0; i < AWTCLOCK_SAMPLES && (uint32_t)i < clock->count; i++) {
        least = least < 0 || clock->round_us[i] < clock->round_us[least] ? i : least;
    }
    return least;
}

bool awtclock_offset(const awtclock *clock, int64_t *offset_us, int64_t *uncertainty_us)
{
    const int at = best(clock);
    if (at < 0) {
        return false;
    }
    *offset_us = clock->offset_us[at];
    *uncertainty_us = clock->round_us[at] / 2 + 1;
    return true;
}

int64_t awtclock_round_us(const awtclock *clock)
{
    const int at = best(clock);
    return at < 0 ? 0 : clock->round_us[at];
}

int64_t awtclock_age_us(const awtclock *clock, uint32_t age_us)
{
    return (int64_t)age_us + awtclock_round_us(clock) / 2;
}

uint32_t awtclock_credit(const awtclock *clock, double rate, int64_t target_age_us)
{
    const int64_t least_us = awtclock_round_us(clock);
    int64_t round_us = least_us;
    for (int i = 0; i < AWTCLOCK_SAMPLES && (uint32_t)i < clock->count; i++) {
        round_us = clock->round_us[i] > round_us ? clock->round_us[i] : round_us;
    }
    round_us = round_us - least_us > UNEVEN_US ? least_us + UNEVEN_US : round_us;
    const double wanted = (double)round_us * 1e-6 * rate + 2;
    const double greatest = (double)target_age_us * 1e-6 * rate;
    const double window = wanted < greatest ? wanted : greatest;
    return window >= 1 ? window < 1000 ? (uint32_t)(window + 1e-6) : 1000 : 1;
}
