/* heads.h: the heads of hair that a load is about: made before it begins, ended after it, and between them the times at
 * which their steps were due, by which viewers know how old is what they see. */
#ifndef LOAD_HEADS_H
#define LOAD_HEADS_H

#include "awtclient.h"
#include "load/plan.h"
#include "load/timeline.h"
#include "motion/motion.h"

#include <stdatomic.h>

enum { HEADS_STEPS = 1024 };

/* Steps by their number; the writer is one driver, the readers are all viewers. */
typedef struct head_steps {
    struct {
        atomic_uint_fast64_t number;
        atomic_int_fast64_t due_ns, sent_ns;
        atomic_uint_fast32_t slice;
    } of[HEADS_STEPS];
} head_steps;

typedef struct load_head {
    uint64_t forest;
    uint8_t drive_token[16], view_token[16];
    atomic_int_fast64_t frame_bytes; /* of its last whole FRAME message */
    atomic_int_fast64_t freed_ns;    /* when it was told to run by the daemon's clock; 0: it was not */
    bool still;                      /* is not moved */
    head_steps steps[LOAD_SIDES];
} load_head;

typedef struct load_heads {
    awtclient *owner;
    load_head *heads; /* [count] heap */
    uint32_t count;
    motion clip;                /* samples NULL: they hold still */
    int64_t step_us;            /* simulated time from one step to the next */
    atomic_int_fast64_t way_ns; /* half of the shortest way to the daemon and back so far */
} load_heads;

/* Makes the plan's heads, and draws a frame of each. False: `error` says why; heads_close in any case. */
bool heads_open(load_heads *h, const load_plan *plan, awtclient_error *error);
/* Keeps the owner's connection alive, and measures the way. False: it has ended. */
bool heads_tend(load_heads *h, awtclient_error *error);
/* Ends the heads. Accepts zeroed ones. */
void heads_close(load_heads *h);

/* What makes a head as the plan wants it, with so many strands. */
void heads_fill_create(const load_heads *h, const load_plan *plan, uint32_t strands, proto_message *create);
/* Head and body at a time of the clip, into the `number`-th MOTION of head `head`. */
void heads_fill_motion(const load_heads *h, uint32_t head, uint64_t number, int64_t time_us, proto_message *out);
int64_t heads_time_us(const load_heads *h, uint64_t number);

/* Before step `number` (from 1) goes out. */
void steps_put(head_steps *s, uint64_t number, uint32_t slice, int64_t due_ns, int64_t sent_ns);
/* False: it is not among the last HEADS_STEPS. */
bool steps_get(const head_steps *s, uint64_t number, uint32_t *slice, int64_t *due_ns, int64_t *sent_ns);

#endif
