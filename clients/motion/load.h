/* load.h: a motion by the name that users give: a built-in clip, or a file. */
#ifndef MOTION_LOAD_H
#define MOTION_LOAD_H

#include "motion/motion.h"

/* `out` is written on success only: motion_fini. False: `error` (of `error_size` bytes) says why, for people. */
bool motion_load(const char *name, const motion_options *options, motion *out, char *error, size_t error_size);

#endif
