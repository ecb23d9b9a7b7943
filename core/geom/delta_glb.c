/* delta_glb.c: the GLB around a delta, written (delta_glb.h). The JSON is always the same but for a pose, a time and
 * two lengths, so that no library is asked to write it. */
#include "geom/delta_glb.h"

#include "base/bytes.h"
#include "base/error.h"
#include "geom/buffer.h"
#include "geom/delta_format.h"
#include "geom/glb_shim.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { GLB_HEADER = 12, GLB_CHUNK_HEADER = 8, LENGTH_WIDTH = 10, JSON_ROOM = 1024, REAL_ROOM = 25 };

static const char BEFORE_TIME[] = "{\"asset\":{\"version\":\"2.0\",\"generator\":\"awtd\",\"extras\":{\"time_us\":";
static const char BEFORE_POSE[] = "}},\"extensionsUsed\":[\"" DELTA_EXTENSION "\"],\"extensionsRequired\":"
                                  "[\"" DELTA_EXTENSION "\"],\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
                                  "\"nodes\":[{\"name\":\"hair\",\"translation\":[";
static const char BEFORE_LENGTHS[] = "],\"extensions\":{\"" DELTA_EXTENSION "\":{\"bufferView\":0}}}],";
/* Both lengths are the block's. */
static const char BUFFER_LENGTH[] = "\"buffers\":[{\"byteLength\":          }],";
static const char VIEW_LENGTH[] = "\"bufferViews\":[{\"buffer\":0,\"byteLength\":          }]}";

typedef struct text {
    char bytes[JSON_ROOM];
    size_t size;
} text;

static void put(text *t, const char *what, size_t size)
{
    memcpy(t->bytes + t->size, what, size);
    t->size += size;
}

static void put_reals(text *t, const double *values, int count)
{
    for (int k = 0; k < count; k++) {
        if (k > 0) {
            put(t, ",", 1);
        }
        t->size += glb_shim_print(values[k], t->bytes + t->size, REAL_ROOM);
    }
}

static void write_json(const awt_pose *head, int64_t time_us, text *t)
{
    char time[24];
    int digits = snprintf(time, sizeof time, "%" PRId64, time_us);
    put(t, BEFORE_TIME, sizeof BEFORE_TIME - 1);
    put(t, time, (size_t)digits);
    put(t, BEFORE_POSE, sizeof BEFORE_POSE - 1);
    put_reals(t, head->position, 3);
    put(t, "],\"rotation\":[", 14);
    put_reals(t, head->orientation, 4);
    put(t, BEFORE_LENGTHS, sizeof BEFORE_LENGTHS - 1);
    put(t, "    ", (0 - t->size - (sizeof BUFFER_LENGTH - 1) - (sizeof VIEW_LENGTH - 1)) % 4);
    put(t, BUFFER_LENGTH, sizeof BUFFER_LENGTH - 1);
    put(t, VIEW_LENGTH, sizeof VIEW_LENGTH - 1);
}

awt_status delta_glb_begin(const awt_pose *head, int64_t time_us, geom_buffer *out, awt_error *error)
{
    text t = {.size = 0};
    unsigned char *at;
    write_json(head, time_us, &t);
    out->size = 0;
    const size_t size = GLB_HEADER + GLB_CHUNK_HEADER + t.size + GLB_CHUNK_HEADER;
    awt_status status = geom_buffer_extend(out, size, &at, error);
    if (status == AWT_OK) {
        memset(at, 0, size);
        memcpy(at, "glTF\2", 5);
        store_u32(at + GLB_HEADER, (uint32_t)t.size);
        memcpy(at + GLB_HEADER + 4, "JSON", 4);
        memcpy(at + GLB_HEADER + GLB_CHUNK_HEADER, t.bytes, t.size);
        memcpy(at + size - 4, "BIN", 3);
    }
    return status;
}

/* `length` at the end of a field that ends `behind` bytes before `end`. */
static void put_length(unsigned char *end, size_t behind, uint32_t length)
{
    char digits[LENGTH_WIDTH + 1];
    int written = snprintf(digits, sizeof digits, "%" PRIu32, length);
    memcpy(end - behind - LENGTH_WIDTH, digits, (size_t)written);
}

awt_status delta_glb_end(size_t block, geom_buffer *out, awt_error *error)
{
    static const unsigned char zeros[4];
    const uint32_t length = (uint32_t)(out->size - block);
    awt_status status = geom_buffer_append(out, zeros, (0 - out->size) % 4, error);
    if (status == AWT_OK) {
        unsigned char *json_end = out->bytes + block - GLB_CHUNK_HEADER;
        put_length(json_end, 3, length);                            /* before }]} */
        put_length(json_end, 3 + (sizeof VIEW_LENGTH - 1), length); /* before }], */
        store_u32(json_end, (uint32_t)(out->size - block));
        store_u32(out->bytes + 8, (uint32_t)out->size);
    }
    return status;
}
