/* nodes_read.c: frames of nodes read back: exactly the shape that ours have, and every number checked. */
#include "geom/receive.h"

#include "base/bytes.h"
#include "base/error.h"
#include "geom/glb_container.h"
#include "geom/nodes_record.h"

#include <math.h>
#include <stdlib.h>

static bool member_is(const json_document *json, uint32_t object, const char *name, uint32_t expected)
{
    uint32_t value, member = json_member(json, object, name);
    if (member == JSON_NONE) {
        return expected == 0; /* what a writer may leave out */
    }
    return json_whole(json, member, &value) && value == expected;
}

/* Number of nodes; 0: this is no frame of nodes, or its records are not where they belong. */
static uint32_t find_records(const json_document *json, size_t binary_size)
{
    const uint32_t node = json_member(json, 0, "nodes") + 1, views = json_member(json, 0, "bufferViews");
    uint32_t count;
    if (json_items(json, json_member(json, 0, "nodes")) != 1 || json_items(json, views) != 2) {
        return 0;
    }
    const uint32_t extras = json_member(json, node, "extras");
    if (!json_is_text(json, json_member(json, extras, "kind"), "nodes") ||
        !json_whole(json, json_member(json, extras, "nodes"), &count) || count < 1 || count > AWT_MAX_NODES ||
        (uint64_t)count * (NODE_BYTES + NODE_LINE_BYTES) > binary_size) {
        return 0;
    }
    const uint32_t records = views + 1;
    bool there = member_is(json, records, "buffer", 0) && member_is(json, records, "byteOffset", 0) &&
                 member_is(json, records, "byteStride", NODE_BYTES) &&
                 member_is(json, records, "byteLength", count * NODE_BYTES);
    return there ? count : 0;
}

static bool take_node(const unsigned char *at, uint32_t index, awt_node *out)
{
    const float parent = load_f32(at + NODE_PARENT);
    bool sound = parent >= 0 && parent <= (float)index;
    out->radius_m = load_f32(at + NODE_RADIUS);
    out->level = at[NODE_LEVEL];
    for (int k = 0; k < 3; k++) {
        out->position[k] = load_f32(at + 4 * k);
        sound = sound && isfinite(out->position[k]);
    }
    out->parent = sound ? (uint32_t)parent : 0;
    return sound && (float)out->parent == parent && out->radius_m >= 0 && isfinite(out->radius_m) &&
           out->level < AWT_MAX_LEVELS;
}

static awt_status read_nodes(const json_document *json, const glb_chunk *binary, geom_nodes *out, awt_error *error)
{
    const uint32_t count = find_records(json, binary->size);
    if (count == 0) {
        return error_set(error, AWT_BAD_FORMAT, "this is no frame of nodes, or it does not hold those it announces");
    }
    if (!glb_read_pose(json, json_member(json, 0, "nodes") + 1, &out->head) || !glb_read_time(json, &out->time_us)) {
        return error_set(error, AWT_BAD_VALUE, "the frame's head pose or time is missing or impossible");
    }
    out->nodes = calloc(count, sizeof *out->nodes);
    if (!out->nodes) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    out->count = count;
    for (uint32_t i = 0; i < count; i++) {
        if (!take_node(binary->bytes + (size_t)i * NODE_BYTES, i, &out->nodes[i])) {
            return error_set(error, AWT_BAD_VALUE, "node %u of the frame is impossible", i);
        }
    }
    return AWT_OK;
}

awt_status geom_read_nodes(const void *bytes, size_t size, geom_nodes *out, awt_error *error)
{
    glb_chunk text, binary;
    json_document json = {0};
    geom_nodes nodes = {0};
    awt_status status = glb_container_take(bytes, size, &text, &binary, error);
    if (status == AWT_OK) {
        status = json_read((const char *)text.bytes, text.size, &json, error);
    }
    if (status == AWT_OK) {
        status = read_nodes(&json, &binary, &nodes, error);
    }
    json_fini(&json);
    if (status != AWT_OK) {
        geom_nodes_fini(&nodes);
        return status;
    }
    *out = nodes;
    return AWT_OK;
}

void geom_nodes_fini(geom_nodes *nodes)
{
    free(nodes->nodes);
    *nodes = (geom_nodes){0};
}
