/* worker_insides.h: what a pool is made of, for worker.c, which runs jobs, and worker_pool.c, which makes and ends it.
 */
#ifndef WORKER_INSIDES_H
#define WORKER_INSIDES_H

#include "parts.h"
#include "worker.h"

#include <pthread.h>

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
    pthread_cond_t together;                /* who waits for parts of its job */
    schedule waiting;
    parts_list offered;
    job_list done;
    bool watched;  /* a worker keeps watch */
    unsigned idle; /* workers that sleep until they are called */
    bool stopping;
    spread sharing;
    unsigned started;
    worker threads[]; /* workers, then builders; [started] */
};

/* A worker's and a builder's thread; of a struct worker. */
void *worker_main(void *argument);
void *builder_main(void *argument);
/* spread.run of a pool. */
void worker_share(void *pool, spread_part part, void *work, uint32_t count);

#endif
