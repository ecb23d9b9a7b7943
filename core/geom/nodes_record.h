/* nodes_record.h: one node in the binary chunk of a frame of nodes:
 *
 *   f32 position[3] | f32 radius | f32 parent's number | u8 level | u8 0[3]
 *
 * A parent's number is a float because glTF keeps 32-bit whole numbers from attributes; it is below 2^24, so exact.
 * Behind the records stand the lines' indices: u32 node, u32 parent, for each node in order. */
#ifndef GEOM_NODES_RECORD_H
#define GEOM_NODES_RECORD_H

enum {
    NODE_RADIUS = 12, /* byte offsets */
    NODE_PARENT = 16,
    NODE_LEVEL = 20,
    NODE_BYTES = 24,
    NODE_LINE_BYTES = 8
};

#endif
