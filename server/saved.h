/* saved.h: a forest as it stands in a file of the state directory: its snapshot, and what the daemon itself knows of
 * it: handle, tokens, name, whose it is, how its time goes, and how far its frames have come. One file restores it as
 * if the daemon had never stopped.
 *
 *   magic "AWTF", u32 version, u32 CRC32C of all that follows; then the fields of `saved` in their order, then the
 *   snapshot (awt_forest_snapshot) to the end. Little-endian. */
#ifndef SAVED_H
#define SAVED_H

#include "accounts.h"
#include "recipe.h"
#include "sim_clock.h"

enum { SAVED_TOKEN_SIZE = 16 };

typedef struct saved {
    uint64_t handle;
    uint8_t drive_token[SAVED_TOKEN_SIZE], view_token[SAVED_TOKEN_SIZE];
    char name[RECIPE_NAME], account[ACCOUNT_NAME];
    uint32_t mode; /* a clock_mode; this and the next two: SET_CLOCK's */
    double rate;
    float importance;
    uint64_t sequence; /* of its latest frame */
    uint64_t hash;     /* of the state, as awt_forest_hash says */
    size_t state_size; /* the snapshot */
    const void *state; /* in the bytes that it was read from; not looked at in writing */
} saved;

/* Bytes of the whole file. */
size_t saved_size(const saved *s);
/* Where in them the snapshot has its place. */
unsigned char *saved_state(const saved *s, void *bytes);
/* Writes all the rest of bytes[0 .. saved_size - 1]; the snapshot must stand in its place already. */
void saved_write(const saved *s, void *bytes);
/* Reads it from bytes that may be anything. AWT_BAD_FORMAT (no such file, or of another version), AWT_TRUNCATED,
 * AWT_BAD_VALUE (damaged). The snapshot is not looked into. */
awt_status saved_read(const void *bytes, size_t size, saved *out, awt_error *error);

#endif
