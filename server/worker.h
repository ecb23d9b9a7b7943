/* worker.h: threads that run jobs, and the way of the results back.
 *
 * Workers take the jobs that are due, the earliest deadline first (schedule.h). Long jobs run on threads of their own,
 * the builders, which take nothing else: however many grooms are wanted, steps have their workers. Whoever has run a
 * job puts it on the list of the done and calls `wake`, which sees to it that somebody looks there. A job is a member
 * of the thing it works on (a forest), which nobody else touches from submit until the job is taken back, or
 * withdrawn before it began. */
#ifndef WORKER_H
#define WORKER_H

#include "base/spread.h"
#include "schedule.h"

typedef struct worker_pool worker_pool;

typedef struct worker_pool_def {
    unsigned workers;            /* 0: jobs run only where worker_pool_run_one is called, long ones too */
    uint32_t greatest;           /* jobs that may wait at once */
    int64_t (*clock_us)(void);   /* the clock of not_before_us and deadline_us */
    void (*wake)(void *context); /* called from workers, without a lock */
    void *context;
} worker_pool_def;

/* Starts the threads, with all signals blocked: the workers, and half as many builders, rounded up. NULL: no memory or
 * no threads. */
worker_pool *worker_pool_create(const worker_pool_def *def);

/* Waits for the jobs that run and joins the threads. Jobs not begun, and done ones not taken, stay with their owners.
 * Accepts NULL. */
void worker_pool_destroy(worker_pool *pool);

/* Of workers, without builders. */
unsigned worker_pool_count(const worker_pool *pool);

/* For jobs that run here: their parts are done by workers that have nothing else to do, and by the job's own. A step
 * that is due comes first. Lives as long as the pool. */
const spread *worker_pool_spread(const worker_pool *pool);

/* The job must not be in the pool already. */
void worker_pool_submit(worker_pool *pool, job *work);

/* Takes back a job that has not begun. False: it runs or is done. */
bool worker_pool_withdraw(worker_pool *pool, job *work);

/* All jobs done since the last call, linked by `next` in the order in which they ended; NULL: none. */
job *worker_pool_take_done(worker_pool *pool);

/* Runs the next job on the calling thread: the most urgent step that is due, else a long one. False: there is none. */
bool worker_pool_run_one(worker_pool *pool);

#endif
