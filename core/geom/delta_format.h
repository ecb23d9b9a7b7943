/* delta_format.h: the block that the extension AWT_delta carries (proto/DELTAS.md), for those who write and
 * read it: a header, a table of the patches that changed, their Draco point clouds (cloud.h) one after the other. */
#ifndef GEOM_DELTA_FORMAT_H
#define GEOM_DELTA_FORMAT_H

#include "base/codec.h"
#include "geom/box.h"

#define DELTA_EXTENSION "AWT_delta"

enum { DELTA_VERSION = 1, DELTA_HEADER_BYTES = 72, DELTA_ENTRY_BYTES = 16 };
#define DELTA_MAGIC UINT32_C(0x44545741) /* "AWTD" */

typedef struct delta_header {
    uint32_t magic;
    uint8_t version, kind, components, bits; /* kind: a geom_kind */
    uint64_t base_sequence, sequence;
    uint32_t base_checksum, checksum;    /* of the frames: quantised.h */
    uint32_t strands, points_per_strand; /* of guides: finest wisps, and sections of each */
    float origin[3], range;              /* the quantisation box, with `bits`; of guides 0 */
    uint32_t patches;                    /* in the table */
    uint32_t zero;
    uint64_t binding; /* of guides its id; else 0 */
} delta_header;

/* Patches follow one another in the order of their strands; strands in none of them did not change. */
typedef struct delta_entry {
    uint32_t first_strand, strands;
    uint32_t size; /* bytes of its point cloud */
    uint8_t carry; /* delta.h */
    bool whole;    /* its numbers are said against 0, not against the base's; DELTA_PLAIN only */
    uint8_t zeros[2];
} delta_entry;

static inline void delta_header_walk(codec *c, delta_header *h)
{
    codec_u32(c, &h->magic);
    codec_bytes(c, &h->version, 1);
    codec_bytes(c, &h->kind, 1);
    codec_bytes(c, &h->components, 1);
    codec_bytes(c, &h->bits, 1);
    codec_u64(c, &h->base_sequence);
    codec_u64(c, &h->sequence);
    codec_u32(c, &h->base_checksum);
    codec_u32(c, &h->checksum);
    codec_u32(c, &h->strands);
    codec_u32(c, &h->points_per_strand);
    for (int k = 0; k < 3; k++) {
        codec_f32(c, &h->origin[k]);
    }
    codec_f32(c, &h->range);
    codec_u32(c, &h->patches);
    codec_u32(c, &h->zero);
    codec_u64(c, &h->binding);
}

static inline void delta_entry_walk(codec *c, delta_entry *e)
{
    codec_u32(c, &e->first_strand);
    codec_u32(c, &e->strands);
    codec_u32(c, &e->size);
    codec_bytes(c, &e->carry, 1);
    codec_bool(c, &e->whole);
    codec_bytes(c, e->zeros, sizeof e->zeros);
}

#endif
