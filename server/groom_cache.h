/* groom_cache.h: grooms that several forests share. What a groom is made of is its key: forests made of the same style
 * or file, with the same figures, stand on one groom, which never changes.
 *
 * A groom that no forest stands on any more is kept for the next one, within a bound. All calls are for any thread; the
 * cache has a lock of its own, within which no other is taken. */
#ifndef GROOM_CACHE_H
#define GROOM_CACHE_H

#include "awt.h"

enum { GROOM_KEY = 512 /* bytes, with the NUL */ };

typedef struct groom_cache groom_cache;

/* A groom, and what was found out while it was made. */
typedef struct made_groom {
    awt_groom *groom;
    awt_rebuilt rebuilt;
    uint32_t skipped_strands;
    awt_placement placement; /* as it was taken */
    uint64_t bytes;
} made_groom;

/* Keeps up to `spare_bytes` of grooms that nobody uses. NULL: no memory. */
groom_cache *groom_cache_create(uint64_t spare_bytes);
/* Nobody may use a groom of it any more. Accepts NULL. */
void groom_cache_destroy(groom_cache *cache);

/* The groom of that key, in use until groom_cache_release; NULL: there is none. */
const made_groom *groom_cache_find(groom_cache *cache, const char *key);
/* Takes a groom that was just made; in use until groom_cache_release. Where somebody else made the same meanwhile,
 * theirs comes back and this one is freed. NULL: no memory; it is freed then too. */
const made_groom *groom_cache_add(groom_cache *cache, const char *key, const made_groom *made);
void groom_cache_release(groom_cache *cache, const made_groom *used);

/* Bytes of all its grooms, used or not. */
uint64_t groom_cache_bytes(groom_cache *cache);

#endif
