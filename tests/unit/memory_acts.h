/* memory_acts.h: all that a client can have the daemon do, act by act, by one who goes on whatever happens to it: who
 * is let go comes again, who has no forest makes one. */
#ifndef MEMORY_ACTS_H
#define MEMORY_ACTS_H

#include "unit/talker.h"

enum { MEMORY_ACTS = 12 };

typedef struct memory_scene {
    wire *on;
    talker *victim;
    int64_t time_us; /* of the victim's forest */
} memory_scene;

void memory_act(memory_scene *s, int act);

/* A small forest. */
proto_message memory_create(uint64_t seed);
/* QUERY of its latest frame. */
proto_message memory_look(const talker *t, uint8_t kind, uint8_t level, uint8_t attributes);
/* MOTION and QUERY. False: no frame came. */
bool memory_step(talker *t, int64_t time_us);

#endif
