/* bytes.h: little-endian values out of bytes and into them, on any host and at any alignment. Nothing here checks
 * bounds. */
#ifndef BASE_BYTES_H
#define BASE_BYTES_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

static inline uint16_t load_u16(const unsigned char *bytes)
{
    return (uint16_t)(bytes[0] | bytes[1] << 8);
}

static inline uint32_t load_u32(const unsigned char *bytes)
{
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static inline uint64_t load_u64(const unsigned char *bytes)
{
    return load_u32(bytes) | (uint64_t)load_u32(bytes + 4) << 32;
}

static inline int64_t load_i64(const unsigned char *bytes)
{
    uint64_t bits = load_u64(bytes);
    int64_t value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline float load_f32(const unsigned char *bytes)
{
    uint32_t bits = load_u32(bytes);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline double load_f64(const unsigned char *bytes)
{
    uint64_t bits = load_u64(bytes);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline void store_u16(unsigned char *bytes, uint16_t value)
{
    bytes[0] = (unsigned char)(value & 0xffu);
    bytes[1] = (unsigned char)(value >> 8);
}

static inline void store_u32(unsigned char *bytes, uint32_t value)
{
    for (int i = 0; i < 4; i++) {
        bytes[i] = (unsigned char)(value >> 8 * i & 0xffu);
    }
}

static inline void store_u64(unsigned char *bytes, uint64_t value)
{
    store_u32(bytes, (uint32_t)(value & 0xffffffffu));
    store_u32(bytes + 4, (uint32_t)(value >> 32));
}

static inline void store_i64(unsigned char *bytes, int64_t value)
{
    store_u64(bytes, (uint64_t)value);
}

static inline void store_f32(unsigned char *bytes, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    store_u32(bytes, bits);
}

static inline void store_f64(unsigned char *bytes, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    store_u64(bytes, bits);
}

/* Copies `size` bytes to `at` and returns where they end. */
static inline unsigned char *store_bytes(unsigned char *at, const void *bytes, size_t size)
{
    memcpy(at, bytes, size);
    return at + size;
}

#endif
