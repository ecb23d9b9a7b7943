/* pacing.h: when a free-running forest has its next turn, and what simulated time it is brought to. */
#ifndef PACING_H
#define PACING_H

#include "sim_clock.h"

/* What is known of the forest. */
typedef struct pacing {
    const sim_clock *clock; /* CLOCK_FREE */
    int64_t shown_us;       /* simulated time of its last turn */
    int64_t interval_us;    /* between the frames that are wanted; 0: nobody looks */
    bool asleep;            /* all of its hair, and no motion waits */
    bool wanted_now;        /* somebody asked for the latest frame */
} pacing;

typedef struct pacing_turn {
    int64_t not_before_us, deadline_us; /* monotonic clock */
    int64_t to_us;                      /* simulated */
} pacing_turn;

/* Turns are as far apart as the frames that are wanted; where nobody looks, or nothing moves, they are few and each
 * makes many steps. One that is less late than an interval keeps the pace, so that the rate is held; else the pace
 * begins anew. */
pacing_turn pacing_next(const pacing *p, int64_t now_us);

#endif
