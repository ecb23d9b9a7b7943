/* delta_checksum.c: see delta_checksum.h. */
#include "geom/delta_checksum.h"

#include "base/bytes.h"
#include "base/crc32c.h"

enum { PIECE = 1024 /* numbers */ };

uint32_t delta_checksum_numbers(const uint16_t *numbers, size_t count)
{
    unsigned char piece[2 * PIECE];
    uint32_t crc = 0;
    for (size_t at = 0; at < count; at += PIECE) {
        const size_t here = count - at < PIECE ? count - at : PIECE;
        for (size_t i = 0; i < here; i++) {
            store_u16(piece + 2 * i, numbers[at + i]);
        }
        crc = crc32c_more(crc, piece, 2 * here);
    }
    return crc;
}

uint32_t delta_checksum(uint32_t numbers_checksum, const draco_box *box, uint64_t binding)
{
    unsigned char bytes[25];
    for (int k = 0; k < 3; k++) {
        store_f32(bytes + 4 * k, box->origin[k]);
    }
    store_f32(bytes + 12, box->range);
    bytes[16] = (unsigned char)box->bits;
    store_u64(bytes + 17, binding);
    return crc32c_more(numbers_checksum, bytes, sizeof bytes);
}
