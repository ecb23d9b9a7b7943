/* engine_hair.h: the hair of engine_loop, as the daemon has it: made, made again where it was lost, its frames taken
 * and acknowledged. Nothing here waits. Part of what is to be copied. */
#ifndef CLIENTS_ENGINE_HAIR_H
#define CLIENTS_ENGINE_HAIR_H

#include "awtclock.h"
#include "awtframes.h"
#include "awtsession.h"
#include "engine_measure.h"

enum { ENGINE_STREAM_RATE = 60 /* simulated steps, and frames, a second */ };
#define ENGINE_STEP_US (1000000 / ENGINE_STREAM_RATE)
#define ENGINE_OLDEST_US 250000 /* hair is asked for no farther ahead, and frames are no older on arrival */

/* Zeroed, with what stands first filled in. */
typedef struct engine_hair {
    const char *style;
    uint32_t strands;
    engine_measure *measure;
    awtsession *session;
    awtframes *frames;

    int64_t begin_us; /* where the head is when hair has to be made: kept by the loop */
    proto_pose begin_head;
    awtclock clock;
    uint64_t forest, subscribe_request, subscription; /* 0: not there yet */
    uint32_t under_way;                               /* credit that the daemon has, and frames on the way */
    uint32_t sequence, asking;                        /* of motions; questions without an answer */
} engine_hair;

/* Motions can be sent and frames come. */
bool engine_hair_ready(const engine_hair *hair);
/* Sends where the head will be at `at_us`, and asks for the hair of then. False, as below: it cannot go on; why has
 * been said. */
bool engine_hair_ask(engine_hair *hair, int64_t at_us, const proto_pose *head);
/* Takes all that has come; frames wait in `frames` to be decoded. */
bool engine_hair_listen(engine_hair *hair);
/* What has been decoded may be built upon, and makes room on the way for more. */
bool engine_hair_acknowledge(engine_hair *hair);

/* Says why it cannot go on. Always false. */
bool engine_failed(const char *why);

#endif
