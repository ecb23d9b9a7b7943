/* nodes.c: active AWT nodes as a GLB, for overlays and for debugging.
 *
 * Lines, a node to its parent, uncompressed: any glTF viewer draws the trees, any loader hands over radius, level and
 * parent, and a few hundred nodes are not worth a decoder. Their number changes from frame to frame, so each frame's
 * JSON is put together anew; it is short. */
#include "geom/encode.h"

#include "base/bytes.h"
#include "base/error.h"
#include "geom/buffer.h"
#include "geom/glb_text.h"
#include "geom/head_pose.h"
#include "geom/nodes_record.h"

#include <math.h>
#include <string.h>

/* Least and greatest of the positions. */
typedef struct nodes_box {
    double min[3], max[3];
} nodes_box;

static bool node_finite(const awt_node *node)
{
    return isfinite(node->position[0]) && isfinite(node->position[1]) && isfinite(node->position[2]) &&
           isfinite(node->radius_m);
}

/* False: a node is not finite. */
static bool measure(const awt_node *nodes, uint32_t count, nodes_box *box)
{
    for (uint32_t i = 0; i < count; i++) {
        if (!node_finite(&nodes[i])) {
            return false;
        }
        for (int k = 0; k < 3; k++) {
            const double value = (double)nodes[i].position[k];
            box->min[k] = i == 0 || value < box->min[k] ? value : box->min[k];
            box->max[k] = i == 0 || value > box->max[k] ? value : box->max[k];
        }
    }
    return true;
}

/* The accessors of a record's fields, and of the lines' indices. */
static void put_accessors(glb_text *t, uint32_t count, const nodes_box *box)
{
    glb_text_format(t,
                    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":%u,\"type\":\"VEC3\","
                    "\"min\":[",
                    count);
    glb_text_reals(t, box->min, 3);
    glb_text_put(t, "],\"max\":[");
    glb_text_reals(t, box->max, 3);
    glb_text_put(t, "]},");
    static const struct {
        int offset, type;
    } fields[] = {{NODE_RADIUS, 5126 /* float */}, {NODE_PARENT, 5126}, {NODE_LEVEL, 5121 /* unsigned byte */}};
    for (size_t k = 0; k < sizeof fields / sizeof fields[0]; k++) {
        glb_text_format(t,
                        "{\"bufferView\":0,\"byteOffset\":%d,\"componentType\":%d,\"count\":%u,"
                        "\"type\":\"SCALAR\"},",
                        fields[k].offset, fields[k].type, count);
    }
    glb_text_format(t, "{\"bufferView\":1,\"componentType\":5125,\"count\":%u,\"type\":\"SCALAR\"}],", 2 * count);
}

/* Records are vertices, lines their indices. */
static void put_views(glb_text *t, uint32_t records, uint32_t lines)
{
    glb_text_format(t,
                    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":%u,\"byteStride\":%d,\"target\":34962},"
                    "{\"buffer\":0,\"byteOffset\":%u,\"byteLength\":%u,\"target\":34963}],"
                    "\"buffers\":[{\"byteLength\":%u}]}",
                    records, NODE_BYTES, records, lines, records + lines);
}

static void put_json(glb_text *t, uint32_t count, const nodes_box *box, const awt_pose *head, int64_t time_us)
{
    glb_text_scene(t, time_us);
    glb_text_put(t, "\"nodes\":[{\"name\":\"hair\",\"mesh\":0,");
    glb_text_pose(t, head);
    glb_text_format(t,
                    ",\"extras\":{\"kind\":\"nodes\",\"nodes\":%u}}],"
                    "\"meshes\":[{\"name\":\"hair\",\"primitives\":[{\"mode\":1,\"indices\":4,\"attributes\":"
                    "{\"POSITION\":0,\"_RADIUS\":1,\"_PARENT\":2,\"_LEVEL\":3}}]}],",
                    count);
    put_accessors(t, count, box);
    put_views(t, count * NODE_BYTES, count * NODE_LINE_BYTES);
}

static void put_node(const awt_node *node, unsigned char *at)
{
    memset(at, 0, NODE_BYTES);
    for (int k = 0; k < 3; k++) {
        store_f32(at + 4 * k, node->position[k]);
    }
    store_f32(at + NODE_RADIUS, node->radius_m);
    store_f32(at + NODE_PARENT, (float)node->parent);
    at[NODE_LEVEL] = (unsigned char)node->level;
}

awt_status geom_encode_nodes(const awt_node *nodes, uint32_t count, const awt_pose *head, int64_t time_us,
                             geom_buffer *out, awt_error *error)
{
    awt_pose pose;
    nodes_box box = {{0}, {0}};
    if (count < 1 || count > AWT_MAX_NODES) {
        return error_set(error, AWT_BAD_VALUE, "a frame holds 1 to %d nodes, not %u", AWT_MAX_NODES, count);
    }
    awt_status status = head_pose_take(head, &pose, error);
    if (status == AWT_OK && !measure(nodes, count, &box)) {
        status = error_set(error, AWT_BAD_VALUE, "a node is not finite");
    }
    glb_text text = {.size = 0};
    if (status == AWT_OK) {
        put_json(&text, count, &box, &pose, time_us);
        status = glb_text_begin(&text, 0, out, error);
    }
    const size_t binary = out->size;
    unsigned char *record;
    if (status == AWT_OK) {
        status = geom_buffer_extend(out, (size_t)count * (NODE_BYTES + NODE_LINE_BYTES), &record, error);
    }
    if (status != AWT_OK) {
        return status;
    }
    unsigned char *line = record + (size_t)count * NODE_BYTES;
    for (uint32_t i = 0; i < count; i++, record += NODE_BYTES, line += NODE_LINE_BYTES) {
        put_node(&nodes[i], record);
        store_u32(line, i);
        store_u32(line + 4, nodes[i].parent);
    }
    glb_text_end(binary, out);
    return AWT_OK;
}
