/* buffer.c: bytes that grow and are kept for the next frame. */
#include "geom/buffer.h"

#include "base/error.h"

#include <stdlib.h>
#include <string.h>

void geom_buffer_fini(geom_buffer *buffer)
{
    free(buffer->bytes);
    *buffer = (geom_buffer){0};
}

awt_status geom_buffer_extend(geom_buffer *buffer, size_t size, unsigned char **at, awt_error *error)
{
    if (size > GEOM_MAX_GLB - buffer->size) {
        return error_set(
            error, AWT_LIMIT,
            "a frame may hold %d MiB and this one is larger: ask for fewer strands, or fewer points a strand",
            GEOM_MAX_GLB / (1024 * 1024));
    }
    if (size > buffer->capacity - buffer->size) {
        size_t wanted = buffer->size + size;
        size_t capacity = buffer->capacity < wanted / 2 ? wanted : 2 * buffer->capacity;
        unsigned char *larger = realloc(buffer->bytes, capacity);
        if (!larger) {
            return error_set(error, AWT_NO_MEMORY, NULL);
        }
        buffer->bytes = larger;
        buffer->capacity = capacity;
    }
    *at = buffer->bytes + buffer->size;
    buffer->size += size;
    return AWT_OK;
}

awt_status geom_buffer_append(geom_buffer *buffer, const void *bytes, size_t size, awt_error *error)
{
    unsigned char *at = NULL;
    if (size == 0) {
        return AWT_OK;
    }
    awt_status status = geom_buffer_extend(buffer, size, &at, error);
    if (status == AWT_OK) {
        memcpy(at, bytes, size);
    }
    return status;
}

awt_status geom_buffer_align(geom_buffer *buffer, awt_error *error)
{
    static const unsigned char zeros[4];
    return geom_buffer_append(buffer, zeros, (0 - buffer->size) % 4, error);
}
