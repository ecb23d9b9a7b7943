/* draco_shim.h: one mesh into Draco's bitstream and back, through stock libdraco. C types; no exception gets out.
 *
 * Sequential encoding (vertex order is strand order), one float position per vertex, quantised to a box that the
 * caller fixes. The decoder reads only that kind, and checks every count before libdraco may allocate by it. */
#ifndef GEOM_DRACO_SHIM_H
#define GEOM_DRACO_SHIM_H

#include "geom/box.h"
#include "geom/encode.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Coordinate `value` along axis `axis` as a decoder gives it back: quantised and dequantised with Draco's arithmetic.
 */
float draco_shim_round(const draco_box *box, int axis, float value);

/* Appends one mesh to `out`: positions [vertices][3] (finite, within the box), triangles of `indices` [triangles][3].
 * AWT_NO_MEMORY, AWT_LIMIT, AWT_BAD_VALUE (libdraco refuses it). */
awt_status draco_shim_encode(const draco_box *box, const float *positions, uint32_t vertices, const uint16_t *indices,
                             uint32_t triangles, geom_buffer *out, awt_error *error);

/* Reads one mesh from a source that need not be trusted. It must hold exactly these `vertices` and `triangles` with
 * exactly these `indices` [triangles][3]; `positions` [vertices][3] is filled with finite numbers.
 * AWT_BAD_FORMAT, AWT_BAD_VALUE, AWT_NO_MEMORY. */
awt_status draco_shim_decode(const void *bytes, size_t size, const uint16_t *indices, uint32_t vertices,
                             uint32_t triangles, float *positions, awt_error *error);

#ifdef __cplusplus
}
#endif

#endif
