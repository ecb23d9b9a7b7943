/* glb_text.c: see glb_text.h. */
#include "geom/glb_text.h"

#include "base/assert.h"
#include "base/bytes.h"
#include "geom/buffer.h"
#include "geom/glb_shim.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { GLB_HEADER = 12, GLB_CHUNK_HEADER = 8, REAL_ROOM = 25 };

void glb_text_put(glb_text *t, const char *words)
{
    const size_t size = strlen(words);
    ASSERT(size <= sizeof t->bytes - t->size);
    memcpy(t->bytes + t->size, words, size);
    t->size += size;
}

void glb_text_format(glb_text *t, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    const int size = vsnprintf(t->bytes + t->size, sizeof t->bytes - t->size, format, values);
    va_end(values);
    ASSERT(size >= 0 && (size_t)size < sizeof t->bytes - t->size);
    t->size += (size_t)size;
}

void glb_text_reals(glb_text *t, const double *values, int count)
{
    for (int k = 0; k < count; k++) {
        if (k > 0) {
            glb_text_put(t, ",");
        }
        ASSERT(REAL_ROOM <= sizeof t->bytes - t->size);
        t->size += glb_shim_print(values[k], t->bytes + t->size, REAL_ROOM);
    }
}

void glb_text_scene(glb_text *t, int64_t time_us)
{
    glb_text_format(t,
                    "{\"asset\":{\"version\":\"2.0\",\"generator\":\"awtd\",\"extras\":{\"time_us\":%" PRId64 "}},"
                    "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],",
                    time_us);
}

void glb_text_pose(glb_text *t, const awt_pose *head)
{
    glb_text_put(t, "\"translation\":[");
    glb_text_reals(t, head->position, 3);
    glb_text_put(t, "],\"rotation\":[");
    glb_text_reals(t, head->orientation, 4);
    glb_text_put(t, "]");
}

awt_status glb_text_begin(glb_text *t, size_t behind, geom_buffer *out, awt_error *error)
{
    const size_t spaces = (0 - t->size) % 4, at = t->size - behind;
    ASSERT(behind <= t->size && spaces <= sizeof t->bytes - t->size);
    memmove(t->bytes + at + spaces, t->bytes + at, behind);
    memset(t->bytes + at, ' ', spaces);
    t->size += spaces;
    unsigned char *file;
    out->size = 0;
    const size_t size = GLB_HEADER + GLB_CHUNK_HEADER + t->size + GLB_CHUNK_HEADER;
    awt_status status = geom_buffer_extend(out, size, &file, error);
    if (status == AWT_OK) {
        memset(file, 0, size);
        memcpy(file, "glTF\2", 5);
        store_u32(file + GLB_HEADER, (uint32_t)t->size);
        memcpy(file + GLB_HEADER + 4, "JSON", 4);
        memcpy(file + GLB_HEADER + GLB_CHUNK_HEADER, t->bytes, t->size);
        memcpy(file + size - 4, "BIN", 3);
    }
    return status;
}

void glb_text_end(size_t binary, geom_buffer *out)
{
    store_u32(out->bytes + binary - GLB_CHUNK_HEADER, (uint32_t)(out->size - binary));
    store_u32(out->bytes + 8, (uint32_t)out->size);
}
