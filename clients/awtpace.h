/* awtpace.h: which simulated time a viewer shows now: as late as its frames come, and as even as its own clock. */
#ifndef AWTPACE_H
#define AWTPACE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { AWTPACE_SAMPLES = 64 };

/* Zeroed: nothing known. Times of one local clock, and simulated ones. */
typedef struct awtpace {
    int64_t
        behind_us[AWTPACE_SAMPLES]; /* local arrival less simulated time of the frame before, until now the newest */
    uint32_t count;
    int64_t newest_us;
    bool running;
    int64_t last_now_us, shown_us;
    double behind; /* in force, slewed */
} awtpace;

/* A frame of that simulated time can be shown since `now_us`. */
void awtpace_arrived(awtpace *pace, int64_t now_us, int64_t time_us);

/* The simulated time to show now. It follows the local clock, behind the frames by what the latest of the last
 * AWTPACE_SAMPLES needed, but by `greatest_us` at most more than the earliest; changes of that are spread, one part in
 * twenty of the time that passes, unless they are larger than a second. Never less than what it gave before. False:
 * nothing has come. */
bool awtpace_time(awtpace *pace, int64_t now_us, int64_t greatest_us, int64_t *time_us);

#ifdef __cplusplus
}
#endif

#endif
