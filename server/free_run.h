/* free_run.h: what a worker does with a forest that runs by the daemon's clock: steps of just 10 ms to the time of the
 * next frame, or as many as are due where nobody looks.
 *
 * Where the machine has fallen behind, simulated time is dropped: the forest passes over it without a step (and the
 * recording says so), and dt stays what it is. */
#ifndef FREE_RUN_H
#define FREE_RUN_H

#include "drawing.h"
#include "forest_input.h"
#include "sim_clock.h"

/* A forest, and who writes down what is done to it. */
typedef struct free_forest {
    awt_forest *forest;
    awt_recorder *recorder; /* of that forest; NULL: nobody */
} free_forest;

typedef struct free_task {
    sim_clock clock;           /* CLOCK_FREE */
    int64_t to_us;             /* simulated time that is to be shown */
    int64_t (*clock_us)(void); /* monotonic */
} free_task;

typedef struct free_result {
    int64_t shown_us;     /* as to_us, but for what was dropped */
    int64_t dropped_us;   /* simulated */
    awt_step_stats stats; /* of all steps */
} free_result;

/* Motions and parameters in order, then the steps. An input that is refused changes nothing; its error says why.
 * Motions for times that have passed are late: the last of them is taken for the end of the next step, with the jumps
 * and obstacles' poses of the others. `draws`: what the result is drawn with, to be told what is shown between two
 * steps; NULL: nothing is. */
awt_status free_run(const free_forest *d, const free_task *task, forest_input *inputs, drawing *draws, free_result *out,
                    awt_error *error);

#endif
