/* cloud.h: small numbers in Draco's bitstream without a mesh around them: a sequential point cloud with one attribute.
 *
 * A mesh has to have a triangle for every three vertices, and decoders refuse it where it has fewer than three bytes a
 * triangle: a byte a vertex, more than a delta takes. A point cloud has no such rule.
 *
 *   "DRACO" 2 3 | u8 0: point cloud | u8 0: sequential | u16 0 | u32 points | u8 1: attributes decoder | u8 1:
 * attribute | u8 4: generic | u8 3: int16 | u8 components | u8 0: not normalised | u8 0: its id | u8 1: whole numbers
 *   | i8 -2: no prediction | u8 1: compressed | the numbers as symbols (symbols.h), the sign in the lowest bit */
#ifndef GEOM_CLOUD_H
#define GEOM_CLOUD_H

#include "awt.h"
#include "geom/symbols.h"

enum { CLOUD_HEAD_BYTES = 25 };

/* All that stands before the symbols' data. */
void cloud_head(uint32_t points, uint32_t components, unsigned char head[CLOUD_HEAD_BYTES]);

/* One cloud on its way out. */
typedef struct cloud_job {
    uint32_t points, components; /* points 0: a job that is not used */
    uint32_t alphabet;           /* above every symbol: 32 .. 2^bits */
    size_t size;                 /* out: bytes of the cloud */
    double entropy_bits;         /* out, where asked for */
} cloud_job;

/* The memory of a writer, which goes through RANS_LANES clouds at once. */
typedef struct cloud_writer cloud_writer;
/* For at most `room` numbers a cloud, of `bits` bits, 5 at least. AWT_NO_MEMORY. */
awt_status cloud_writer_create(size_t room, int bits, cloud_writer **out, awt_error *error);
void cloud_writer_destroy(cloud_writer *writer);
/* Bytes that it holds. */
size_t cloud_writer_bytes(const cloud_writer *writer);

/* Where the symbols [room] of cloud number `lane` go, each below 2^bits. */
uint16_t *cloud_writer_symbols(cloud_writer *writer, int lane);
/* Encodes them; cloud_writer_put then copies cloud number `lane` to `out` [size]. */
void cloud_writer_run(cloud_writer *writer, cloud_job jobs[RANS_LANES], bool measure);
void cloud_writer_put(const cloud_writer *writer, const cloud_job *job, int lane, unsigned char *out);

/* One cloud on its way in. */
typedef struct cloud_source {
    const unsigned char *bytes; /* [size] */
    size_t size;
    uint32_t points; /* 0: a source that is not used */
} cloud_source;

/* The memory of a reader, which goes through RANS_LANES clouds at once. */
typedef struct cloud_reader {
    symbols_tables tables[RANS_LANES];
    uint16_t *symbols[RANS_LANES]; /* the caller's */
} cloud_reader;

/* Reads clouds of exactly so many points from sources that need not be trusted: `symbols` [points][components] of each,
 * all below 2^bits. False: the bytes of one are not that, to the last; symbols may be half written. */
bool cloud_read(cloud_reader *reader, const cloud_source sources[RANS_LANES], uint32_t components, int bits);

#endif
