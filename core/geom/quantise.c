/* quantise.c: see quantise.h. The loops over a block have a fixed length and no branch: compilers make vectors of them,
 * as wide as the machine's, and whatever the width the numbers are the same. */
#include "geom/quantise.h"

#include <string.h>

/* A block's numbers are read again, three places off, when many more have been written: a machine that has them still
 * on the way to memory would wait for them. */
enum { BLOCK = QUANTISE_BLOCK, CHUNK_BLOCKS = 20 };

/* The axes' constants, repeated over a block. */
typedef struct block_constants {
    float origin[BLOCK], least[BLOCK], greatest[BLOCK];
    float per_metre;
    int spare_bits; /* of 16 */
} block_constants;

/* What a block has met, by coordinate. */
typedef struct block_findings {
    int16_t least[BLOCK], greatest[BLOCK];
    int32_t outside[BLOCK];
} block_findings;

static void fill_constants(const draco_box *box, const quantise_bounds *bounds, block_constants *c)
{
    for (int i = 0; i < BLOCK; i++) {
        c->origin[i] = box->origin[i % 3];
        c->least[i] = bounds->least[i % 3];
        c->greatest[i] = bounds->greatest[i % 3];
    }
    c->per_metre = (float)((1 << box->bits) - 1) / box->range;
    c->spare_bits = 16 - box->bits;
}

/* Draco rounds by floor(x + 0.5); x is never negative here, so that cutting off is the same. */
static void quantise_block(const block_constants *restrict c, const float *restrict positions,
                           int16_t *restrict numbers, block_findings *restrict found)
{
    int32_t whole[BLOCK];
    for (int i = 0; i < BLOCK; i++) {
        float given = positions[i];
        float low = given > c->least[i] ? given : c->least[i]; /* not a number: the least */
        float value = low < c->greatest[i] ? low : c->greatest[i];
        whole[i] = (int32_t)((value - c->origin[i]) * c->per_metre + 0.5f);
        found->outside[i] |= value != given;
    }
    for (int i = 0; i < BLOCK; i++) {
        int16_t number = (int16_t)whole[i];
        numbers[i] = number;
        found->least[i] = number < found->least[i] ? number : found->least[i];
        found->greatest[i] = number > found->greatest[i] ? number : found->greatest[i];
    }
}

/* `numbers` begins with the three before the block. The sign goes into the lowest bit. */
static void difference_block(int spare_bits, const int16_t *restrict numbers, uint16_t *restrict symbols)
{
    for (int i = 0; i < BLOCK; i++) {
        int16_t difference = (int16_t)(numbers[i + 3] - numbers[i]);
        int16_t wrapped = (int16_t)((int16_t)((uint16_t)difference << spare_bits) >> spare_bits);
        symbols[i] = (uint16_t)((uint16_t)wrapped << 1) ^ (uint16_t)(wrapped >> 15);
    }
}

uint32_t quantise_count_outside(const quantise_bounds *bounds, const float *positions, size_t count)
{
    uint32_t outside = 0;
    for (size_t i = 0; i < count; i++, positions += 3) {
        bool out = false;
        for (int k = 0; k < 3; k++) {
            out = out || positions[k] < bounds->least[k] || positions[k] > bounds->greatest[k];
        }
        outside += out;
    }
    return outside;
}

static bool all_finite(const float *positions, size_t coordinates)
{
    bool finite = true;
    for (size_t i = 0; i < coordinates; i++) {
        finite = finite && positions[i] - positions[i] == 0.0f;
    }
    return finite;
}

static quantise_findings sum_up(const block_findings *found, const float *positions, size_t coordinates)
{
    quantise_findings all = {.finite = true};
    memset(all.least, 0xff, sizeof all.least);
    for (int i = 0; i < BLOCK; i++) {
        uint16_t least = (uint16_t)found->least[i], greatest = (uint16_t)found->greatest[i];
        all.least[i % 3] = least < all.least[i % 3] ? least : all.least[i % 3];
        all.greatest[i % 3] = greatest > all.greatest[i % 3] ? greatest : all.greatest[i % 3];
        all.outside = all.outside || found->outside[i];
    }
    all.finite = !all.outside || all_finite(positions, coordinates); /* what is not finite is outside, too */
    return all;
}

/* The coordinates from number `first` on, as far as a block goes; the last position stands for what is beyond the end.
 */
static void take_rest(const float *positions, size_t first, size_t coordinates, float *block)
{
    for (size_t k = 0; k < BLOCK; k++) {
        size_t at = first + k;
        block[k] = positions[at < coordinates ? at : coordinates - 3 + at % 3];
    }
}

static block_findings found_nothing(void)
{
    block_findings found;
    memset(&found, 0, sizeof found);
    for (int k = 0; k < BLOCK; k++) {
        found.least[k] = INT16_MAX;
    }
    return found;
}

quantise_findings quantise_differences(const draco_box *box, const quantise_bounds *bounds, const float *positions,
                                       size_t count, uint16_t *symbols)
{
    const size_t coordinates = 3 * count, blocks = quantise_room(count) / BLOCK;
    block_constants constants;
    block_findings found = found_nothing();
    int16_t numbers[3 + CHUNK_BLOCKS * BLOCK] = {0};
    fill_constants(box, bounds, &constants);
    for (size_t first = 0; first < blocks; first += CHUNK_BLOCKS) {
        const size_t here = blocks - first < CHUNK_BLOCKS ? blocks - first : CHUNK_BLOCKS;
        for (size_t b = 0; b < here; b++) {
            const size_t at = (first + b) * BLOCK;
            float rest[BLOCK];
            if (at + BLOCK > coordinates) {
                take_rest(positions, at, coordinates, rest);
            }
            quantise_block(&constants, at + BLOCK > coordinates ? rest : positions + at, numbers + 3 + b * BLOCK,
                           &found);
        }
        for (size_t b = 0; b < here; b++) {
            difference_block(constants.spare_bits, numbers + b * BLOCK, symbols + (first + b) * BLOCK);
        }
        memcpy(numbers, numbers + here * BLOCK, 3 * sizeof *numbers);
    }
    return sum_up(&found, positions, coordinates);
}

quantise_findings quantise_numbers(const draco_box *box, const quantise_bounds *bounds, const float *positions,
                                   size_t count, uint16_t *numbers)
{
    const size_t coordinates = 3 * count, whole = coordinates / BLOCK * BLOCK;
    block_constants constants;
    block_findings found = found_nothing();
    fill_constants(box, bounds, &constants);
    for (size_t at = 0; at < whole; at += BLOCK) {
        int16_t block[BLOCK];
        quantise_block(&constants, positions + at, block, &found);
        memcpy(numbers + at, block, sizeof block);
    }
    if (whole < coordinates) {
        float rest[BLOCK];
        int16_t block[BLOCK];
        take_rest(positions, whole, coordinates, rest);
        quantise_block(&constants, rest, block, &found);
        memcpy(numbers + whole, block, (coordinates - whole) * sizeof *block);
    }
    return sum_up(&found, positions, coordinates);
}

/* Bounds of a block of numbers. */
static void bound_block(const int16_t *restrict numbers, block_findings *restrict found)
{
    for (int i = 0; i < BLOCK; i++) {
        found->least[i] = numbers[i] < found->least[i] ? numbers[i] : found->least[i];
        found->greatest[i] = numbers[i] > found->greatest[i] ? numbers[i] : found->greatest[i];
    }
}

quantise_findings quantise_number_differences(int bits, const uint16_t *numbers, size_t count, uint16_t *symbols)
{
    const size_t coordinates = 3 * count;
    block_findings found = found_nothing();
    for (size_t at = 0; at < coordinates; at += BLOCK) {
        const size_t here = coordinates - at < BLOCK ? coordinates - at : BLOCK;
        int16_t block[3 + BLOCK] = {0};
        if (at > 0) {
            memcpy(block, numbers + at - 3, 3 * sizeof *block);
        }
        memcpy(block + 3, numbers + at, here * sizeof *block);
        for (size_t k = 3 + here; k < 3 + BLOCK; k++) { /* the last three again and again */
            block[k] = block[k - 3];
        }
        bound_block(block + 3, &found);
        difference_block(16 - bits, block, symbols + at);
    }
    return sum_up(&found, NULL, 0);
}

void quantise_sum_up(int bits, const uint16_t *symbols, size_t count, uint16_t *numbers)
{
    const uint32_t mask = (1u << bits) - 1;
    uint32_t x = 0, y = 0, z = 0;
    for (size_t i = 0; i < 3 * count; i += 3) {
        uint32_t a = symbols[i], b = symbols[i + 1], c = symbols[i + 2];
        x = (x + ((a >> 1) ^ (0 - (a & 1)))) & mask;
        y = (y + ((b >> 1) ^ (0 - (b & 1)))) & mask;
        z = (z + ((c >> 1) ^ (0 - (c & 1)))) & mask;
        numbers[i] = (uint16_t)x;
        numbers[i + 1] = (uint16_t)y;
        numbers[i + 2] = (uint16_t)z;
    }
}

/* `origin` is repeated over the block. */
static void place_block(const uint16_t *restrict numbers, const float *restrict origin, float step,
                        float *restrict positions)
{
    for (int k = 0; k < BLOCK; k++) {
        positions[k] = (float)numbers[k] * step + origin[k];
    }
}

static uint16_t or_block(uint16_t all, const uint16_t *symbols)
{
    uint16_t block[BLOCK / 6] = {0};
    for (int k = 0; k < BLOCK; k++) {
        block[k % (BLOCK / 6)] |= symbols[k];
    }
    for (int k = 0; k < BLOCK / 6; k++) {
        all |= block[k];
    }
    return all;
}

bool quantise_positions(const draco_box *box, uint16_t *symbols, size_t count, float *positions)
{
    const float step = draco_box_step(box);
    const size_t coordinates = 3 * count, whole = coordinates / BLOCK * BLOCK;
    uint16_t all = 0;
    float origin[BLOCK];
    for (int k = 0; k < BLOCK; k++) {
        origin[k] = box->origin[k % 3];
    }
    for (size_t i = 0; i < whole; i += BLOCK) {
        all = or_block(all, symbols + i);
    }
    for (size_t i = whole; i < coordinates; i++) {
        all |= symbols[i];
    }
    quantise_sum_up(box->bits, symbols, count, symbols);
    for (size_t i = 0; i < whole; i += BLOCK) {
        place_block(symbols + i, origin, step, positions + i);
    }
    for (size_t i = whole; i < coordinates; i++) {
        positions[i] = (float)symbols[i] * step + origin[i - whole];
    }
    return all >> box->bits == 0;
}
