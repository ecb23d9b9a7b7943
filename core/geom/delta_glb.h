/* delta_glb.h: the GLB around a delta's block: a node with the head's pose, and the block in a bufferView that the
 * node's extension AWT_delta names. */
#ifndef GEOM_DELTA_GLB_H
#define GEOM_DELTA_GLB_H

#include "geom/encode.h"

/* Replaces what `out` holds by a file up to its binary chunk's first byte. AWT_NO_MEMORY, AWT_LIMIT. */
awt_status delta_glb_begin(const awt_pose *head, int64_t time_us, geom_buffer *out, awt_error *error);
/* Writes the lengths when the block, which begins at *block, has been appended; adds zeros up to a multiple of 4. */
awt_status delta_glb_end(size_t block, geom_buffer *out, awt_error *error);

/* What such a file holds. */
typedef struct delta_glb {
    awt_pose head;
    int64_t time_us;
    const unsigned char *block; /* [size], in the file */
    size_t size;
} delta_glb;

/* Reads one from a source that need not be trusted: everything but the block. AWT_BAD_FORMAT, AWT_TRUNCATED,
 * AWT_BAD_VALUE, AWT_LIMIT, AWT_NO_MEMORY. */
awt_status delta_glb_read(const void *bytes, size_t size, delta_glb *out, awt_error *error);

#endif
