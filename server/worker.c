/* worker.c: see worker.h. */
#include "worker.h"
#include "base/assert.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>

typedef struct job_list {
    job *first, *last;
} job_list;

struct worker_pool {
    pthread_mutex_t mutex; /* guards the lists and `stopping` */
    pthread_cond_t waiting_grew;
    job_list waiting, done;
    bool stopping;
    void (*wake)(void *context);
    void *context;
    unsigned count;
    pthread_t threads[];
};

static void list_append(job_list *list, job *work)
{
    work->next = NULL;
    if (list->last) {
        list->last->next = work;
    } else {
        list->first = work;
    }
    list->last = work;
}

static job *list_take_first(job_list *list)
{
    job *work = list->first;
    if (work) {
        list->first = work->next;
        list->last = list->first ? list->last : NULL;
    }
    return work;
}

static void pool_run(worker_pool *pool, job *work)
{
    work->run(work);
    pthread_mutex_lock(&pool->mutex);
    list_append(&pool->done, work);
    pthread_mutex_unlock(&pool->mutex);
    pool->wake(pool->context);
}

static void *worker_main(void *argument)
{
    worker_pool *pool = argument;
    for (;;) {
        pthread_mutex_lock(&pool->mutex);
        while (!pool->stopping && !pool->waiting.first) {
            pthread_cond_wait(&pool->waiting_grew, &pool->mutex);
        }
        job *work = pool->stopping ? NULL : list_take_first(&pool->waiting);
        pthread_mutex_unlock(&pool->mutex);
        if (!work) {
            return NULL;
        }
        pool_run(pool, work);
    }
}

/* Signals belong to the main thread: threads inherit the mask that stands while they are made. */
static bool start_threads(worker_pool *pool, unsigned count)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    while (pool->count < count && pthread_create(&pool->threads[pool->count], NULL, worker_main, pool) == 0) {
        pool->count++;
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return pool->count == count;
}

worker_pool *worker_pool_create(unsigned count, void (*wake)(void *context), void *context)
{
    worker_pool *pool = calloc(1, sizeof *pool + count * sizeof pool->threads[0]);
    if (!pool) {
        return NULL;
    }
    pool->wake = wake;
    pool->context = context;
    if (pthread_mutex_init(&pool->mutex, NULL) != 0) {
        free(pool);
        return NULL;
    }
    if (pthread_cond_init(&pool->waiting_grew, NULL) != 0) {
        pthread_mutex_destroy(&pool->mutex);
        free(pool);
        return NULL;
    }
    if (!start_threads(pool, count)) {
        worker_pool_destroy(pool);
        return NULL;
    }
    return pool;
}

void worker_pool_destroy(worker_pool *pool)
{
    if (!pool) {
        return;
    }
    pthread_mutex_lock(&pool->mutex);
    pool->stopping = true;
    pthread_cond_broadcast(&pool->waiting_grew);
    pthread_mutex_unlock(&pool->mutex);
    for (unsigned i = 0; i < pool->count; i++) {
        pthread_join(pool->threads[i], NULL);
    }
    pthread_cond_destroy(&pool->waiting_grew);
    pthread_mutex_destroy(&pool->mutex);
    free(pool);
}

unsigned worker_pool_count(const worker_pool *pool)
{
    return pool->count;
}

void worker_pool_submit(worker_pool *pool, job *work)
{
    ASSERT(work->run);
    pthread_mutex_lock(&pool->mutex);
    list_append(&pool->waiting, work);
    pthread_cond_signal(&pool->waiting_grew);
    pthread_mutex_unlock(&pool->mutex);
}

job *worker_pool_take_done(worker_pool *pool)
{
    pthread_mutex_lock(&pool->mutex);
    job *first = pool->done.first;
    pool->done = (job_list){0};
    pthread_mutex_unlock(&pool->mutex);
    return first;
}

bool worker_pool_run_one(worker_pool *pool)
{
    pthread_mutex_lock(&pool->mutex);
    job *work = list_take_first(&pool->waiting);
    pthread_mutex_unlock(&pool->mutex);
    if (work) {
        pool_run(pool, work);
    }
    return work != NULL;
}
