/* delta_checksum.h: what tells the whole numbers of one frame from those of another (proto/DELTAS.md). */
#ifndef GEOM_DELTA_CHECKSUM_H
#define GEOM_DELTA_CHECKSUM_H

#include "geom/box.h"

#include <stddef.h>
#include <stdint.h>

/* CRC-32C of numbers as u16, the low byte first, on any host. */
uint32_t delta_checksum_numbers(const uint16_t *numbers, size_t count);
/* Of a frame: of its numbers, `numbers_checksum`, and behind them the box, f32 origin[3], f32 range, u8 bits, and the
 * id of its binding, u64. */
uint32_t delta_checksum(uint32_t numbers_checksum, const draco_box *box, uint64_t binding);

#endif
