/* motion.h: head motion from files (BVH, head-pose CSV) and from built-in clips, as head and body poses in the
 * contract's frame (DATA.md, Registration). Pure: bytes in, poses out.
 *
 * Head and body pose are rigid motions away from one common rest: at rest both are the same translation and no
 * turn. The head pose's origin is the centre of the head. */
#ifndef MOTION_MOTION_H
#define MOTION_MOTION_H

#include "awt.h"

typedef struct motion_sample {
    int64_t time_us; /* from 0, strictly rising */
    awt_pose head, body;
} motion_sample;

typedef struct motion {
    size_t sample_count;
    motion_sample *samples; /* heap; motion_fini */
    /* 0: held after its last sample; else this long a part at its end is played again and again, which begins and ends
     * in the same pose, at rest */
    int64_t repeat_us;
    /* what was taken, for the caller to print */
    char description[240];
} motion;

typedef struct motion_options {
    const char *joint;      /* BVH: the head's joint; NULL: guessed from the names ("head" in it) */
    const char *body_joint; /* BVH: NULL: the head joint's third ancestor */
    double scale;           /* metres per file unit; 0: guess (BVH cm: 0.01; CSV: 1, or what the sizes suggest) */
    awt_up_axis up;         /* AWT_UP_GUESS: Y */
    double time_unit_s;     /* CSV: seconds per timestamp unit; 0: guess from the spacing */
} motion_options;

/* Reads a motion file of either format, recognised by its content. `out` is written on success only: motion_fini.
 * AWT_BAD_FORMAT, AWT_TRUNCATED, AWT_BAD_VALUE, AWT_LIMIT, AWT_NO_MEMORY; a joint that is not there is AWT_BAD_VALUE
 * with the joints there are in the text. */
awt_status motion_read(const void *bytes, size_t size, const motion_options *options, motion *out, awt_error *error);

/* The built-in clips, all 10 s: "lean" (1 s still, 3 s lean forward and back, 6 s rest: PHYSICS.md), "jump", "run",
 * "shake"; and "lean-forever", the lean's bows without a rest and without an end. NULL-named or unknown: false. The
 * samples are 240 a second. False also where memory is short. */
bool motion_builtin(const char *name, motion *out);

/* Pose at a time: Hermite between samples, held before the first, and after the last unless it repeats. */
motion_sample motion_at(const motion *m, int64_t time_us);

void motion_fini(motion *m);

#endif
