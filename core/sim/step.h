/* step.h: one sub-step of a forest. */
#ifndef SIM_STEP_H
#define SIM_STEP_H

#include "sim/state.h"

/* Brings the forest from its time to `end_us`, which is `dt_s` later; `sample_us` is the same instant as a real
 * number. Adds what happened to *stats. */
void step_run(awt_forest *f, int64_t end_us, double sample_us, float dt_s, awt_step_stats *stats);

/* Brings the forest to `end_us`, `dt_s` or more later, without simulating: the hair is carried rigidly with the head,
 * which goes on with the velocity of the last `dt_s`. */
void step_skip(awt_forest *f, int64_t end_us, float dt_s);

/* The world axes of the head at its present pose. */
void step_orient(awt_forest *f);

#endif
