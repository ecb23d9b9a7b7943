/* schedule.h: jobs that wait for a worker, and which of them is next: of those whose time has come, the one with the
 * earliest deadline.
 *
 * Long jobs (a groom that is built) wait apart, in the order in which they came, so that they never take the place of a
 * step. A job is a member of the thing it works on (a forest), so each of these waits at most once, and the room that
 * was taken at the beginning is enough. One thread at a time. */
#ifndef SCHEDULE_H
#define SCHEDULE_H

#include <stdbool.h>
#include <stdint.h>

typedef enum job_class { JOB_STEP, JOB_LONG } job_class;

typedef enum job_queue { QUEUE_NONE, QUEUE_READY, QUEUE_LATER, QUEUE_LONG, QUEUE_COUNT } job_queue;

typedef struct job {
    /* the owner's; monotonic clock, microseconds */
    void (*run)(struct job *job);
    job_class class;
    int64_t not_before_us, deadline_us; /* of steps */
    int64_t ended_us;                   /* when it was done */
    /* the scheduler's */
    struct job *next;     /* in the list of the done */
    unsigned last_worker; /* who ran it last, counted from 1; 0: nobody yet */
    job_queue queue;      /* where it waits */
    uint32_t place;       /* there */
    uint64_t serial;      /* in order of coming */
} job;

typedef struct job_heap {
    job **jobs; /* [room], heap; the first is the next */
    uint32_t count;
} job_heap;

typedef struct schedule {
    job_heap heaps[QUEUE_COUNT];
    uint32_t room;
    uint64_t serial;
} schedule;

/* Room for so many jobs. False: no memory. */
bool schedule_init(schedule *s, uint32_t room);
/* Jobs that wait stay with their owners. Accepts a zeroed one. */
void schedule_fini(schedule *s);

/* The job must not wait already. */
void schedule_add(schedule *s, job *work);
/* False: it does not wait here. */
bool schedule_remove(schedule *s, job *work);

/* The step that this worker (counted from 1; 0: nobody in particular) should run now; NULL: none is due. Where several
 * deadlines lie close together it is one that the same worker ran last, for the sake of its caches. */
job *schedule_take(schedule *s, int64_t now_us, unsigned worker);
/* The long job that came first; NULL: none. */
job *schedule_take_long(schedule *s);

/* True if a step is due. */
bool schedule_is_due(const schedule *s, int64_t now_us);
/* When the next step that is not due yet will be; INT64_MAX: none waits. */
int64_t schedule_next_us(const schedule *s);

#endif
