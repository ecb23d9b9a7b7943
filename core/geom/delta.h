/* delta.h: what changed from one frame's whole numbers to another's, as small numbers, and back.
 *
 * The numbers are of strands of equally many points, `components` each, all below 2^bits. A number's change d is
 * predicted from those of the three strands before it (where strands begin, there are none: 0) and from the point
 * before it on its own strand. With n = 2 d' + d'' + d''', the changes of the same number one, two and three strands
 * before, and e = 4 d - n of the same component at the point before (0 at the root), the prediction is
 *
 *     floor((4 n + carry e + 8) / 16),   carry 0 .. 4, chosen for each patch
 *
 * carry 0 follows the neighbours, carry 4 adds what this strand did otherwise at its last point. Of simulated hair at
 * 60 Hz, 12 bits, this leaves 0.53 bytes a point of entropy where differences along the strand leave 0.74 and second
 * differences 0.79 (long style, lean); over three frames 0.68, 1.15 and 1.00. Prediction errors are taken modulo 2^bits
 * to the nearest of 0, and have their sign folded into the lowest bit: 0, -1, 1, -2 are symbols 0, 1, 2, 3.
 *
 * Numbers of guides are errors of a prediction already (guides.h): in motion mostly rounding, which differs from frame
 * to frame, so that to take the base's away makes them larger; at rest they are the base's. They are plain: what is
 * left of a patch is its changes as they are, or its numbers as they are, whichever is smaller. */
#ifndef GEOM_DELTA_H
#define GEOM_DELTA_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    DELTA_MAX_BITS = 15,
    DELTA_MAX_COMPONENTS = 8,
    DELTA_GREATEST_CARRY = 4,
    DELTA_PLAIN = 5, /* in a carry's place: nothing is predicted */
    DELTA_BLOCK = 48 /* arrays of changes and symbols are filled in whole blocks */
};

typedef struct delta_shape {
    uint32_t strands, points, components;
    int bits;
} delta_shape;

/* Numbers of one strand, and of all. */
static inline size_t delta_row(const delta_shape *shape)
{
    return (size_t)shape->points * shape->components;
}

static inline size_t delta_count(const delta_shape *shape)
{
    return delta_row(shape) * shape->strands;
}

/* Room for symbols, and for changes: zeros stand before these, for what is before the first strand. */
static inline size_t delta_room(const delta_shape *shape)
{
    return (delta_count(shape) + DELTA_BLOCK - 1) / DELTA_BLOCK * DELTA_BLOCK;
}

static inline size_t delta_before(const delta_shape *shape)
{
    return 3 * delta_row(shape) + shape->components;
}

/* From `base` to `now` [strands][points][components]: `symbols` [delta_room]; `changes` [delta_before + delta_room] is
 * working memory. Returns the carry that was chosen; *all becomes the bits of all symbols, or-ed. */
uint8_t delta_make(const delta_shape *shape, const uint16_t *base, const uint16_t *now, int16_t *changes,
                   uint16_t *symbols, uint16_t *all);

/* The same of plain numbers. True: the symbols are of the numbers themselves, not of their changes; so they are where
 * `base` is NULL. */
bool delta_make_plain(const delta_shape *shape, const uint16_t *base, const uint16_t *now, uint16_t *symbols,
                      uint16_t *all);

/* The way back: fills `now`. Whatever the symbols and the carry (0 .. DELTA_PLAIN), each number is below 2^bits where
 * those of `base` are; plain ones alone may have none: NULL. `changes` [delta_before + delta_room] is working memory,
 * which plain ones do not need. */
void delta_apply(const delta_shape *shape, uint8_t carry, const uint16_t *symbols, const uint16_t *base,
                 int16_t *changes, uint16_t *now);

#endif
