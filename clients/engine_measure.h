/* engine_measure.h: what engine_loop counts, and how it is told. A game does without. */
#ifndef CLIENTS_ENGINE_MEASURE_H
#define CLIENTS_ENGINE_MEASURE_H

#include "awtclock.h"
#include "awtframes.h"

/* What made hair stall: the connection was lost; the loop itself was not woken in time; the daemon was late, where the
 * frames that it ended with were old when they left it; else what is between them. */
typedef enum engine_cause {
    ENGINE_BY_LOSS,
    ENGINE_BY_LOOP,
    ENGINE_BY_DAEMON,
    ENGINE_BY_WAY,
    ENGINE_CAUSES
} engine_cause;

typedef struct engine_measure {
    int64_t tick_us;            /* length of a tick */
    int64_t lead_us;            /* how far ahead the daemon was asked at the end */
    uint64_t ticks, late_ticks; /* late: shown more than a tick after it was due */
    int64_t latest_us;          /* the greatest lateness */
    uint64_t shown, backwards;
    int64_t last_time_us, last_shown_us; /* of the loop, and of the hair */
    int64_t stall_us;                    /* how long the hair has gone on by less than half of the time; 0: it goes */
    int64_t longest_stall_us[ENGINE_CAUSES];
    int64_t lost_us, woken_late_us, left_late_us; /* when that last was: simulated time; 0: never */
    uint64_t received, undecoded, busy, losses;
    double off_sum_m, off_greatest_m, age_sum_us, age_greatest_us, bytes;
} engine_measure;

/* A tick was due at one time of the machine's clock, and came at another. */
void engine_measure_tick(engine_measure *m, int64_t due_us, int64_t came_us);
/* The connection was lost. */
void engine_measure_lost(engine_measure *m);
/* A frame came. */
void engine_measure_frame(engine_measure *m, const struct proto_frame *frame, const awtclock *clock);
/* Hair was shown at simulated time `time_us`, with the head truly there. */
void engine_measure_shown(engine_measure *m, const awtframes_shown *shown, int64_t time_us, const proto_pose *truth);

/* As text on standard output, and as JSON into a file unless that is NULL ("-": JSON alone on standard output). False:
 * why has been said. */
bool engine_measure_tell(engine_measure *m, const awtframes *frames, const awtclock *clock, const char *json);

#endif
