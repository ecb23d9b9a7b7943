/* worker_pool.c: see worker.h: the life of a pool. */
#include "worker_insides.h"
#include "thread.h"

#include <stdlib.h>
#include <time.h>

static unsigned builders_for(unsigned workers)
{
    return (workers + 1) / 2;
}

static bool start_threads(worker_pool *pool)
{
    const unsigned count = pool->def.workers + builders_for(pool->def.workers);
    bool started = true;
    while (started && pool->started < count) {
        worker *w = &pool->threads[pool->started];
        *w = (worker){.pool = pool, .number = pool->started + 1};
        started = thread_start(&w->thread, w->number > pool->def.workers ? builder_main : worker_main, w);
        pool->started += started;
    }
    return started;
}

/* A condition whose timed waits go by the monotonic clock. */
static bool init_condition(pthread_cond_t *condition)
{
    pthread_condattr_t monotonic;
    if (pthread_condattr_init(&monotonic) != 0) {
        return false;
    }
    const bool made =
        pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC) == 0 && pthread_cond_init(condition, &monotonic) == 0;
    pthread_condattr_destroy(&monotonic);
    return made;
}

enum { CONDITIONS = 4 };

static pthread_cond_t *condition_at(worker_pool *pool, int k)
{
    pthread_cond_t *conditions[CONDITIONS] = {&pool->called, &pool->relieved, &pool->build, &pool->together};
    return conditions[k];
}

static bool init_waiting(worker_pool *pool)
{
    int made = 0;
    if (pthread_mutex_init(&pool->mutex, NULL) != 0) {
        return false;
    }
    while (made < CONDITIONS && init_condition(condition_at(pool, made))) {
        made++;
    }
    if (made == CONDITIONS) {
        return true;
    }
    while (made > 0) {
        pthread_cond_destroy(condition_at(pool, --made));
    }
    pthread_mutex_destroy(&pool->mutex);
    return false;
}

worker_pool *worker_pool_create(const worker_pool_def *def)
{
    const unsigned count = def->workers + builders_for(def->workers);
    worker_pool *pool = calloc(1, sizeof *pool + count * sizeof pool->threads[0]);
    if (!pool) {
        return NULL;
    }
    pool->def = *def;
    pool->sharing = (spread){.hands = def->workers > 0 ? def->workers : 1, .run = worker_share, .context = pool};
    if (!schedule_init(&pool->waiting, def->greatest) || !init_waiting(pool)) {
        schedule_fini(&pool->waiting);
        free(pool);
        return NULL;
    }
    if (!start_threads(pool)) {
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
    pthread_cond_broadcast(&pool->called);
    pthread_cond_broadcast(&pool->relieved);
    pthread_cond_broadcast(&pool->build);
    pthread_mutex_unlock(&pool->mutex);
    for (unsigned i = 0; i < pool->started; i++) {
        pthread_join(pool->threads[i].thread, NULL);
    }
    for (int k = 0; k < CONDITIONS; k++) {
        pthread_cond_destroy(condition_at(pool, k));
    }
    pthread_mutex_destroy(&pool->mutex);
    schedule_fini(&pool->waiting);
    free(pool);
}

unsigned worker_pool_count(const worker_pool *pool)
{
    return pool->def.workers;
}

const spread *worker_pool_spread(const worker_pool *pool)
{
    return &pool->sharing;
}
