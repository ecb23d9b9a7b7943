/* worker.c: see worker.h.
 *
 * Of the workers that have nothing to do, one keeps watch: it sleeps until the next job is due. The others sleep until
 * they are called, so that a job that becomes due wakes one thread and not all of them. */
#include "worker.h"
#include "base/assert.h"
#include "thread.h"

#include <pthread.h>
#include <stdlib.h>
#include <time.h>

typedef struct job_list {
    job *first, *last;
} job_list;

/* One thread. */
typedef struct worker {
    worker_pool *pool;
    unsigned number; /* counted from 1 */
    pthread_t thread;
} worker;

struct worker_pool {
    worker_pool_def def;
    pthread_mutex_t mutex;                  /* guards all that follows */
    pthread_cond_t called, relieved, build; /* idle workers; the one on watch; builders */
    schedule waiting;
    job_list done;
    bool watched;  /* a worker keeps watch */
    unsigned idle; /* workers that sleep until they are called */
    bool stopping;
    unsigned started;
    worker threads[]; /* workers, then builders; [started] */
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

/* ---- threads ----------------------------------------------------------------------------------------------------- */

static void pool_run(worker_pool *pool, job *work, unsigned number)
{
    work->run(work);
    work->last_worker = number;
    work->ended_us = pool->def.clock_us();
    pthread_mutex_lock(&pool->mutex);
    list_append(&pool->done, work);
    pthread_mutex_unlock(&pool->mutex);
    pool->def.wake(pool->def.context);
}

/* Has somebody look at the schedule, which has changed. */
static void call_one(worker_pool *pool)
{
    if (pool->idle > 0) {
        pthread_cond_signal(&pool->called);
    } else if (pool->watched) {
        pthread_cond_signal(&pool->relieved);
    }
}

/* The condition's clock is the monotonic one, whatever clock the pool goes by. */
static void keep_watch(worker_pool *pool, int64_t left_us)
{
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_sec += (time_t)(left_us / 1000000);
    until.tv_nsec += (long)(left_us % 1000000) * 1000;
    if (until.tv_nsec >= 1000000000) {
        until.tv_sec++;
        until.tv_nsec -= 1000000000;
    }
    pool->watched = true;
    pthread_cond_timedwait(&pool->relieved, &pool->mutex, &until);
    pool->watched = false;
}

static void wait_for_work(worker_pool *pool, int64_t now_us)
{
    const int64_t next_us = schedule_next_us(&pool->waiting);
    if (next_us == INT64_MAX || pool->watched) {
        pool->idle++;
        pthread_cond_wait(&pool->called, &pool->mutex);
        pool->idle--;
    } else {
        keep_watch(pool, next_us - now_us);
    }
}

static void *worker_main(void *argument)
{
    const worker *self = argument;
    worker_pool *pool = self->pool;
    pthread_mutex_lock(&pool->mutex);
    while (!pool->stopping) {
        const int64_t now_us = pool->def.clock_us();
        job *work = schedule_take(&pool->waiting, now_us, self->number);
        if (!work) {
            wait_for_work(pool, now_us);
            continue;
        }
        if (schedule_is_due(&pool->waiting, now_us) ||
            (!pool->watched && schedule_next_us(&pool->waiting) != INT64_MAX)) {
            call_one(pool);
        }
        pthread_mutex_unlock(&pool->mutex);
        pool_run(pool, work, self->number);
        pthread_mutex_lock(&pool->mutex);
    }
    pthread_mutex_unlock(&pool->mutex);
    return NULL;
}

static void *builder_main(void *argument)
{
    const worker *self = argument;
    worker_pool *pool = self->pool;
    pthread_mutex_lock(&pool->mutex);
    while (!pool->stopping) {
        job *work = schedule_take_long(&pool->waiting);
        if (!work) {
            pthread_cond_wait(&pool->build, &pool->mutex);
            continue;
        }
        pthread_mutex_unlock(&pool->mutex);
        pool_run(pool, work, 0);
        pthread_mutex_lock(&pool->mutex);
    }
    pthread_mutex_unlock(&pool->mutex);
    return NULL;
}

/* ---- life -------------------------------------------------------------------------------------------------------- */

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

static bool init_waiting(worker_pool *pool)
{
    if (pthread_mutex_init(&pool->mutex, NULL) != 0) {
        return false;
    }
    if (init_condition(&pool->called)) {
        if (init_condition(&pool->relieved)) {
            if (init_condition(&pool->build)) {
                return true;
            }
            pthread_cond_destroy(&pool->relieved);
        }
        pthread_cond_destroy(&pool->called);
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
    pthread_cond_destroy(&pool->called);
    pthread_cond_destroy(&pool->relieved);
    pthread_cond_destroy(&pool->build);
    pthread_mutex_destroy(&pool->mutex);
    schedule_fini(&pool->waiting);
    free(pool);
}

unsigned worker_pool_count(const worker_pool *pool)
{
    return pool->def.workers;
}

/* ---- jobs -------------------------------------------------------------------------------------------------------- */

/* Whoever is free comes for what is due; what is not needs only somebody who wakes in time. */
static void announce_step(worker_pool *pool, const job *work, bool is_next)
{
    if (work->not_before_us <= pool->def.clock_us()) {
        call_one(pool);
    } else if (is_next && pool->watched) {
        pthread_cond_signal(&pool->relieved);
    } else if (is_next) {
        pthread_cond_signal(&pool->called);
    }
}

void worker_pool_submit(worker_pool *pool, job *work)
{
    pthread_mutex_lock(&pool->mutex);
    const int64_t next_us = schedule_next_us(&pool->waiting);
    schedule_add(&pool->waiting, work);
    if (work->class == JOB_LONG) {
        pthread_cond_signal(&pool->build);
    } else {
        announce_step(pool, work, schedule_next_us(&pool->waiting) < next_us);
    }
    pthread_mutex_unlock(&pool->mutex);
}

bool worker_pool_withdraw(worker_pool *pool, job *work)
{
    pthread_mutex_lock(&pool->mutex);
    const bool withdrawn = schedule_remove(&pool->waiting, work);
    pthread_mutex_unlock(&pool->mutex);
    return withdrawn;
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
    job *work = schedule_take(&pool->waiting, pool->def.clock_us(), 0);
    work = work ? work : schedule_take_long(&pool->waiting);
    pthread_mutex_unlock(&pool->mutex);
    if (work) {
        pool_run(pool, work, 0);
    }
    return work != NULL;
}
