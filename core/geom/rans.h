/* rans.h: the entropy coder of Draco's bitstream: range asymmetric numeral systems with one state and bytes.
 *
 * Duda, "Asymmetric numeral systems" (2013), range variant. A symbol of probability p / 2^precision takes the state x
 * to (x / p) 2^precision + x mod p + c, c being the sum of the probabilities before it; bytes leave at the state's low
 * end so that it stays in [2^(precision+2), 2^(precision+10)). The encoder goes through the symbols backwards, the
 * decoder reads its bytes backwards. One state is one chain of dependent operations, so the encoder takes several
 * streams at once and goes through them in step: their bytes are the same as one by one. */
#ifndef GEOM_RANS_H
#define GEOM_RANS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    RANS_LEAST_PRECISION = 12, /* bits; what the bitstream allows */
    RANS_MAX_PRECISION = 20,
    RANS_LANES = 4,        /* streams that the encoder goes through at once */
    RANS_SYMBOL_BYTES = 3, /* most that one symbol adds to a stream */
    RANS_END_BYTES = 4     /* most that the last state takes */
};

/* What encoding one symbol needs, made from its probability: no division, no branch. */
typedef struct rans_entry {
    uint32_t threshold;  /* a state from here on sends a byte more */
    uint32_t reciprocal; /* of the probability: x / p = x reciprocal >> shift, exactly, for every state */
    uint32_t complement; /* bits 0-23: 2^precision - probability; 24-31: bits sent from the threshold on */
    uint32_t cumulative; /* bits 0-23: sum of the probabilities before it; 24-31: shift */
} rans_entry;

/* `probability` 1 .. 2^precision, `cumulative` + `probability` <= 2^precision. */
rans_entry rans_entry_make(uint32_t probability, uint32_t cumulative, int precision);

/* One stream to be encoded. */
typedef struct rans_lane {
    const uint16_t *symbols;   /* [count] */
    size_t count;              /* 0 for a lane that is not used */
    const rans_entry *entries; /* by symbol; every symbol that occurs has one */
    int precision;
    unsigned char *bytes; /* room for RANS_SYMBOL_BYTES count + RANS_END_BYTES */
    size_t size;          /* out: bytes written */
} rans_lane;

/* Encodes RANS_LANES streams. */
void rans_encode(rans_lane lanes[RANS_LANES]);

/* What decoding one symbol needs. */
typedef struct rans_share {
    uint32_t probability, cumulative;
} rans_share;

/* One stream to be decoded. */
typedef struct rans_source {
    const unsigned char *bytes; /* [size] */
    size_t size;
    int precision;
    const uint16_t *slots;    /* [2^precision]: the symbol that each remainder means */
    const rans_share *shares; /* by symbol */
} rans_source;

/* Decodes `count` symbols. False: the bytes are not what an encoder wrote for that many, and what `symbols` holds means
 * nothing. Only a stream that is used up to its first byte, and ends in the state that encoders begin with, is taken,
 * which most damaged ones do not: a weak checksum of about seven bits. */
bool rans_decode(const rans_source *source, uint16_t *symbols, size_t count);

/* One stream among RANS_LANES. */
typedef struct rans_target {
    rans_source source;
    uint16_t *symbols; /* [count] */
    size_t count;      /* 0: a stream that is not used */
} rans_target;

/* The same for RANS_LANES streams, each of a precision of 18 at most: no stream waits for its own last symbol. False:
 * one of them is not what an encoder wrote. */
bool rans_decode_lanes(const rans_target targets[RANS_LANES]);

#endif
