/* encode_stock.h: a frame's patches by libdraco's own encoder: the reference that ours is measured against and judged
 * by. */
#ifndef GEOM_ENCODE_STOCK_H
#define GEOM_ENCODE_STOCK_H

#include "geom/layout.h"

/* Appends every patch to `out`, a frame that has been begun, and fills in its places. `vertices`: room for the largest
 * patch. AWT_BAD_VALUE (a point is not finite), AWT_NO_MEMORY, AWT_LIMIT. */
awt_status encode_stock(const geom_layout *layout, const geom_frame_def *def, float *vertices, geom_buffer *out,
                        geom_frame_stats *stats, awt_error *error);

#endif
