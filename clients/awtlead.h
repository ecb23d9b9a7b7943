/* awtlead.h: how far ahead of its own time a game asks for hair, so that the frame is there when its time is shown,
 * however long and however uneven the way is. What is asked for ahead is predicted by the game, and wrong by as much as
 * it is ahead: so it is as little as the slowest of late needed. Numbers only: no clock is read, nothing is sent.
 *
 *     if (awtlead_ask(&lead, now_us, &time_us)) send a MOTION predicted for time_us, and a QUERY of then;
 *     ... a frame has been decoded: awtlead_came(&lead, now_us, awtframes_newest_us(frames));
 *     ... show the hair of now_us (awtframes_show).
 *
 * All times are the game's, which is the simulated time of its hair. */
#ifndef AWTLEAD_H
#define AWTLEAD_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    AWTLEAD_ASKED = 64,  /* times asked for that are remembered */
    AWTLEAD_NEEDED = 256 /* frames whose need is remembered */
};

/* Embedded; awtlead_begin makes it. */
typedef struct awtlead {
    int64_t step_us, greatest_us, lead_us;
    int64_t next_us, newest_us;                            /* when to ask again; the latest time asked for */
    int64_t asked_us[AWTLEAD_ASKED], at_us[AWTLEAD_ASKED]; /* rings: the time asked for, and when */
    uint32_t asked;
    int64_t needed_us[AWTLEAD_NEEDED]; /* a ring */
    uint32_t needed;
    int64_t came_us, came_at_us; /* the frame that came last: its time, and when it was asked for; INT64_MIN: none */
} awtlead;

/* Nothing is known but how long the way is (awtclock_round_us): asks each `step_us` > 0, a frame's time, and never
 * farther ahead than `greatest_us`. Also after a pause and a loss: what came before says nothing then. */
void awtlead_begin(awtlead *lead, int64_t step_us, int64_t greatest_us, int64_t round_us);

/* Whether to ask at `now_us`, and for which time: later than any before. Steps that a late caller has missed are left
 * out. */
bool awtlead_ask(awtlead *lead, int64_t now_us, int64_t *time_us);

/* A frame of that time can be shown since `now_us`. One that was not asked for says nothing, nor does any where the
 * caller itself has stood still. */
void awtlead_came(awtlead *lead, int64_t now_us, int64_t time_us);

/* How far ahead of now is asked. */
int64_t awtlead_us(const awtlead *lead);

#ifdef __cplusplus
}
#endif

#endif
