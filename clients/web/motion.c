/* motion.c: motion files and built-in clips (motion/motion.h) for a host that is not C. Built as WebAssembly, which the
 * viewer reads dropped files by (page/clips.js). */
#include "motion/motion.h"

#include <stdlib.h>

#define EXPORT __attribute__((used, visibility("default"))) /* used: emscripten exports it */

EXPORT motion *clip_read(const void *bytes, size_t size);
EXPORT motion *clip_builtin(const char *name);
EXPORT void clip_destroy(motion *clip);
EXPORT const double *clip_at(const motion *clip, double time_us);
EXPORT double clip_length_us(const motion *clip);
EXPORT double clip_repeat_us(const motion *clip);
EXPORT const char *clip_description(const motion *clip);
EXPORT const char *clip_error(void);

static awt_error error;
static motion_sample sample;

static motion *keep(motion read)
{
    motion *clip = malloc(sizeof *clip);
    if (clip) {
        *clip = read;
    } else {
        motion_fini(&read);
    }
    return clip;
}

/* A BVH or a head-pose CSV; NULL: clip_error says why. clip_destroy frees it. */
motion *clip_read(const void *bytes, size_t size)
{
    motion read;
    return motion_read(bytes, size, NULL, &read, &error) == AWT_OK ? keep(read) : NULL;
}

/* NULL: there is none of that name. */
motion *clip_builtin(const char *name)
{
    motion read;
    return motion_builtin(name, &read) ? keep(read) : NULL;
}

/* Accepts NULL. */
void clip_destroy(motion *clip)
{
    if (clip) {
        motion_fini(clip);
        free(clip);
    }
}

/* The head's position[3] and orientation[4] (x y z w), then the body's; good until the next call. */
const double *clip_at(const motion *clip, double time_us)
{
    sample = motion_at(clip, (int64_t)time_us);
    return sample.head.position;
}

double clip_length_us(const motion *clip)
{
    return (double)clip->samples[clip->sample_count - 1].time_us;
}

/* 0: it is held after its end; else so long a part at its end is played again and again. */
double clip_repeat_us(const motion *clip)
{
    return (double)clip->repeat_us;
}

const char *clip_description(const motion *clip)
{
    return clip->description;
}

const char *clip_error(void)
{
    return error.text;
}
