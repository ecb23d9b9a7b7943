/* quantise.h: positions to whole numbers, and those to the small numbers that the bitstream holds: each coordinate's
 * difference to the one before it, wrapped round and with its sign folded in. One pass, and the way back.
 *
 * Draco's difference prediction with its wrap transform, whose bounds we set to 0 and 2^bits - 1 always: wrapping is
 * then arithmetic modulo 2^bits, and no pass has to look for bounds. */
#ifndef GEOM_QUANTISE_H
#define GEOM_QUANTISE_H

#include "geom/box.h"

#include <stdbool.h>
#include <stddef.h>

enum {
    QUANTISE_MAX_BITS = 15,
    QUANTISE_BLOCK = 48 /* coordinates; `symbols` is filled in whole blocks */
};

/* Room for the symbols of `positions`. */
static inline size_t quantise_room(size_t positions)
{
    return (3 * positions + QUANTISE_BLOCK - 1) / QUANTISE_BLOCK * QUANTISE_BLOCK;
}

/* Positions outside are set onto them. */
typedef struct quantise_bounds {
    float least[3], greatest[3];
} quantise_bounds;

/* How many positions lie outside of them. */
uint32_t quantise_count_outside(const quantise_bounds *bounds, const float *positions, size_t count);

/* What was met on the way. */
typedef struct quantise_findings {
    uint16_t least[3], greatest[3]; /* whole numbers along each axis */
    bool finite;                    /* false: a coordinate is not, and the symbols mean nothing */
    bool outside;                   /* a coordinate lay outside the bounds and was set onto them */
} quantise_findings;

/* Positions [count][3], count >= 1, become `symbols` [quantise_room(count)]. `bounds` lie within the box. */
quantise_findings quantise_differences(const draco_box *box, const quantise_bounds *bounds, const float *positions,
                                       size_t count, uint16_t *symbols);

/* The first half alone: positions [count][3] become `numbers` [count][3]. */
quantise_findings quantise_numbers(const draco_box *box, const quantise_bounds *bounds, const float *positions,
                                   size_t count, uint16_t *numbers);
/* The second half: `numbers` [count][3], each below 2^bits, become `symbols` [quantise_room(count)]. */
quantise_findings quantise_number_differences(int bits, const uint16_t *numbers, size_t count, uint16_t *symbols);

/* The way back: `numbers` [count][3] from `symbols` [count][3], each below 2^bits. May be done in place. */
void quantise_sum_up(int bits, const uint16_t *symbols, size_t count, uint16_t *numbers);
/* The same farther, to `positions` [count][3]; `symbols` become the numbers. False: a symbol is none of numbers of the
 * box's bits. */
bool quantise_positions(const draco_box *box, uint16_t *symbols, size_t count, float *positions);

#endif
