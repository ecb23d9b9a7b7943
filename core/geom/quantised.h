/* quantised.h: a frame as whole numbers (geom_quantised's insides, for core/geom alone). */
#ifndef GEOM_QUANTISED_H
#define GEOM_QUANTISED_H

#include "geom/box.h"
#include "geom/encode.h"

struct geom_quantised {
    const geom_layout *layout; /* of the frame that is here; NULL: none */
    size_t count, held;
    uint32_t patch_count;
    uint16_t *numbers;   /* [strands][points_per_strand][3] */
    uint32_t *checksums; /* [patches]: CRC-32C of each patch's numbers */
    uint32_t checksum;   /* of the frame */
};

/* CRC-32C of numbers as u16, the low byte first, on any host. */
uint32_t quantised_numbers_checksum(const uint16_t *numbers, size_t count);
/* Of a frame: of its numbers, `numbers_checksum`, and the box behind them: f32 origin[3], f32 range, u8 bits. */
uint32_t quantised_checksum(uint32_t numbers_checksum, const draco_box *box);

/* Whether a frame of that layout is here. */
bool quantised_fits(const geom_quantised *quantised, const geom_layout *layout);

/* The numbers of one patch. */
const uint16_t *quantised_patch(const geom_quantised *quantised, const geom_layout *layout, uint32_t index);

#endif
