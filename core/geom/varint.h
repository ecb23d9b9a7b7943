/* varint.h: whole numbers of 7 bits a byte, least first, as Draco's bitstream has them. */
#ifndef GEOM_VARINT_H
#define GEOM_VARINT_H

#include <stdbool.h>
#include <stdint.h>

enum { VARINT_MAX_BYTES = 5 }; /* of 32 bits */

/* Writes `value`; returns the place after it. */
static inline unsigned char *varint_put(unsigned char *at, uint32_t value)
{
    for (; value >= 0x80; value >>= 7) {
        *at++ = (unsigned char)(value | 0x80);
    }
    *at++ = (unsigned char)value;
    return at;
}

/* Reads a number from *at, which moves behind it. False: the text ends, or the number has more than 32 bits. */
static inline bool varint_take(const unsigned char **at, const unsigned char *end, uint32_t *value)
{
    uint64_t taken = 0;
    for (int shift = 0; shift < 7 * VARINT_MAX_BYTES && *at < end; shift += 7) {
        unsigned char byte = *(*at)++;
        taken |= (uint64_t)(byte & 0x7f) << shift;
        if (byte < 0x80) {
            *value = (uint32_t)taken;
            return taken <= UINT32_MAX;
        }
    }
    return false;
}

#endif
