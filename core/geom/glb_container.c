/* glb_container.c: see glb_container.h. Lengths are compared with what is there. */
#include "geom/glb_container.h"

#include "base/bytes.h"
#include "base/error.h"

#include <math.h>

enum { GLB_HEADER = 12, GLB_CHUNK_HEADER = 8 };
#define GLB_MAGIC UINT32_C(0x46546C67)
#define GLB_JSON UINT32_C(0x4E4F534A)
#define GLB_BINARY UINT32_C(0x004E4942)
/* Greatest time that a JSON number holds to the microsecond. */
#define GLB_MAX_TIME_US 9007199254740992.0

/* The chunk of `type` that begins at *at. */
static awt_status take_chunk(const unsigned char *bytes, size_t size, size_t *at, uint32_t type, glb_chunk *out,
                             awt_error *error)
{
    if (size - *at < GLB_CHUNK_HEADER) {
        return error_set(error, AWT_BAD_FORMAT, "the frame lacks its %s chunk", type == GLB_JSON ? "JSON" : "binary");
    }
    uint32_t length = load_u32(bytes + *at);
    if (load_u32(bytes + *at + 4) != type || length % 4 != 0 || length > size - *at - GLB_CHUNK_HEADER) {
        return error_set(error, AWT_BAD_FORMAT, "the frame's chunk at byte %u is not what belongs there",
                         (unsigned)*at);
    }
    *out = (glb_chunk){bytes + *at + GLB_CHUNK_HEADER, length};
    *at += GLB_CHUNK_HEADER + length;
    return AWT_OK;
}

awt_status glb_container_take(const unsigned char *bytes, size_t size, glb_chunk *json, glb_chunk *binary,
                              awt_error *error)
{
    if (size > GEOM_MAX_GLB) {
        return error_set(error, AWT_LIMIT, "a frame has %d MiB at most", GEOM_MAX_GLB / (1024 * 1024));
    }
    if (size < GLB_HEADER) {
        return error_set(error, AWT_TRUNCATED, "the frame ends within its first %d bytes", GLB_HEADER);
    }
    if (load_u32(bytes) != GLB_MAGIC || load_u32(bytes + 4) != 2) {
        return error_set(error, AWT_BAD_FORMAT, "this is not a GLB 2.0 file");
    }
    if (load_u32(bytes + 8) > size) {
        return error_set(error, AWT_TRUNCATED, "the frame ends at byte %u of the %u it announces", (unsigned)size,
                         load_u32(bytes + 8));
    }
    size_t at = GLB_HEADER;
    awt_status status = take_chunk(bytes, size, &at, GLB_JSON, json, error);
    if (status == AWT_OK) {
        status = take_chunk(bytes, size, &at, GLB_BINARY, binary, error);
    }
    if (status == AWT_OK && (at != size || load_u32(bytes + 8) != size)) {
        return error_set(error, AWT_BAD_FORMAT, "the frame has bytes after its end");
    }
    return status;
}

bool glb_read_pose(const json_document *json, uint32_t node, awt_pose *head)
{
    double *q = head->orientation;
    if (!json_reals(json, json_member(json, node, "translation"), 3, head->position) ||
        !json_reals(json, json_member(json, node, "rotation"), 4, q)) {
        return false;
    }
    double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    return fabs(square - 1.0) < 1e-3;
}

bool glb_read_time(const json_document *json, int64_t *time_us)
{
    double time;
    uint32_t extras = json_member(json, json_member(json, 0, "asset"), "extras");
    if (!json_real(json, json_member(json, extras, "time_us"), &time) || fabs(time) > GLB_MAX_TIME_US) {
        return false;
    }
    *time_us = (int64_t)time;
    return (double)*time_us == time;
}
