/* awtclock.h: what the daemon's clock says, how long the way is, and what follows from it for streams. Numbers only: no
 * clock is read, nothing is sent. */
#ifndef AWTCLOCK_H
#define AWTCLOCK_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { AWTCLOCK_SAMPLES = 16 };

/* The latest exchanges of PING and PONG. Zeroed: none. */
typedef struct awtclock {
    int64_t offset_us[AWTCLOCK_SAMPLES], round_us[AWTCLOCK_SAMPLES];
    uint32_t count;
} awtclock;

/* Takes PONG's three times and when it arrived (awtlink_received_us; the clock that PING's sent_us was of). False:
 * they cannot be, and were not taken. */
bool awtclock_add(awtclock *clock, int64_t sent_us, int64_t received_us, int64_t answered_us, int64_t arrived_us);

/* The estimate by the exchange that was least delayed: *offset_us is the daemon's clock minus ours, right within
 * *uncertainty_us, whatever way took longer. False: no exchange yet. */
bool awtclock_offset(const awtclock *clock, int64_t *offset_us, int64_t *uncertainty_us);
/* The least time that an exchange took on its way, there and back; 0: none yet. */
int64_t awtclock_round_us(const awtclock *clock);
/* How old a frame's hair is on arrival: FRAME's age_us, and the way, by half of the least round. */
int64_t awtclock_age_us(const awtclock *clock, uint32_t age_us);

/* How many frames a subscription should have under way: those that fit the way there and back at `rate` frames a
 * second, where that takes the longest of late (by 50 ms more than the least at most: beyond, it is a queue), and two
 * (one is being made, one being decoded), but no more than make `target_age_us`. At least 1. */
uint32_t awtclock_credit(const awtclock *clock, double rate, int64_t target_age_us);

#ifdef __cplusplus
}
#endif

#endif
