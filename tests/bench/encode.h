/* encode.h: awt-bench encode: what frames of simulated hair cost to write, to send and to read, beside stock libdraco.
 */
#ifndef BENCH_ENCODE_H
#define BENCH_ENCODE_H

#include "bench/bench.h"
#include "bench/encode_guides.h"
#include "geom/encode.h"

enum { ENCODE_MAX_FRAMES = 1000, ENCODE_FRAME_RATE = 60 };

/* Which hair, and how it moves. */
typedef struct encode_plan {
    const awt_style *style;
    const char *groom_file; /* NULL: the style's own hair */
    const char *motion_name;
    motion clip; /* heap */
    uint32_t strands, points;
    uint32_t frames;  /* to be measured, of one every ENCODE_FRAME_RATE-th second times `stride` */
    int64_t begin_us; /* the first of them */
    uint32_t stride;
    uint32_t hands;   /* threads that encode a frame together, measured beside one */
    const char *json; /* file, "-" or NULL */
} encode_plan;

/* Which patches of a frame are encoded; the others are kept from the frame before. */
typedef enum encode_moving { ENCODE_ALL, ENCODE_QUARTER, ENCODE_NONE, ENCODE_MOVINGS } encode_moving;

/* Medians over the frames that were measured, of one core. Times are of whole frames, points to GLB and back. */
typedef struct encode_row {
    geom_kind kind;
    geom_level level;
    encode_moving moving;
    uint32_t base_age; /* of a delta: frames from its base to it; 0: a whole frame */
    int quantisation_bits;
    uint32_t patches;
    size_t points;                                 /* strand points of a frame */
    double encode_ms, stock_encode_ms;             /* the stock encoder knows no patches that are kept */
    double shared_encode_ms;                       /* by the plan's hands; 0: not measured */
    double evaluate_ms;                            /* that made the level's strands of the sections */
    double vertices_ms;                            /* the part of both that makes ribbons of strands */
    double bytes_per_point, stock_bytes_per_point; /* of a delta's stock: the same numbers, coded by libdraco */
    double entropy_bits_per_point;                 /* of the differences, without connectivity, tables and JSON */
    double max_error_mm;                           /* between a point that went in and the one that comes out */
    double decode_ms, stock_decode_ms;             /* our reader and stock libdraco on our frame's Draco data */
    size_t scratch_bytes;                          /* that our encoder holds */
} encode_row;

enum {
    ENCODE_BASES = 2, /* of deltas: the frame before, and the third one before */
    ENCODE_LEVELS = 3,
    ENCODE_SUBJECTS = 2 * ENCODE_LEVELS, /* ribbon and strands of each level, the full one first */
    ENCODE_WHOLE_ROWS = ENCODE_SUBJECTS * ENCODE_MOVINGS,
    ENCODE_DELTA_ROWS = ENCODE_BASES * ENCODE_MOVINGS,
    ENCODE_ROWS = ENCODE_WHOLE_ROWS + ENCODE_DELTA_ROWS
};

/* Runs the plan. False: why has been said. `binding_bytes`: of what a receiver of guides has once. */
bool encode_measure(const encode_plan *plan, encode_row rows[ENCODE_ROWS], guides_row of_guides[GUIDES_KINDS],
                    size_t *binding_bytes);

#endif
