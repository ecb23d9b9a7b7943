/* symbols.h: a run of small numbers in Draco's bitstream, entropy coded (rans.h) by either of its two schemes.
 *
 *   raw:    u8 1 | u8 b | table | varint bytes | rANS data      every number a symbol; precision min(max(3 b / 2, 12),
 * 20) tagged: u8 0 | table | varint bytes | rANS data | bits      the numbers come by threes; the length of the longest
 * of the three is a symbol (precision 12), their bits follow table:  varint symbols, then for each symbol its
 * probability p in 2^precision: a byte p << 2 where p < 2^6, two bytes (p << 2 | 1, least first) where p < 2^14, else
 * three (p << 2 | 2); for 1 to 64 symbols that do not occur a byte (number - 1) << 2 | 3
 *
 * Raw compresses better where the numbers are alike or small, tagged where there are few or where big and small ones
 * take turns, as in ribbons; it needs no large table and is faster. */
#ifndef GEOM_SYMBOLS_H
#define GEOM_SYMBOLS_H

#include "geom/rans.h"

typedef enum symbols_scheme { SYMBOLS_TAGGED = 0, SYMBOLS_RAW = 1 } symbols_scheme;

enum {
    SYMBOLS_MAX_ALPHABET = 1 << 15,
    SYMBOLS_MAX_COUNT = 1 << 20,   /* numbers in one run */
    SYMBOLS_READ_PRECISION = 18,   /* bits; the greatest that we write or read */
    SYMBOLS_HEAD_BYTES = 2 + 5 + 5 /* all but the table and the data, at most */
};

/* Most bytes that the table and the rANS data take. */
static inline size_t symbols_bound(uint32_t alphabet, size_t count)
{
    return SYMBOLS_HEAD_BYTES + (size_t)alphabet * 3 + count * RANS_SYMBOL_BYTES + RANS_END_BYTES;
}

/* Most bytes that the bits of `count` tagged numbers take. */
static inline size_t symbols_bits_bound(size_t count)
{
    return count * 2 + 8;
}

/* One run on its way out, and the memory that it takes; all of the caller's. */
typedef struct symbols_run {
    symbols_scheme scheme;
    const uint16_t *symbols; /* [count], each below `alphabet` */
    size_t count;            /* 1 .. SYMBOLS_MAX_COUNT, of tagged ones a multiple of 3; 0: a run that is not used */
    uint32_t alphabet;       /* 32 .. SYMBOLS_MAX_ALPHABET */
    uint32_t *counts;        /* [4][alphabet] */
    uint16_t *used;          /* [alphabet] */
    rans_entry *entries;     /* [alphabet] */
    uint16_t *tags;          /* tagged: [count / 3] */
    unsigned char *bytes;    /* [symbols_bound]; on return all but the bits */
    unsigned char *bits;     /* tagged: [symbols_bits_bound]; on return the bits */
    size_t size, bits_size;  /* out: bytes of them */
    bool measure;
    double entropy_bits; /* out where `measure` is set: the least for any coder of single numbers */
} symbols_run;

/* Writes RANS_LANES runs at once. */
void symbols_write(symbols_run runs[RANS_LANES]);

/* The memory of one reader. */
typedef struct symbols_tables {
    uint16_t slots[1 << SYMBOLS_READ_PRECISION];
    rans_share shares[SYMBOLS_MAX_ALPHABET];
} symbols_tables;

/* Reads a run of `count` symbols (a multiple of 3), each below `alphabet`, from a source that need not be trusted; *at
 * moves behind it. False: there is none, or one that no encoder wrote; `symbols` is half written then. */
bool symbols_read(const unsigned char **at, const unsigned char *end, uint32_t alphabet, symbols_tables *tables,
                  uint16_t *symbols, size_t count);

/* A run on its way in: its rANS data wait to be decoded. */
typedef struct symbols_waiting {
    symbols_scheme scheme;
    uint32_t alphabet;
    size_t count;
    uint16_t *symbols;  /* [count] */
    rans_target target; /* for rans_decode_lanes; of a precision of SYMBOLS_READ_PRECISION at most */
} symbols_waiting;

/* The same in two halves, so that several runs are decoded at once: before, which moves *at behind the rANS data, and
 * after, which moves it behind the run. `tables` and `symbols` are in use in between. */
bool symbols_begin(const unsigned char **at, const unsigned char *end, uint32_t alphabet, symbols_tables *tables,
                   uint16_t *symbols, size_t count, symbols_waiting *out);
bool symbols_end(const unsigned char **at, const unsigned char *end, const symbols_waiting *run);

/* All of a run in the raw scheme but its data, which become *out for rans_decode_lanes; *at moves behind them. `tables`
 * is in use until then. False: there is none. */
bool symbols_open(const unsigned char **at, const unsigned char *end, uint32_t alphabet, symbols_tables *tables,
                  rans_source *out);

#endif
