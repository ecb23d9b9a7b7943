/* groom_cache.c: see groom_cache.h. */
#include "groom_cache.h"
#include "base/assert.h"
#include "metrics.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

typedef struct cached_groom {
    made_groom made; /* first: what callers hold */
    struct cached_groom *next;
    uint32_t users;
    char key[GROOM_KEY];
} cached_groom;

struct groom_cache {
    pthread_mutex_t mutex;
    cached_groom *first; /* the one that was used last is the first */
    uint64_t bytes, unused_bytes, spare_bytes;
};

groom_cache *groom_cache_create(uint64_t spare_bytes)
{
    groom_cache *cache = calloc(1, sizeof *cache);
    if (cache && pthread_mutex_init(&cache->mutex, NULL) != 0) {
        free(cache);
        return NULL;
    }
    if (cache) {
        cache->spare_bytes = spare_bytes;
    }
    return cache;
}

static void drop(groom_cache *cache, cached_groom **link)
{
    cached_groom *dropped = *link;
    ASSERT(dropped->users == 0);
    *link = dropped->next;
    cache->bytes -= dropped->made.bytes;
    cache->unused_bytes -= dropped->made.bytes;
    metrics_add(METRIC_HAIR_BYTES, -(int64_t)dropped->made.bytes);
    awt_groom_destroy(dropped->made.groom);
    free(dropped);
}

void groom_cache_destroy(groom_cache *cache)
{
    if (!cache) {
        return;
    }
    while (cache->first) {
        drop(cache, &cache->first);
    }
    pthread_mutex_destroy(&cache->mutex);
    free(cache);
}

/* One user more; NULL: no groom of that key. */
static const made_groom *use(groom_cache *cache, const char *key)
{
    for (cached_groom **link = &cache->first; *link; link = &(*link)->next) {
        cached_groom *found = *link;
        if (strcmp(found->key, key) == 0) {
            cache->unused_bytes -= found->users++ == 0 ? found->made.bytes : 0;
            *link = found->next;
            found->next = cache->first;
            cache->first = found;
            return &found->made;
        }
    }
    return NULL;
}

const made_groom *groom_cache_find(groom_cache *cache, const char *key)
{
    pthread_mutex_lock(&cache->mutex);
    const made_groom *found = use(cache, key);
    pthread_mutex_unlock(&cache->mutex);
    return found;
}

const made_groom *groom_cache_add(groom_cache *cache, const char *key, const made_groom *made)
{
    cached_groom *added = calloc(1, sizeof *added);
    pthread_mutex_lock(&cache->mutex);
    const made_groom *used = use(cache, key);
    if (!used && added) {
        *added = (cached_groom){.made = *made, .next = cache->first, .users = 1};
        ASSERT(strlen(key) < sizeof added->key);
        strcpy(added->key, key);
        cache->first = added;
        cache->bytes += made->bytes;
        metrics_add(METRIC_HAIR_BYTES, (int64_t)made->bytes);
        used = &added->made;
    }
    pthread_mutex_unlock(&cache->mutex);
    if (!added || used != &added->made) {
        awt_groom_destroy(made->groom);
        free(added);
    }
    return used;
}

/* Those that were used longest ago go first. */
static void make_room(groom_cache *cache)
{
    while (cache->unused_bytes > cache->spare_bytes) {
        cached_groom **oldest = NULL;
        for (cached_groom **link = &cache->first; *link; link = &(*link)->next) {
            oldest = (*link)->users == 0 ? link : oldest;
        }
        drop(cache, oldest);
    }
}

void groom_cache_release(groom_cache *cache, const made_groom *used)
{
    pthread_mutex_lock(&cache->mutex);
    for (cached_groom *found = cache->first; found; found = found->next) {
        if (&found->made == used) {
            ASSERT(found->users > 0);
            cache->unused_bytes += --found->users == 0 ? used->bytes : 0;
        }
    }
    make_room(cache);
    pthread_mutex_unlock(&cache->mutex);
}

uint64_t groom_cache_bytes(groom_cache *cache)
{
    pthread_mutex_lock(&cache->mutex);
    const uint64_t bytes = cache->bytes;
    pthread_mutex_unlock(&cache->mutex);
    return bytes;
}
