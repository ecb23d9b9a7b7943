/* keeper.c: see keeper.h. */
#include "keeper.h"
#include "log.h"
#include "metrics.h"
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
    errand *lost; /* without bytes */
    uint64_t waiting_bytes;
    bool busy, stopping;
    bool forgot; /* there was no memory to remember that a file is to go */
    keeper_counts counts;
    pthread_t thread;
    bool in_trouble; /* the thread's own: what it tried last has failed */
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

/* What helps against it. */
static const char *advice(int why)
{
    switch (why) {
    case ENOSPC:
    case EFBIG:
    case EDQUOT:
        return "make room there";
    case EROFS:
    case EACCES:
    case EPERM:
        return "let awtd write there";
    case ENOENT:
    case ENOTDIR:
    case EISDIR:
        return "put the folder back";
    default:
        return "look at the disk";
    }
}

static bool run(keeper *k, const errand *e)
{
    bool done = e->bytes ? vault_write(&k->place, e->handle, e->bytes, e->size) : vault_remove(&k->place, e->handle);
    const int why = errno;
    char folder[LOG_QUOTED];
    log_quote(k->place.folder, strlen(k->place.folder), folder);
    if (!done) {
        log_write(LOG_ERROR, e->bytes ? "forest not saved" : "file of a forest not removed",
                  "forest=%016" PRIx64 " folder=%s why=\"%s\" do=\"%s: the next round tries again\"", e->handle, folder,
                  strerror(why), advice(why));
    } else if (k->in_trouble) {
        log_write(LOG_INFO, "forests can be saved again", "folder=%s", folder);
    }
    k->in_trouble = !done;
    return done;
}

/* Takes the errand. */
static void note(keeper *k, errand *e, bool done)
{
    if (done && e->bytes) {
        k->counts.written++;
        k->counts.bytes += e->size;
        k->counts.last_written_us = k->clock_us();
    } else if (done) {
        k->counts.removed++;
    }
    metrics_count(METRIC_SAVES, done && e->bytes);
    free(e->bytes);
    if (done) {
        free(e);
        return;
    }
    metrics_count(METRIC_SAVES_FAILED, 1);
    k->counts.failed++;
    k->counts.lost++;
    *e = (errand){.next = k->lost, .handle = e->handle};
    k->lost = e;
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
    while (keeper_take_lost(k) != 0) {
    }
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
        k->forgot = true;
        k->counts.failed++;
    }
    pthread_mutex_unlock(&k->mutex);
}

void keeper_set_aside(keeper *k, uint64_t handle)
{
    vault_set_aside(&k->place, handle);
}

uint64_t keeper_take_lost(keeper *k)
{
    pthread_mutex_lock(&k->mutex);
    errand *e = k->lost;
    const uint64_t handle = e ? e->handle : 0;
    if (e) {
        k->lost = e->next;
        k->counts.lost--;
    }
    pthread_mutex_unlock(&k->mutex);
    free(e);
    return handle;
}

bool keeper_drain(keeper *k)
{
    pthread_mutex_lock(&k->mutex);
    while (k->first || k->busy) {
        pthread_cond_wait(&k->changed, &k->mutex);
    }
    const bool clean = !k->lost && !k->forgot;
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
