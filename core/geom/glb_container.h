/* glb_container.h: what every GLB of ours has: two chunks, a head's pose and a time; read from a source that need not
 * be trusted. */
#ifndef GEOM_GLB_CONTAINER_H
#define GEOM_GLB_CONTAINER_H

#include "geom/json.h"
#include "geom/read.h"

typedef struct glb_chunk {
    const unsigned char *bytes; /* in the file */
    size_t size;
} glb_chunk;

/* The file's two chunks, after which nothing may follow. AWT_BAD_FORMAT, AWT_TRUNCATED, AWT_LIMIT. */
awt_status glb_container_take(const unsigned char *bytes, size_t size, glb_chunk *json, glb_chunk *binary,
                              awt_error *error);

/* The pose of a node with translation and rotation; the rotation of length 1. */
bool glb_read_pose(const json_document *json, uint32_t node, awt_pose *head);
/* asset.extras.time_us. */
bool glb_read_time(const json_document *json, int64_t *time_us);

#endif
