/* delta_write.h: what geom_encode_delta works with (for core/geom alone). */
#ifndef GEOM_DELTA_WRITE_H
#define GEOM_DELTA_WRITE_H

#include "geom/encode.h"

/* Clouds on their way, changes, and which patches changed. */
typedef struct delta_scratch delta_scratch;
awt_status delta_scratch_create(const geom_layout *layout, delta_scratch **out, awt_error *error);
void delta_scratch_destroy(delta_scratch *scratch);
/* Bytes that it holds. */
size_t delta_scratch_bytes(const delta_scratch *scratch);

/* The one of a scratch; NULL: its layout's frames have no deltas. (encode.c) */
delta_scratch *geom_scratch_delta(geom_scratch *scratch);

#endif
