/* saved.h: a forest as it stands in a file of the state directory: its snapshot, and what the daemon itself knows of
 * it: handle, tokens, name, and how far its frames and motions have come. One file restores it as if the daemon had
 * never stopped.
 *
 *   magic "AWTF", u32 version, u32 CRC32C of all that follows; then the fields of `saved` in their order, then the
 *   snapshot (awt_forest_snapshot) to the end. Little-endian. */
#ifndef SAVED_H
#define SAVED_H

#include "recipe.h"
#include "registry.h"

typedef struct saved {
    uint64_t handle;
    uint8_t drive_token[REGISTRY_TOKEN_SIZE], view_token[REGISTRY_TOKEN_SIZE];
    char name[RECIPE_NAME];
    uint64_t sequence;                      /* of its latest frame */
    uint32_t motion_epoch, motion_sequence; /* of the last MOTION taken */
    int64_t motion_us;
    bool moved;
    uint64_t hash;     /* of the state, as awt_forest_hash says */
    size_t state_size; /* the snapshot */
    const void *state; /* in the bytes that it was read from */
} saved;

/* Bytes that saved_write writes. */
size_t saved_size(const saved *s);
/* Writes all, the snapshot included, into bytes[0 .. saved_size - 1]. */
void saved_write(const saved *s, void *bytes);
/* Reads it from bytes that may be anything. AWT_BAD_FORMAT (no such file, or of another version), AWT_TRUNCATED,
 * AWT_BAD_VALUE (damaged). The snapshot is not looked into. */
awt_status saved_read(const void *bytes, size_t size, saved *out, awt_error *error);

#endif
