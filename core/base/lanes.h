/* lanes.h: LANES floats at once, for the loops where the time goes.
 *
 * GNU vectors, which gcc and clang have for every machine: as wide as the machine's own registers, so that nothing is
 * split in two. Lanes never meet: each computes what the scalar code would, in the same order, so that results do not
 * depend on how many there are. Comparisons give masks, all bits or none. */
#ifndef BASE_LANES_H
#define BASE_LANES_H

#include "base/vec.h"

#include <stdint.h>
#include <string.h>

#if defined(__AVX__)
#include <immintrin.h>
enum { LANES = 8 };
#else
#if defined(__SSE__)
#include <xmmintrin.h>
#endif
enum { LANES = 4 };
#endif

typedef float lanes __attribute__((vector_size(4 * LANES)));
typedef int32_t lanes_mask __attribute__((vector_size(4 * LANES)));

static inline lanes lanes_of(float s)
{
    return (lanes){0} + s;
}

/* From and to any address. */
static inline lanes lanes_load(const float *from)
{
    lanes a;
    memcpy(&a, from, sizeof a);
    return a;
}

static inline void lanes_store(float *to, lanes a)
{
    memcpy(to, &a, sizeof a);
}

static inline lanes lanes_select(lanes_mask mask, lanes yes, lanes no)
{
    return (lanes)((mask & (lanes_mask)yes) | (~mask & (lanes_mask)no));
}

static inline lanes lanes_least(lanes a, lanes b)
{
    return lanes_select(a < b, a, b);
}

static inline lanes lanes_most(lanes a, lanes b)
{
    return lanes_select(a > b, a, b);
}

static inline lanes lanes_sqrt(lanes a)
{
    for (int k = 0; k < LANES; k++) {
        a[k] = sqrtf(a[k]);
    }
    return a;
}

/* Bit k: lane k of a mask. */
static inline uint32_t lanes_bits(lanes_mask mask)
{
#if defined(__AVX__)
    return (uint32_t)_mm256_movemask_ps((__m256)mask);
#elif defined(__SSE__)
    return (uint32_t)_mm_movemask_ps((__m128)mask);
#else
    uint32_t bits = 0;
    for (int k = 0; k < LANES; k++) {
        bits |= (uint32_t)(mask[k] & 1) << k;
    }
    return bits;
#endif
}

typedef uint16_t lanes_numbers __attribute__((vector_size(8)));

/* Appends `first` + k for every bit k of `bits` that is set to `list`, which has room for LANES more than it will hold;
 * returns how many. No branch: which lanes are hit is anybody's guess. */
static inline uint32_t lanes_list(uint32_t bits, uint32_t first, uint16_t *list)
{
    static const uint16_t numbers[16][4] = {{0}, {0},    {1},    {0, 1},    {2},    {0, 2},    {1, 2},    {0, 1, 2},
                                            {3}, {0, 3}, {1, 3}, {0, 1, 3}, {2, 3}, {0, 2, 3}, {1, 2, 3}, {0, 1, 2, 3}};
    static const uint8_t counts[16] = {0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4};
    uint32_t count = 0;
    for (uint32_t k = 0; k < LANES; k += 4, bits >>= 4) {
        lanes_numbers four;
        memcpy(&four, numbers[bits & 15], sizeof four);
        four += (uint16_t)(first + k);
        memcpy(list + count, &four, sizeof four);
        count += counts[bits & 15];
    }
    return count;
}

/* LANES records of four floats each, side by side. */
static inline void lanes_turn4(const float *const records[LANES], lanes out[4])
{
#if defined(__AVX__)
    typedef float four __attribute__((vector_size(16)));
    lanes r[4];
    for (int k = 0; k < 4; k++) {
        four low, high;
        memcpy(&low, records[k], sizeof low);
        memcpy(&high, records[k + 4], sizeof high);
        r[k] = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
    }
    lanes a = __builtin_shufflevector(r[0], r[1], 0, 8, 1, 9, 4, 12, 5, 13);
    lanes b = __builtin_shufflevector(r[2], r[3], 0, 8, 1, 9, 4, 12, 5, 13);
    out[0] = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
    out[1] = __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
    a = __builtin_shufflevector(r[0], r[1], 2, 10, 3, 11, 6, 14, 7, 15);
    b = __builtin_shufflevector(r[2], r[3], 2, 10, 3, 11, 6, 14, 7, 15);
    out[2] = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
    out[3] = __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
#else
    lanes a = lanes_load(records[0]), b = lanes_load(records[1]), c = lanes_load(records[2]),
          d = lanes_load(records[3]);
    lanes ab = __builtin_shufflevector(a, b, 0, 4, 1, 5), cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
    out[0] = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
    out[1] = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
    ab = __builtin_shufflevector(a, b, 2, 6, 3, 7), cd = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    out[2] = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
    out[3] = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
#endif
}

/* The way back: float k of each record is what in[k] holds of it. */
static inline void lanes_spread4(const lanes in[4], float *const records[LANES])
{
#if defined(__AVX__)
    typedef float four __attribute__((vector_size(16)));
    lanes a = __builtin_shufflevector(in[0], in[1], 0, 8, 1, 9, 4, 12, 5, 13);
    lanes b = __builtin_shufflevector(in[2], in[3], 0, 8, 1, 9, 4, 12, 5, 13);
    lanes c = __builtin_shufflevector(in[0], in[1], 2, 10, 3, 11, 6, 14, 7, 15);
    lanes d = __builtin_shufflevector(in[2], in[3], 2, 10, 3, 11, 6, 14, 7, 15);
    const lanes r[4] = {__builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13),
                        __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15),
                        __builtin_shufflevector(c, d, 0, 1, 8, 9, 4, 5, 12, 13),
                        __builtin_shufflevector(c, d, 2, 3, 10, 11, 6, 7, 14, 15)};
    for (int k = 0; k < 4; k++) {
        four low = __builtin_shufflevector(r[k], r[k], 0, 1, 2, 3),
             high = __builtin_shufflevector(r[k], r[k], 4, 5, 6, 7);
        memcpy(records[k], &low, sizeof low);
        memcpy(records[k + 4], &high, sizeof high);
    }
#else
    const float *rows[LANES];
    lanes turned[4];
    for (int k = 0; k < LANES; k++) {
        rows[k] = (const float *)&in[k];
    }
    lanes_turn4(rows, turned);
    for (int k = 0; k < LANES; k++) {
        lanes_store(records[k], turned[k]);
    }
#endif
}

/* LANES records of eight floats each, side by side: out[i] holds float i of all. */
static inline void lanes_turn8(const float *const records[LANES], lanes out[8])
{
    const float *upper[LANES];
    for (int k = 0; k < LANES; k++) {
        upper[k] = records[k] + 4;
    }
    lanes_turn4(records, out);
    lanes_turn4(upper, out + 4);
}

/* LANES vectors. */
typedef struct lanes3 {
    lanes x, y, z;
} lanes3;

static inline lanes3 lanes3_sub(lanes3 a, lanes3 b)
{
    return (lanes3){a.x - b.x, a.y - b.y, a.z - b.z};
}

/* a + b s */
static inline lanes3 lanes3_mad(lanes3 a, lanes3 b, lanes s)
{
    return (lanes3){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}

static inline lanes3 lanes3_cross(lanes3 a, lanes3 b)
{
    return (lanes3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline lanes3 lanes3_select(lanes_mask mask, lanes3 yes, lanes3 no)
{
    return (lanes3){lanes_select(mask, yes.x, no.x), lanes_select(mask, yes.y, no.y), lanes_select(mask, yes.z, no.z)};
}

static inline lanes lanes3_dot(lanes3 a, lanes3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* vec3_unit and vec3_orthogonal, lane by lane. */
static inline lanes3 lanes3_unit(lanes3 a, lanes3 otherwise)
{
    lanes length = lanes_sqrt(lanes3_dot(a, a)), s = lanes_of(1.0f) / length;
    return lanes3_select(length > 1e-12f, (lanes3){a.x * s, a.y * s, a.z * s}, otherwise);
}

static inline lanes3 lanes3_orthogonal(lanes3 a)
{
    const lanes zero = lanes_of(0), one = lanes_of(1);
    lanes_mask steep = (a.x < 0.6f) & (a.x > -0.6f);
    lanes3 other = {lanes_select(steep, one, zero), lanes_select(steep, zero, one), zero};
    return lanes3_unit(lanes3_cross(a, other), (lanes3){zero, zero, one});
}

/* LANES points x y z, one after the other. */
static inline lanes3 lanes3_load(const float *from)
{
    const lanes p = lanes_load(from), q = lanes_load(from + LANES), r = lanes_load(from + 2 * (size_t)LANES);
#if defined(__AVX__)
    lanes a = __builtin_shufflevector(p, q, 0, 1, 2, 3, 12, 13, 14, 15);  /* x0 y0 z0 x1 x4 y4 z4 x5 */
    lanes b = __builtin_shufflevector(p, r, 4, 5, 6, 7, 8, 9, 10, 11);    /* y1 z1 x2 y2 y5 z5 x6 y6 */
    lanes c = __builtin_shufflevector(q, r, 0, 1, 2, 3, 12, 13, 14, 15);  /* z2 x3 y3 z3 z6 x7 y7 z7 */
    lanes low = __builtin_shufflevector(b, c, 2, 3, 9, 10, 6, 7, 13, 14); /* x2 y2 x3 y3 .. */
    lanes high = __builtin_shufflevector(a, b, 1, 2, 8, 9, 5, 6, 12, 13); /* y0 z0 y1 z1 .. */
    return (lanes3){__builtin_shufflevector(a, low, 0, 3, 8, 10, 4, 7, 12, 14),
                    __builtin_shufflevector(high, low, 0, 2, 9, 11, 4, 6, 13, 15),
                    __builtin_shufflevector(high, c, 1, 3, 8, 11, 5, 7, 12, 15)};
#else
    lanes low = __builtin_shufflevector(q, r, 2, 3, 5, 6);  /* x2 y2 x3 y3 */
    lanes high = __builtin_shufflevector(p, q, 1, 2, 4, 5); /* y0 z0 y1 z1 */
    return (lanes3){__builtin_shufflevector(p, low, 0, 3, 4, 6), __builtin_shufflevector(high, low, 0, 2, 5, 7),
                    __builtin_shufflevector(high, r, 1, 3, 4, 7)};
#endif
}

/* The way back. */
static inline void lanes3_store(float *to, lanes3 a)
{
#if defined(__AVX__)
    lanes xy = __builtin_shufflevector(a.x, a.y, 0, 8, 2, 10, 4, 12, 6, 14); /* x0 y0 x2 y2 */
    lanes yz = __builtin_shufflevector(a.y, a.z, 1, 9, 3, 11, 5, 13, 7, 15); /* y1 z1 y3 z3 */
    lanes zx = __builtin_shufflevector(a.z, a.x, 0, 9, 2, 11, 4, 13, 6, 15); /* z0 x1 z2 x3 */
    lanes p = __builtin_shufflevector(xy, zx, 0, 1, 8, 9, 4, 5, 12, 13);     /* x0 y0 z0 x1 */
    lanes q = __builtin_shufflevector(yz, xy, 0, 1, 10, 11, 4, 5, 14, 15);   /* y1 z1 x2 y2 */
    lanes r = __builtin_shufflevector(zx, yz, 2, 3, 10, 11, 6, 7, 14, 15);   /* z2 x3 y3 z3 */
    lanes_store(to, __builtin_shufflevector(p, q, 0, 1, 2, 3, 8, 9, 10, 11));
    lanes_store(to + 8, __builtin_shufflevector(r, p, 0, 1, 2, 3, 12, 13, 14, 15));
    lanes_store(to + 16, __builtin_shufflevector(q, r, 4, 5, 6, 7, 12, 13, 14, 15));
#else
    lanes xy = __builtin_shufflevector(a.x, a.y, 0, 4, 2, 6);
    lanes yz = __builtin_shufflevector(a.y, a.z, 1, 5, 3, 7);
    lanes zx = __builtin_shufflevector(a.z, a.x, 0, 5, 2, 7);
    lanes_store(to, __builtin_shufflevector(xy, zx, 0, 1, 4, 5));
    lanes_store(to + 4, __builtin_shufflevector(yz, xy, 0, 1, 6, 7));
    lanes_store(to + 8, __builtin_shufflevector(zx, yz, 2, 3, 6, 7));
#endif
}

#endif
