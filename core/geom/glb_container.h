/* glb_container.h: what every GLB of ours has, read from a source that need not be trusted: the two chunks, the head's
 * pose and the time. */
#ifndef GEOM_GLB_CONTAINER_H
#define GEOM_GLB_CONTAINER_H

#include "geom/json.h"

typedef struct glb_chunk {
    const unsigned char *bytes;
    size_t size;
} glb_chunk;

/* Checks the lengths against what is there. AWT_BAD_FORMAT, AWT_TRUNCATED, AWT_LIMIT. */
awt_status glb_container_read(const unsigned char *bytes, size_t size, glb_chunk *json, glb_chunk *binary,
                              awt_error *error);

/* A node's translation and rotation. False: they are missing, or impossible. */
bool glb_container_pose(const json_document *json, uint32_t node, awt_pose *head);
/* The time in asset.extras. */
bool glb_container_time(const json_document *json, int64_t *time_us);

#endif
