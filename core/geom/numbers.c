/* numbers.c: see numbers.h. */
#include "geom/numbers.h"

static uint16_t fold(int32_t number)
{
    return (uint16_t)(((uint32_t)number << 1) ^ (uint32_t)(number >> 31));
}

static int32_t unfold(uint16_t symbol)
{
    return (int32_t)(symbol >> 1) ^ -(int32_t)(symbol & 1);
}

/* `number` modulo 2^bits, in -2^(bits-1) .. 2^(bits-1) - 1. */
static int32_t wrap(int bits, int32_t number)
{
    const int spare = 32 - bits;
    return (int32_t)((uint32_t)number << spare) >> spare;
}

uint16_t numbers_differences(int bits, const int16_t *numbers, size_t count, uint16_t *symbols)
{
    uint16_t all = 0;
    for (size_t i = 0; i < 3 * count; i++) {
        symbols[i] = fold(wrap(bits, numbers[i] - (i < 3 ? 0 : numbers[i - 3])));
        all = symbols[i] > all ? symbols[i] : all;
    }
    return all;
}

bool numbers_sum_up(int bits, const uint16_t *symbols, size_t count, int16_t *numbers)
{
    uint32_t all = 0;
    for (size_t i = 0; i < 3 * count; i++) {
        all |= symbols[i];
        numbers[i] = (int16_t)wrap(bits, (i < 3 ? 0 : numbers[i - 3]) + unfold(symbols[i]));
    }
    return all >> bits == 0;
}
