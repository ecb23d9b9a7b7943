/* fixture.h: grooms and motion that many tests share. A failure to make one ends the program: no test means anything
 * then. */
#ifndef FIXTURE_H
#define FIXTURE_H

#include "awt.h"
#include "motion/motion.h"

/* A built-in style with so many strands and seed 1, made once and kept until the program ends. */
const awt_groom *fixture_groom(const char *style, uint32_t strands);

/* A forest on it at rest with the style's parameters, its head at `at` and under way with `velocity` already. */
awt_forest *fixture_forest(const awt_groom *groom, const char *style, const double at[3], const double velocity[3]);

/* Poses of the built-in clip at time_us, carried along by at + velocity * time. */
awt_motion fixture_motion(const motion *clip, int64_t time_us, const double at[3], const double velocity[3]);

/* A built-in clip, made once and kept. */
const motion *fixture_clip(const char *name);

/* Moves the forest on to time_us by the clip. */
void fixture_advance(awt_forest *forest, const motion *clip, int64_t time_us, const double at[3],
                     const double velocity[3], awt_step_stats *stats);

/* A bow and a shake of the head, from our own sine: the same bits whatever the machine's. */
awt_motion fixture_bow(int64_t time_us);

#endif
