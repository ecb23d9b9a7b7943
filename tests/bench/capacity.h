/* capacity.h: awt-bench capacity: what a head of hair costs a core, part by part, and how many heads a core holds. */
#ifndef BENCH_CAPACITY_H
#define BENCH_CAPACITY_H

#include "bench/encode.h"

enum {
    CAPACITY_STYLES = 4,
    CAPACITY_SHARES = 3,
    CAPACITY_STEP_RATE = 100, /* of free-running forests; */
    CAPACITY_REST_RATE = 4,   /* and of their frames at rest (PROTOCOL.md) */
    CAPACITY_MAX_HEADS = 64
};

/* Which frames go out, for whom the heads are counted. */
typedef struct capacity_plan {
    uint32_t strands;
    uint32_t heads;  /* by turns in one thread, 1 .. CAPACITY_MAX_HEADS */
    uint32_t frames; /* encoded for each median */
    geom_kind kind;
    geom_level level;
    uint32_t viewers;  /* that each frame is written to */
    size_t first, end; /* the styles, first .. end - 1 */
    const char *json;  /* file, "-" or NULL */
} capacity_plan;

/* What one of several heads costs, milliseconds of one core: a step of 10 ms, and a frame with all that belongs to it,
 * from the hair between two steps to the bytes. */
typedef struct capacity_head {
    double step_ms, frame_ms;
} capacity_head;

/* Heads alike that go through a clip, and between which times they are measured: a frame or more after its begin. */
typedef struct capacity_pass {
    const awt_groom *groom;
    awt_params params;
    uint32_t heads; /* 1 .. CAPACITY_MAX_HEADS */
    const motion *clip;
    int64_t begin_us, end_us;
    geom_kind kind;
    geom_level level;
} capacity_pass;

/* What one style costs, milliseconds of one core. */
typedef struct capacity_row {
    const awt_style *style;
    capacity_head awake, asleep; /* of the plan's frames: bowing all the time, and at rest */
    double guides_ms;            /* sections of the finest wisps, of which strands are made */
    encode_row rows[ENCODE_ROWS];
    guides_row guides[GUIDES_KINDS];
    double write_ms[ENCODE_SUBJECTS]; /* of a whole frame of each kind and level, to one viewer */
    double moving_ms, still_ms;       /* of a second of one head */
    double heads[CAPACITY_SHARES];    /* that fill one core with 0, 10 and 100 % of them moving */
} capacity_row;

extern const double CAPACITY_MOVING[CAPACITY_SHARES];

/* From the parts to moving_ms, still_ms and heads. */
void capacity_sum_up(const capacity_plan *plan, capacity_row *row);

/* Of several heads in one thread, by turns. AWT_NO_MEMORY, AWT_LIMIT (too many points), or what the forest says. */
awt_status capacity_measure_heads(const capacity_pass *pass, capacity_head *out, awt_error *error);

/* Processor time of this thread, ms, for one write of so many bytes to a TCP connection of the loopback that is being
 * read. < 0: no socket. */
double capacity_write_ms(size_t bytes);

/* Prints the table of the plan's styles, whose rows these are, and writes JSON where it wants it. False: why has been
 * said. */
bool capacity_report(const capacity_plan *plan, const capacity_row *rows);

#endif
