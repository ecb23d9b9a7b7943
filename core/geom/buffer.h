/* buffer.h: how geom_buffer grows (encode.h has the type, for those who only read it). */
#ifndef GEOM_BUFFER_H
#define GEOM_BUFFER_H

#include "geom/encode.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Appends `size` bytes, growing to at least twice the room where it has to; what grew stays for the next frame.
 * AWT_NO_MEMORY; AWT_LIMIT beyond GEOM_MAX_GLB. The buffer is unchanged then. */
awt_status geom_buffer_append(geom_buffer *buffer, const void *bytes, size_t size, awt_error *error);

/* Grows by `size` bytes, which hold nothing yet: *at points to them until the buffer grows again. Errors as above. */
awt_status geom_buffer_extend(geom_buffer *buffer, size_t size, unsigned char **at, awt_error *error);

/* Appends zeros up to a multiple of 4. Errors as above. */
awt_status geom_buffer_align(geom_buffer *buffer, awt_error *error);

#ifdef __cplusplus
}
#endif

#endif
