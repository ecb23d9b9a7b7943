/* delta.c: see delta.h. Loops over a block have a fixed length and no branch, as those of quantise.c. */
#include "geom/delta.h"

#include <string.h>

enum { BLOCK = DELTA_BLOCK, SAMPLE = 8 /* one strand in so many chooses the carry */, SMALL = 512 };

/* Strands are rows of the changes: `row` numbers farther back is the strand before, `step` the point before. */
typedef struct places {
    ptrdiff_t row, step;
} places;

/* n of delta.h: four times what the strands before say. */
static inline int32_t neighbours_of(const int16_t *d, ptrdiff_t row)
{
    return 2 * d[-row] + d[-2 * row] + d[-3 * row];
}

static inline int32_t predict(const int16_t *d, places at, int32_t carry)
{
    int32_t before = 4 * d[-at.step] - neighbours_of(d - at.step, at.row);
    return (4 * neighbours_of(d, at.row) + carry * before + 8) >> 4;
}

static inline uint16_t symbol_of(int32_t error, int spare_bits)
{
    int16_t wrapped = (int16_t)((int16_t)((uint32_t)error << spare_bits) >> spare_bits);
    return (uint16_t)((uint16_t)((uint16_t)wrapped << 1) ^ (uint16_t)(wrapped >> 15));
}

/* Returns the bits of all changes, or-ed; of a negative one the bits of its complement. */
static uint16_t fill_changes(const uint16_t *base, const uint16_t *now, size_t count, int16_t *d)
{
    uint16_t block[BLOCK] = {0}, all = 0;
    size_t i = 0;
    for (; i + BLOCK <= count; i += BLOCK) {
        for (size_t k = 0; k < BLOCK; k++) {
            const int16_t change = (int16_t)(now[i + k] - base[i + k]);
            d[i + k] = change;
            block[k] |= (uint16_t)(change ^ change >> 15);
        }
    }
    for (size_t k = 0; i < count; i++, k++) {
        d[i] = (int16_t)(now[i] - base[i]);
        block[k] |= (uint16_t)(d[i] ^ d[i] >> 15);
    }
    for (size_t k = 0; k < BLOCK; k++) {
        all |= block[k];
    }
    return all;
}

/* What is left of some strands after a carry of 2 and after one of 4. */
static uint8_t choose_carry(const delta_shape *shape, const int16_t *d)
{
    const places at = {(ptrdiff_t)delta_row(shape), (ptrdiff_t)shape->components};
    const size_t row = delta_row(shape);
    int64_t half = 0, full = 0;
    for (size_t s = shape->strands > SAMPLE ? SAMPLE / 2 : 0; s < shape->strands; s += SAMPLE) {
        const int16_t *here = d + s * row;
        for (size_t j = shape->components; j < row; j++) {
            int32_t a = here[j] - predict(here + j, at, 2), b = here[j] - predict(here + j, at, 4);
            half += a < 0 ? -a : a;
            full += b < 0 ? -b : b;
        }
    }
    return full < half ? 4 : 2;
}

static uint16_t or_all(const uint16_t *symbols, size_t count)
{
    uint16_t block[BLOCK] = {0}, all = 0;
    size_t i = 0;
    for (; i + BLOCK <= count; i += BLOCK) {
        for (size_t k = 0; k < BLOCK; k++) {
            block[k] |= symbols[i + k];
        }
    }
    for (size_t k = 0; i < count; i++, k++) {
        block[k] |= symbols[i];
    }
    for (size_t k = 0; k < BLOCK; k++) {
        all |= block[k];
    }
    return all;
}

static void fill_block(const int16_t *restrict d, places at, int32_t carry, int spare_bits, uint16_t *restrict symbols)
{
    for (int k = 0; k < BLOCK; k++) {
        symbols[k] = symbol_of(d[k] - predict(d + k, at, carry), spare_bits);
    }
}

/* The same where all changes are below SMALL either way: then 16 bits hold everything, and twice as many are done at
 * once. */
static void fill_block_small(const int16_t *restrict d, places at, int16_t carry, int spare_bits,
                             uint16_t *restrict symbols)
{
    const int16_t *restrict b = d - at.step;
    for (int k = 0; k < BLOCK; k++) {
        int16_t n = (int16_t)(2 * d[k - at.row] + d[k - 2 * at.row] + d[k - 3 * at.row]);
        int16_t m = (int16_t)(4 * b[k] - 2 * b[k - at.row] - b[k - 2 * at.row] - b[k - 3 * at.row]);
        int16_t sixteenfold = (int16_t)(4 * n + carry * m + 8);
        int16_t error = (int16_t)(d[k] - (sixteenfold >> 4));
        int16_t wrapped = (int16_t)((int16_t)((uint16_t)error << spare_bits) >> spare_bits);
        symbols[k] = (uint16_t)((uint16_t)((uint16_t)wrapped << 1) ^ (uint16_t)(wrapped >> 15));
    }
}

uint8_t delta_make(const delta_shape *shape, const uint16_t *base, const uint16_t *now, int16_t *changes,
                   uint16_t *symbols, uint16_t *all)
{
    const places at = {(ptrdiff_t)delta_row(shape), (ptrdiff_t)shape->components};
    const size_t count = delta_count(shape), row = delta_row(shape);
    const int spare_bits = 16 - shape->bits;
    int16_t *d = changes + delta_before(shape);
    memset(changes, 0, delta_before(shape) * sizeof *changes);
    const bool small = fill_changes(base, now, count, d) < SMALL;
    memset(d + count, 0, (delta_room(shape) - count) * sizeof *d);
    const uint8_t carry = choose_carry(shape, d);
    for (size_t i = 0; i < count; i += BLOCK) {
        if (small) {
            fill_block_small(d + i, at, carry, spare_bits, symbols + i);
        } else {
            fill_block(d + i, at, carry, spare_bits, symbols + i);
        }
    }
    for (size_t root = 0; root < count; root += row) { /* which have no point before them */
        for (size_t k = root; k < root + shape->components; k++) {
            symbols[k] = symbol_of(d[k] - ((4 * neighbours_of(d + k, at.row) + 8) >> 4), spare_bits);
        }
    }
    *all = or_all(symbols, count);
    return carry;
}

/* ---- plain numbers */

static const uint16_t NOTHING[BLOCK];

static void fill_plain_block(const uint16_t *restrict base, const uint16_t *restrict now, int spare_bits,
                             uint16_t *restrict symbols)
{
    for (int k = 0; k < BLOCK; k++) {
        int16_t change = (int16_t)(now[k] - base[k]);
        int16_t wrapped = (int16_t)((int16_t)((uint16_t)change << spare_bits) >> spare_bits);
        symbols[k] = (uint16_t)((uint16_t)((uint16_t)wrapped << 1) ^ (uint16_t)(wrapped >> 15));
    }
}

/* The block's symbols from number i on; 0 where there are no numbers left. */
static void make_plain_block(const uint16_t *base, const uint16_t *now, size_t count, size_t i, int spare_bits,
                             uint16_t *symbols)
{
    if (i + BLOCK <= count) {
        fill_plain_block(base ? base + i : NOTHING, now + i, spare_bits, symbols);
        return;
    }
    uint16_t last_base[BLOCK] = {0}, last_now[BLOCK] = {0};
    memcpy(last_now, now + i, (count - i) * sizeof *now);
    if (base) {
        memcpy(last_base, base + i, (count - i) * sizeof *base);
    }
    fill_plain_block(last_base, last_now, spare_bits, symbols);
}

static void fill_plain(const uint16_t *base, const uint16_t *now, size_t count, int spare_bits, uint16_t *symbols)
{
    for (size_t i = 0; i < count; i += BLOCK) {
        make_plain_block(base, now, count, i, spare_bits, symbols + i);
    }
}

/* Adds to each sum how many bits a symbol has: the exponent of 2 s + 1, which a float tells. */
static void weigh_block(const uint16_t *restrict symbols, uint32_t *restrict bits)
{
    for (int k = 0; k < BLOCK; k++) {
        const float odd = (float)(2 * symbols[k] + 1);
        uint32_t number;
        memcpy(&number, &odd, sizeof number);
        bits[k] += (number >> 23) - 127;
    }
}

/* About how many bits the symbols would take: of each as many as it has. */
static uint64_t weigh_plain(const uint16_t *base, const uint16_t *now, size_t count, int spare_bits)
{
    uint32_t bits[BLOCK] = {0};
    uint64_t sum = 0;
    for (size_t i = 0; i < count; i += BLOCK) {
        uint16_t symbols[BLOCK];
        make_plain_block(base, now, count, i, spare_bits, symbols);
        weigh_block(symbols, bits);
    }
    for (int k = 0; k < BLOCK; k++) {
        sum += bits[k];
    }
    return sum;
}

bool delta_make_plain(const delta_shape *shape, const uint16_t *base, const uint16_t *now, uint16_t *symbols,
                      uint16_t *all)
{
    const size_t count = delta_count(shape);
    const int spare_bits = 16 - shape->bits;
    const bool whole = !base || weigh_plain(NULL, now, count, spare_bits) <= weigh_plain(base, now, count, spare_bits);
    fill_plain(whole ? NULL : base, now, count, spare_bits, symbols);
    *all = or_all(symbols, count);
    return whole;
}

static void apply_plain(const uint16_t *restrict symbols, const uint16_t *restrict base, size_t count, int bits,
                        uint16_t *restrict now)
{
    const int32_t mask = (1 << bits) - 1;
    for (size_t i = 0; i < count; i++) {
        const int32_t symbol = symbols[i];
        now[i] = (uint16_t)(((base ? base[i] : 0) + ((symbol >> 1) ^ -(symbol & 1))) & mask);
    }
}

/* ---- the way back */

static inline void apply(const delta_shape *shape, size_t step, int32_t carry, const uint16_t *restrict symbols,
                         const uint16_t *restrict base, int16_t *restrict d, uint16_t *restrict now)
{
    const size_t row = delta_row(shape), count = delta_count(shape);
    const int32_t mask = (1 << shape->bits) - 1;
    for (size_t root = 0; root < count; root += row) {
        int32_t before[DELTA_MAX_COMPONENTS] = {0};
        for (size_t i = root; i < root + row; i += step) {
            for (size_t k = 0; k < step; k++) {
                const int32_t n = neighbours_of(d + i + k, (ptrdiff_t)row), symbol = symbols[i + k];
                const int32_t error = (symbol >> 1) ^ -(symbol & 1);
                const int32_t number = (base[i + k] + ((4 * n + carry * before[k] + 8) >> 4) + error) & mask;
                const int32_t change = number - base[i + k];
                now[i + k] = (uint16_t)number;
                d[i + k] = (int16_t)change;
                before[k] = 4 * change - n;
            }
        }
    }
}

void delta_apply(const delta_shape *shape, uint8_t carry, const uint16_t *symbols, const uint16_t *base,
                 int16_t *changes, uint16_t *now)
{
    if (carry == DELTA_PLAIN) {
        apply_plain(symbols, base, delta_count(shape), shape->bits, now);
        return;
    }
    int16_t *d = changes + delta_before(shape);
    memset(changes, 0, delta_before(shape) * sizeof *changes);
    if (shape->components == 3) { /* which the compiler makes a loop of its own of */
        apply(shape, 3, carry, symbols, base, d, now);
    } else {
        apply(shape, shape->components, carry, symbols, base, d, now);
    }
}
