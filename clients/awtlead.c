/* awtlead.c: see awtlead.h. */
#include "awtlead.h"

#include "awtframes.h"

#define LEAST_US 20000        /* at first, beside the way */
#define MARGIN_US 3000        /* for decoding, and for what has not been seen yet */
#define LONGEST_GAP_US 100000 /* between frames of one motion, and of one that is not late */
#define SHRINKS 64            /* by one part of so many a step, so as not to swing */

static int64_t lesser(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

void awtlead_begin(awtlead *lead, int64_t step_us, int64_t greatest_us, int64_t round_us)
{
    const int64_t first_us = LEAST_US + 2 * round_us;
    *lead = (awtlead){.step_us = step_us, .greatest_us = greatest_us, .lead_us = lesser(first_us, greatest_us)};
    lead->next_us = lead->newest_us = lead->came_us = INT64_MIN;
}

/* By what the slowest of late needed, but not so far that those which come quickly are too many to be kept until their
 * time (AWTFRAMES_KEPT: two of them are shown from). Grows at once. */
static void choose(awtlead *lead)
{
    int64_t most_us = 0, least_us = INT64_MAX;
    for (uint32_t i = 0; i < AWTLEAD_NEEDED && i < lead->needed; i++) {
        most_us = lead->needed_us[i] > most_us ? lead->needed_us[i] : most_us;
        least_us = lesser(lead->needed_us[i], least_us);
    }
    if (lead->needed == 0) {
        return;
    }
    most_us = lesser(most_us + MARGIN_US, least_us + (AWTFRAMES_KEPT - 3) * lead->step_us);
    most_us = lesser(most_us, lead->greatest_us);
    lead->lead_us = most_us > lead->lead_us ? most_us : lead->lead_us - (lead->lead_us - most_us) / SHRINKS;
}

bool awtlead_ask(awtlead *lead, int64_t now_us, int64_t *time_us)
{
    if (now_us < lead->next_us) {
        return false;
    }
    const int64_t missed = lead->next_us == INT64_MIN ? -1 : (now_us - lead->next_us) / lead->step_us;
    lead->next_us = (missed < 0 ? now_us : lead->next_us) + (missed < 0 ? 1 : missed + 1) * lead->step_us;
    choose(lead);
    if (now_us + lead->lead_us <= lead->newest_us) {
        return false;
    }
    *time_us = lead->newest_us = now_us + lead->lead_us;
    lead->asked_us[lead->asked % AWTLEAD_ASKED] = *time_us;
    lead->at_us[lead->asked++ % AWTLEAD_ASKED] = now_us;
    return true;
}

void awtlead_came(awtlead *lead, int64_t now_us, int64_t time_us)
{
    for (uint32_t i = 0; i < AWTLEAD_ASKED && i < lead->asked; i++) {
        if (lead->asked_us[i] == time_us && time_us > lead->came_us) {
            /* What is shown since the frame before needs this one: it had to be asked for ahead by as much as went by
             * since that one was. */
            const bool follows = lead->came_us != INT64_MIN && lead->at_us[i] - lead->came_at_us < LONGEST_GAP_US;
            const int64_t since_us = follows ? lead->came_at_us : lead->at_us[i] - lead->step_us;
            if (now_us - lead->next_us < LONGEST_GAP_US) { /* else it is the caller who was late */
                lead->needed_us[lead->needed++ % AWTLEAD_NEEDED] = now_us - since_us;
            }
            lead->came_us = time_us;
            lead->came_at_us = lead->at_us[i];
            return;
        }
    }
}

int64_t awtlead_us(const awtlead *lead)
{
    return lead->lead_us;
}
