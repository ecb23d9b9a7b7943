/* keeper.c: see keeper.h. */
#include "keeper.h"
#include "log.h"
#include "thread.h"

#include <errno.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

/* What is to become of one forest's file. */
typedef struct errand {
    struct errand *next;
    uint64_t handle;
    unsigned char *bytes; /* heap; NULL: the file is to go */
    size_t size;
} errand;

struct keeper {
    vault place;
    int64_t (*clock_us)(void);
    pthread_mutex_t mutex; /* guards all that follows */
    pthread_cond_t changed;
    errand *first, **end;
    uint64_t waiting_bytes;
    bool busy, stopping, failed;
    keeper_counts counts;
    pthread_t thread;
};

/* ---- the thread -------------------------------------------------------------------------------------------------- */

static errand *take_first(keeper *k)
{
    errand *e = k->first;
    k->first = e->next;
    k->end = k->first ? k->end : &k->first;
    k->waiting_bytes -= e->size;
    k->counts.waiting--;
    return e;
}

static bool run(const keeper *k, const errand *e)
{
    bool done = e->bytes ? vault_write(&k->place, e->handle, e->bytes, e->size) : vault_remove(&k->place, e->handle);
    if (!done) {
        log_write(LOG_ERROR, "forest not saved", "forest=%016" PRIx64 " folder=%s why=\"%s\"", e->handle,
                  k->place.folder, strerror(errno));
    }
    return done;
}

static void note(keeper *k, const errand *e, bool done)
{
    k->failed = k->failed || !done;
    k->counts.failed += !done;
    if (done && e->bytes) {
        k->counts.written++;
        k->counts.bytes += e->size;
        k->counts.last_written_us = k->clock_us();
    } else if (done) {
        k->counts.removed++;
    }
}

static void *keeper_main(void *argument)
{
    keeper *k = argument;
    pthread_mutex_lock(&k->mutex);
    while (k->first || !k->stopping) {
        if (!k->first) {
            pthread_cond_wait(&k->changed, &k->mutex);
            continue;
        }
        errand *e = take_first(k);
        k->busy = true;
        pthread_mutex_unlock(&k->mutex);
        bool done = run(k, e);
        pthread_mutex_lock(&k->mutex);
        k->busy = false;
        note(k, e, done);
        free(e->bytes);
        free(e);
        pthread_cond_broadcast(&k->changed);
    }
    pthread_mutex_unlock(&k->mutex);
    return NULL;
}

keeper *keeper_create(const vault *v, int64_t (*clock_us)(void))
{
    keeper *k = calloc(1, sizeof *k);
    if (!k) {
        return NULL;
    }
    k->place = *v;
    k->clock_us = clock_us;
    k->end = &k->first;
    if (pthread_mutex_init(&k->mutex, NULL) != 0) {
        free(k);
        return NULL;
    }
    if (pthread_cond_init(&k->changed, NULL) != 0) {
        pthread_mutex_destroy(&k->mutex);
        free(k);
        return NULL;
    }
    if (!thread_start(&k->thread, keeper_main, k)) {
        pthread_cond_destroy(&k->changed);
        pthread_mutex_destroy(&k->mutex);
        free(k);
        return NULL;
    }
    return k;
}

void keeper_destroy(keeper *k)
{
    if (!k) {
        return;
    }
    pthread_mutex_lock(&k->mutex);
    k->stopping = true;
    pthread_cond_broadcast(&k->changed);
    pthread_mutex_unlock(&k->mutex);
    pthread_join(k->thread, NULL);
    pthread_cond_destroy(&k->changed);
    pthread_mutex_destroy(&k->mutex);
    free(k);
}

/* ---- errands ----------------------------------------------------------------------------------------------------- */

static errand *find(keeper *k, uint64_t handle)
{
    for (errand *e = k->first; e; e = e->next) {
        if (e->handle == handle) {
            return e;
        }
    }
    return NULL;
}

/* What waits of that forest, or a new errand at the end. NULL: no memory. */
static errand *errand_of(keeper *k, uint64_t handle)
{
    errand *e = find(k, handle);
    if (!e && (e = calloc(1, sizeof *e)) != NULL) {
        e->handle = handle;
        *k->end = e;
        k->end = &e->next;
        k->counts.waiting++;
    }
    return e;
}

static void replace(keeper *k, errand *e, unsigned char *bytes, size_t size)
{
    free(e->bytes);
    k->waiting_bytes += size - e->size;
    e->bytes = bytes;
    e->size = size;
    pthread_cond_broadcast(&k->changed);
}

bool keeper_write(keeper *k, uint64_t handle, unsigned char *bytes, size_t size)
{
    pthread_mutex_lock(&k->mutex);
    const errand *before = find(k, handle);
    const uint64_t waiting = k->waiting_bytes - (before ? before->size : 0);
    errand *e = waiting + size <= LIMIT_KEEPER_BYTES ? errand_of(k, handle) : NULL;
    if (e) {
        replace(k, e, bytes, size);
    } else {
        k->counts.refused++;
        free(bytes);
    }
    pthread_mutex_unlock(&k->mutex);
    return e != NULL;
}

void keeper_remove(keeper *k, uint64_t handle)
{
    pthread_mutex_lock(&k->mutex);
    errand *e = errand_of(k, handle);
    if (e) {
        replace(k, e, NULL, 0);
    } else {
        k->failed = true;
        k->counts.failed++;
    }
    pthread_mutex_unlock(&k->mutex);
}

void keeper_set_aside(keeper *k, uint64_t handle)
{
    vault_set_aside(&k->place, handle);
}

bool keeper_drain(keeper *k)
{
    pthread_mutex_lock(&k->mutex);
    while (k->first || k->busy) {
        pthread_cond_wait(&k->changed, &k->mutex);
    }
    bool clean = !k->failed;
    k->failed = false;
    pthread_mutex_unlock(&k->mutex);
    return clean;
}

keeper_counts keeper_count(keeper *k)
{
    pthread_mutex_lock(&k->mutex);
    keeper_counts counts = k->counts;
    pthread_mutex_unlock(&k->mutex);
    return counts;
}
