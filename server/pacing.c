/* pacing.c: see pacing.h. */
#include "pacing.h"
#include "awt.h"
#include "limits.h"

static int64_t interval_us(const pacing *p)
{
    if (p->asleep) {
        return p->interval_us > 0 ? LIMIT_FREE_ASLEEP_US : LIMIT_FREE_FORGOTTEN_US;
    }
    if (p->interval_us == 0) {
        return LIMIT_FREE_UNSEEN_US;
    }
    return p->interval_us > AWT_STEP_US ? p->interval_us : AWT_STEP_US;
}

pacing_turn pacing_next(const pacing *p, int64_t now_us)
{
    const int64_t interval = interval_us(p);
    int64_t due_us = sim_clock_when(p->clock, p->shown_us) + interval;
    if (p->wanted_now || due_us < now_us - interval) {
        due_us = now_us;
    }
    const int64_t patience_us = p->wanted_now && interval > LIMIT_STEP_US ? LIMIT_STEP_US : interval;
    return (pacing_turn){
        .not_before_us = due_us, .deadline_us = due_us + patience_us, .to_us = sim_clock_at(p->clock, due_us)};
}
