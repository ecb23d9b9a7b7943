/* cloud_shim.h: the point clouds of cloud.h through stock libdraco, the reference that ours are compared with. C types;
 * no exception gets out. */
#ifndef GEOM_CLOUD_SHIM_H
#define GEOM_CLOUD_SHIM_H

#include "geom/encode.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Appends a sequential point cloud with one attribute, `numbers` [points][components] as they are, to `out`.
 * AWT_NO_MEMORY, AWT_LIMIT, AWT_BAD_VALUE. */
awt_status cloud_shim_encode(const int16_t *numbers, uint32_t points, uint32_t components, geom_buffer *out,
                             awt_error *error);

/* Reads one of exactly so many points, from a source that is trusted. AWT_BAD_FORMAT, AWT_NO_MEMORY. */
awt_status cloud_shim_decode(const void *bytes, size_t size, uint32_t points, uint32_t components, int16_t *numbers,
                             awt_error *error);

#ifdef __cplusplus
}
#endif

#endif
