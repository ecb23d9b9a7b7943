/* load.h: what forests cost against what the workers can do, and what is lowered when that is too little: the rates of
 * streams first, then the levels of frames, the least important forests before the others.
 *
 * What is still too much then shows as simulated time that is dropped and as frames flagged STALE (SERVICE.md, point
 * 4), and no new forest is taken. Numbers in, decisions out: no clock, no lock. */
#ifndef LOAD_H
#define LOAD_H

#include <stdbool.h>
#include <stdint.h>

/* Of a forest among others. */
#define IMPORTANCE_LEAST 0.001f
#define IMPORTANCE_GREATEST 1000.0f

enum { LOAD_THIN_GREATEST = 4, LOAD_COARSER_GREATEST = 2 };

/* What a forest did since the last look. Zeroed: nothing yet. */
typedef struct load_meter {
    uint64_t step_us, encode_us;     /* added up by whoever takes its jobs */
    double step_share, encode_share; /* mean: processor microseconds in one of time; encoding as if not lowered */
} load_meter;

/* What is lowered for a forest. */
typedef struct load_measures {
    uint32_t thin;    /* frames come this many times less often: 1, 2, 4 */
    uint32_t coarser; /* levels down: 0, 1, 2 */
} load_measures;

typedef struct load_forest {
    double step_share, encode_share; /* as in load_meter */
    float importance;
    bool streams; /* its frames are made for streams, which can be lowered */
    load_measures measures;
    void *owner; /* the caller's */
} load_forest;

typedef struct load_verdict {
    double cost, capacity; /* processors; the cost with what is lowered */
    bool full;             /* it is too much all the same */
} load_verdict;

/* Takes what was added up in `span_us` of time, under the measures in force, into the means. */
void load_meter_take(load_meter *m, const load_measures *in_force, int64_t span_us);

/* Decides anew for all forests; `measures` are those in force before. What was lowered stays so until there is some
 * room, so that a load at the edge does not go to and fro. Sorts the list by importance. */
load_verdict load_decide(load_forest *forests, uint32_t count, double capacity);

#endif
