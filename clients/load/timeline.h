/* timeline.h: when what is measured. A run is cut into slices that alternate between the daemon and the bare server
 * beside it, so that whatever else the machine does meets both; in each slice a sender's requests are due at times that
 * were fixed before the run (open loop). Pure: no clock.
 *
 * A slice ends with a quiet part in which nothing is due, so that its answers are in before the next one begins. The
 * requests of one side go on in its next slice where they stopped: over a whole run the rate is exactly the one asked
 * for, per second of that side's busy time. */
#ifndef LOAD_TIMELINE_H
#define LOAD_TIMELINE_H

#include <stdbool.h>
#include <stdint.h>

/* What a slice measures. */
typedef enum load_mode {
    LOAD_PLAIN,  /* the daemon */
    LOAD_LADEN,  /* the daemon with what the scenario adds: idle connections, stalled viewers */
    LOAD_FLOOR,  /* the bare server */
    LOAD_SETTLE, /* nothing: the daemon is loaded, that it may come to its usual state */
    LOAD_MODES
} load_mode;

typedef enum load_side { LOAD_DAEMON, LOAD_BARE, LOAD_SIDES } load_side;

enum { TIMELINE_MAX_SLICES = 400 };

typedef struct timeline {
    int64_t slice_ns, busy_ns; /* length of a slice, and of its part in which requests are due */
    uint32_t slices;
    uint8_t modes[TIMELINE_MAX_SLICES];                /* load_mode */
    uint32_t side_slices[LOAD_SIDES];                  /* how many each side has */
    uint16_t of_side[LOAD_SIDES][TIMELINE_MAX_SLICES]; /* which they are, in order */
} timeline;

load_side timeline_side(load_mode mode);

/* `daemon_ns` of measuring the daemon, and with `floor` as long the bare server. `laden`: LOAD_LADEN instead of
 * LOAD_PLAIN; `pairs` > 0: so many pairs of both instead, each in the order opposite to the one before. Slices last
 * about a second, more where there would be too many, less where the time is short. Before all come as many as take up
 * `settle_ns` (a quarter of the most there are). */
void timeline_make(timeline *t, int64_t settle_ns, int64_t daemon_ns, bool floor, bool laden, uint32_t pairs);

/* The slice that time `ns` (from the run's begin) falls into; `slices` behind the last. */
uint32_t timeline_slice_at(const timeline *t, int64_t ns);

/* When request `tick` (from 0) of a sender is due, from the run's begin, and in which slice: one every `period_ns` of
 * its side's busy time, the first after `phase_ns`. False: not within the run. */
bool timeline_due(const timeline *t, load_side side, int64_t phase_ns, int64_t period_ns, uint64_t tick,
                  int64_t *due_ns, uint32_t *slice);

/* Seconds of busy time of all slices of a mode. */
double timeline_busy_s(const timeline *t, load_mode mode);

#endif
