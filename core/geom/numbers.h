/* numbers.h: triples of 16-bit numbers to the symbols that the bitstream holds, and back: each with its sign folded
 * into the lowest bit, as its difference to the triple before (quantise.h does that for positions). */
#ifndef GEOM_NUMBERS_H
#define GEOM_NUMBERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Numbers [count][3] of `bits` bits (2 .. 15), sign included, become symbols [count][3] below 2^bits. Returns the
 * greatest symbol. */
uint16_t numbers_differences(int bits, const int16_t *numbers, size_t count, uint16_t *symbols);
/* The way back. False: a symbol is none of numbers of so many bits. May be done in place. */
bool numbers_sum_up(int bits, const uint16_t *symbols, size_t count, int16_t *numbers);

#endif
