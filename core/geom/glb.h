/* glb.h: what a GLB of ours says, read from a source that need not be trusted. */
#ifndef GEOM_GLB_H
#define GEOM_GLB_H

#include "geom/glb_shim.h"

/* Reads and checks everything but the Draco data: on success the patches cover strands 0 .. strands-1 in order, their
 * counts are those of the kind, and their data lie in the binary chunk, which points into `bytes`. The patches'
 * min and max are left zero. AWT_BAD_FORMAT, AWT_TRUNCATED, AWT_BAD_VALUE, AWT_LIMIT, AWT_NO_MEMORY; `out` is then
 * zeroed. glb_frame_fini. */
awt_status glb_read(const void *bytes, size_t size, glb_frame *out, awt_error *error);
void glb_frame_fini(glb_frame *frame);

#endif
