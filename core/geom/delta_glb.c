/* delta_glb.c: the GLB around a delta, written (delta_glb.h). The JSON is always the same but for a pose, a time and
 * two lengths, which are known last and stand in fields of fixed width at its end. */
#include "geom/delta_glb.h"

#include "geom/buffer.h"
#include "geom/delta_format.h"
#include "geom/glb_text.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { LENGTH_WIDTH = 10 };

/* Both lengths are the block's. */
static const char BUFFER_LENGTH[] = "\"buffers\":[{\"byteLength\":          }],";
static const char VIEW_LENGTH[] = "\"bufferViews\":[{\"buffer\":0,\"byteLength\":          }]}";

awt_status delta_glb_begin(const awt_pose *head, int64_t time_us, geom_buffer *out, awt_error *error)
{
    glb_text t = {.size = 0};
    glb_text_scene(&t, time_us);
    glb_text_put(&t, "\"extensionsUsed\":[\"" DELTA_EXTENSION "\"],\"extensionsRequired\":[\"" DELTA_EXTENSION "\"],"
                     "\"nodes\":[{\"name\":\"hair\",");
    glb_text_pose(&t, head);
    glb_text_put(&t, ",\"extensions\":{\"" DELTA_EXTENSION "\":{\"bufferView\":0}}}],");
    glb_text_put(&t, BUFFER_LENGTH);
    glb_text_put(&t, VIEW_LENGTH);
    return glb_text_begin(&t, sizeof BUFFER_LENGTH - 1 + sizeof VIEW_LENGTH - 1, out, error);
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
    const uint32_t length = (uint32_t)(out->size - block);
    awt_status status = geom_buffer_align(out, error);
    if (status == AWT_OK) {
        unsigned char *json_end = out->bytes + block - 8;           /* the binary chunk's header lies between */
        put_length(json_end, 3, length);                            /* before }]} */
        put_length(json_end, 3 + (sizeof VIEW_LENGTH - 1), length); /* before }], */
        glb_text_end(block, out);
    }
    return status;
}
