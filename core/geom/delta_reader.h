/* delta_reader.h: a stranger's delta onto numbers that are here, whatever they mean (geom_delta_reader's insides, for
 * core/geom alone). Standard C. */
#ifndef GEOM_DELTA_READER_H
#define GEOM_DELTA_READER_H

#include "geom/cloud.h"
#include "geom/delta.h"
#include "geom/delta_format.h"
#include "geom/delta_glb.h"
#include "geom/read.h"

struct geom_delta_reader {
    cloud_reader clouds;
    uint16_t *base, *now, *symbols; /* [room]; symbols of all patches, each at its strands' place */
    int16_t *changes;
    size_t room, changes_room;
};

/* Finds a delta's block in its file: *header is read, whatever it says, and *block goes on behind it. Errors of
 * delta_glb_read. */
awt_status delta_reader_open(const void *bytes, size_t size, delta_glb *glb, delta_header *header, codec *block,
                             awt_error *error);

/* What `strands` strands of a delta are; its box; and the checksum of numbers that it could be of. */
delta_shape delta_reader_shape(const delta_header *header, uint32_t strands);
draco_box delta_reader_box(const delta_header *header);
uint32_t delta_reader_checksum(const delta_header *header, const uint16_t *numbers);

/* Room for frames of that shape, as large as the frame that is here and no larger. AWT_NO_MEMORY. */
awt_status delta_reader_room(geom_delta_reader *reader, const delta_shape *shape, awt_error *error);

/* Makes `now` of `base`, for which there is room, and of the table and patches that `block`, behind its header, holds.
 * The header's counts, components and bits are those of the base. AWT_BAD_FORMAT: they are damaged. */
awt_status delta_reader_take(geom_delta_reader *reader, const delta_header *header, codec *block, awt_error *error);

#endif
