/* record_ops.h: what is in a recording of a forest: magic "AWTR", u32 format version, u64 size of the snapshot of the
 * start, the snapshot; then records: u8 operation, u32 size, payload, CRC32C of all three. RECORD_OPS is the one list
 * of operations: from it come their numbers, the writer (record.c) and the reader (replay.c); each has one walk over
 * its payload that serves both. */
#ifndef SIM_RECORD_OPS_H
#define SIM_RECORD_OPS_H

#include "awt.h"
#include "base/codec.h"

enum { RECORD_FORMAT = 1, RECORDING_HEADER = 16, RECORD_HEADER = 5, RECORD_CRC = 4, RECORD_SIZE_MOST = 8192 };

extern const unsigned char RECORDING_MAGIC[4];

typedef struct record_advance {
    int64_t time_us;
    uint64_t hash; /* of the state then */
} record_advance;

typedef struct record_skip {
    int64_t time_us;
} record_skip;

/* Operation, its number in the file, its payload. */
#define RECORD_OPS(X)             \
    X(move, 1, awt_motion)        \
    X(params, 2, awt_params)      \
    X(advance, 3, record_advance) \
    X(skip, 4, record_skip)

/* Writes *payload to `c`, or reads it from there: AWT_LIMIT, AWT_BAD_VALUE, AWT_NO_PARAM. That all was read the caller
 * asks of `c`. */
#define RECORD_WALK(op, number, type) awt_status record_walk_##op(codec *c, type *payload, awt_error *error);
RECORD_OPS(RECORD_WALK)
#undef RECORD_WALK

#endif
