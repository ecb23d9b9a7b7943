/* engine_measure.h: what engine_loop counts, and how it is told. A game does without. */
#ifndef CLIENTS_ENGINE_MEASURE_H
#define CLIENTS_ENGINE_MEASURE_H

#include "awtclock.h"
#include "awtframes.h"

typedef struct engine_measure {
    int64_t tick_us;            /* length of a tick */
    int64_t lead_us;            /* how far ahead the daemon was asked at the end */
    uint64_t ticks, late_ticks; /* late: shown more than a tick after it was due */
    int64_t latest_us;          /* the greatest lateness */
    uint64_t shown, backwards;
    uint64_t stall, longest_stall; /* ticks in a row in which the hair stood while its head moved on */
    int64_t last_shown_us;
    uint64_t received, undecoded, busy, losses;
    double off_sum_m, off_greatest_m, age_sum_us, age_greatest_us, bytes;
} engine_measure;

/* A tick was due at one time of the machine's clock, and came at another. */
void engine_measure_tick(engine_measure *m, int64_t due_us, int64_t came_us);
/* A frame came. */
void engine_measure_frame(engine_measure *m, const struct proto_frame *frame, const awtclock *clock);
/* Hair was shown at simulated time `time_us`, with the head truly there. */
void engine_measure_shown(engine_measure *m, const awtframes_shown *shown, int64_t time_us, const proto_pose *truth);

/* As text on standard output, or as JSON into a file ("-": standard output). False: why has been said. */
bool engine_measure_tell(const engine_measure *m, const awtframes *frames, const awtclock *clock, const char *json);

#endif
