/* capacity.h: awt-bench capacity: what a head of hair costs a core, part by part, and how many heads a core holds. */
#ifndef BENCH_CAPACITY_H
#define BENCH_CAPACITY_H

#include "bench/encode.h"

enum { CAPACITY_STYLES = 4, CAPACITY_SHARES = 3, CAPACITY_STEP_RATE = 100 };

/* Which frames go out, for whom the heads are counted. */
typedef struct capacity_plan {
    uint32_t strands;
    uint32_t frames; /* encoded for each median */
    geom_kind kind;
    geom_level level;
    uint32_t viewers; /* that each frame is written to */
    const char *json; /* file, "-" or NULL */
} capacity_plan;

/* What one style costs, milliseconds of one core. */
typedef struct capacity_row {
    const awt_style *style;
    double step_awake_ms, step_asleep_ms; /* of 10 ms: bowing all the time, and at rest */
    double guides_ms;                     /* sections of the finest wisps, of which strands are made */
    encode_row rows[ENCODE_ROWS];
    guides_row guides[GUIDES_KINDS];
    double write_ms[ENCODE_SUBJECTS]; /* of a whole frame of each kind and level, to one viewer */
    double moving_ms, still_ms;       /* of a second of one head */
    double heads[CAPACITY_SHARES];    /* that fill one core with 0, 10 and 100 % of them moving */
} capacity_row;

extern const double CAPACITY_MOVING[CAPACITY_SHARES];

/* The row of whole frames of a kind and level. */
const encode_row *capacity_frame(const capacity_row *row, geom_kind kind, geom_level level, encode_moving moving);
/* From the parts to moving_ms, still_ms and heads. */
void capacity_sum_up(const capacity_plan *plan, capacity_row *row);

/* Processor time of this thread, ms, for one write of so many bytes to a TCP connection of the loopback that is being
 * read. < 0: no socket. */
double capacity_write_ms(size_t bytes);

/* Prints the table, and writes JSON where the plan wants it. False: why has been said. */
bool capacity_report(const capacity_plan *plan, const capacity_row rows[CAPACITY_STYLES]);

#endif
