/* nodes.c: active AWT nodes as a GLB, for overlays and for debugging.
 *
 * Lines, a node to its parent, uncompressed: any glTF viewer draws the trees, any loader hands over radius, level and
 * parent, and a few hundred nodes are not worth a decoder. Their number changes from frame to frame, so each frame's
 * JSON is written anew. */
#include "geom/encode.h"

#include "base/bytes.h"
#include "base/error.h"
#include "geom/glb_shim.h"
#include "geom/head_pose.h"
#include "geom/nodes_record.h"

#include <math.h>
#include <stdlib.h>

static bool node_finite(const awt_node *node)
{
    return isfinite(node->position[0]) && isfinite(node->position[1]) && isfinite(node->position[2]) &&
           isfinite(node->radius_m);
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

/* Records, lines and bounds. False: a node is not finite. */
static bool fill(const awt_node *nodes, uint32_t count, unsigned char *binary, glb_lines *lines)
{
    unsigned char *line = binary + (size_t)count * NODE_BYTES;
    for (uint32_t i = 0; i < count; i++, line += NODE_LINE_BYTES) {
        if (!node_finite(&nodes[i])) {
            return false;
        }
        put_node(&nodes[i], binary + (size_t)i * NODE_BYTES);
        store_u32(line, i);
        store_u32(line + 4, nodes[i].parent);
        for (int k = 0; k < 3; k++) {
            const float value = nodes[i].position[k];
            lines->min[k] = i == 0 || value < lines->min[k] ? value : lines->min[k];
            lines->max[k] = i == 0 || value > lines->max[k] ? value : lines->max[k];
        }
    }
    return true;
}

awt_status geom_encode_nodes(const awt_node *nodes, uint32_t count, const awt_pose *head, int64_t time_us,
                             geom_buffer *out, awt_error *error)
{
    glb_lines lines = {.count = count,
                       .stride = NODE_BYTES,
                       .binary_size = (size_t)count * (NODE_BYTES + NODE_LINE_BYTES),
                       .time_us = time_us};
    if (count < 1 || count > AWT_MAX_NODES) {
        return error_set(error, AWT_BAD_VALUE, "a frame holds 1 to %d nodes, not %u", AWT_MAX_NODES, count);
    }
    awt_status status = head_pose_take(head, &lines.head, error);
    if (status != AWT_OK) {
        return status;
    }
    unsigned char *binary = malloc(lines.binary_size);
    if (!binary) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    out->size = 0;
    lines.binary = binary;
    status = fill(nodes, count, binary, &lines) ? glb_shim_write_lines(&lines, out, error)
                                                : error_set(error, AWT_BAD_VALUE, "a node is not finite");
    free(binary);
    return status;
}
