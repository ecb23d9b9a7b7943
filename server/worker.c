/* worker.c: see worker.h.
 *
 * Of the workers that have nothing to do, one keeps watch: it sleeps until the next job is due. The others sleep until
 * they are called, so that a job that becomes due wakes one thread and not all of them. */
#include "worker_insides.h"

#include <time.h>

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

/* ---- jobs that ran, and those that wait ---------------------------------------------------------------------------
 */

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

/* ---- parts ------------------------------------------------------------------------------------------------------- */

/* Takes and does one part, of `own` alone where it is not NULL; with the lock, which is not held meanwhile. False:
 * there is none. */
static bool do_part(worker_pool *pool, parts *own)
{
    uint32_t index = 0;
    parts *of = parts_take(&pool->offered, own, &index);
    if (!of) {
        return false;
    }
    pthread_mutex_unlock(&pool->mutex);
    of->part(of->work, index);
    pthread_mutex_lock(&pool->mutex);
    if (parts_end(of) && of != own) {
        pthread_cond_broadcast(&pool->together);
    }
    return true;
}

/* Never waits for a part that nobody does: what is left is the caller's. */
void worker_share(void *context, spread_part part, void *work, uint32_t count)
{
    worker_pool *pool = context;
    parts own = {.part = part, .work = work, .count = count};
    pthread_mutex_lock(&pool->mutex);
    parts_offer(&pool->offered, &own);
    for (uint32_t n = 1; n < count; n++) {
        call_one(pool);
    }
    while (do_part(pool, &own)) {
    }
    while (own.running > 0) {
        pthread_cond_wait(&pool->together, &pool->mutex);
    }
    pthread_mutex_unlock(&pool->mutex);
}

/* ---- threads ----------------------------------------------------------------------------------------------------- */

void *worker_main(void *argument)
{
    const worker *self = argument;
    worker_pool *pool = self->pool;
    pthread_mutex_lock(&pool->mutex);
    while (!pool->stopping) {
        const int64_t now_us = pool->def.clock_us();
        job *work = schedule_take(&pool->waiting, now_us, self->number);
        if (!work) {
            if (!do_part(pool, NULL)) {
                wait_for_work(pool, now_us);
            }
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

void *builder_main(void *argument)
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
