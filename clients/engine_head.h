/* engine_head.h: the head of engine_loop: where it truly is, and where a game that knows it until now expects it. A
 * game has its own. */
#ifndef CLIENTS_ENGINE_HEAD_H
#define CLIENTS_ENGINE_HEAD_H

#include "proto.h"

/* Where the head truly is: it sways and nods. */
proto_pose engine_true_head(int64_t time_us);

/* Where it will be at `at_us`, for all that is known at `time_us`: on by its velocity. */
proto_pose engine_predicted_head(int64_t time_us, int64_t at_us);

#endif
