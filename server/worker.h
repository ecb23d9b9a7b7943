/* worker.h: threads that run jobs, and the way of the results back.
 *
 * A worker takes the oldest job that was submitted, runs it, puts it on the list of the done and calls `wake`, which
 * sees to it that somebody looks there. A job is a member of the thing it works on (a forest), which nobody else
 * touches from submit until the job is taken back, so the queue needs no memory of its own and is never longer than
 * there are forests. */
#ifndef WORKER_H
#define WORKER_H

#include <stdbool.h>

typedef struct job {
    struct job *next;
    void (*run)(struct job *job); /* on a worker */
} job;

typedef struct worker_pool worker_pool;

/* Starts `count` threads, with all signals blocked. With 0, jobs run only where worker_pool_run_one is called. `wake`
 * is called from workers, without a lock. NULL: no memory or no threads. */
worker_pool *worker_pool_create(unsigned count, void (*wake)(void *context), void *context);

/* Waits for the jobs that run and joins the threads. Jobs not begun, and done ones not taken, stay with their owners.
 * Accepts NULL. */
void worker_pool_destroy(worker_pool *pool);

unsigned worker_pool_count(const worker_pool *pool);

/* The job must not be in the pool already. */
void worker_pool_submit(worker_pool *pool, job *work);

/* All jobs done since the last call, linked by `next` in the order in which they ended; NULL: none. */
job *worker_pool_take_done(worker_pool *pool);

/* Runs the oldest waiting job on the calling thread. False: none waits. */
bool worker_pool_run_one(worker_pool *pool);

#endif
