/* delta_glb_read.c: the GLB around a delta, read (delta_glb.h): standard C alone. */
#include "geom/delta_glb.h"

#include "base/error.h"
#include "geom/delta_format.h"
#include "geom/glb_container.h"

static bool whole_is(const json_document *json, uint32_t object, const char *member, uint32_t expected)
{
    uint32_t value;
    return json_whole(json, json_member(json, object, member), &value) && value == expected;
}

static bool take_json(const json_document *json, size_t binary_size, delta_glb *out)
{
    const uint32_t node = json_member(json, 0, "nodes"), view = json_member(json, 0, "bufferViews");
    const uint32_t buffer = json_member(json, 0, "buffers"), required = json_member(json, 0, "extensionsRequired");
    if (!json_is_text(json, json_member(json, json_member(json, 0, "asset"), "version"), "2.0") ||
        json_items(json, required) != 1 || !json_is_text(json, required + 1, DELTA_EXTENSION) ||
        json_items(json, node) != 1 || json_items(json, view) != 1 || json_items(json, buffer) != 1 ||
        !json_is_text(json, json_member(json, node + 1, "name"), "hair")) {
        return false;
    }
    const uint32_t extensions = json_member(json, node + 1, "extensions");
    uint32_t length;
    if (!whole_is(json, json_member(json, extensions, DELTA_EXTENSION), "bufferView", 0) ||
        !whole_is(json, view + 1, "buffer", 0) || json_member(json, view + 1, "byteOffset") != JSON_NONE ||
        !json_whole(json, json_member(json, view + 1, "byteLength"), &length) ||
        !whole_is(json, buffer + 1, "byteLength", length) || length > binary_size || binary_size - length > 3) {
        return false;
    }
    out->size = length;
    return glb_read_pose(json, node + 1, &out->head) && glb_read_time(json, &out->time_us);
}

awt_status delta_glb_read(const void *bytes, size_t size, delta_glb *out, awt_error *error)
{
    glb_chunk text_chunk, binary;
    json_document json = {0};
    awt_status status = glb_container_take(bytes, size, &text_chunk, &binary, error);
    if (status == AWT_OK) {
        status = json_read((const char *)text_chunk.bytes, text_chunk.size, &json, error);
    }
    if (status == AWT_OK) {
        out->block = binary.bytes;
        if (!take_json(&json, binary.size, out)) {
            status = error_set(error, AWT_BAD_FORMAT, "this GLB is no delta of awtd's");
        }
    }
    json_fini(&json);
    return status;
}
