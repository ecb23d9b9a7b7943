/* service.h: what all sessions share, and the one lock over it.
 *
 * The lock guards the service and everything that is reached from it: sessions, subscriptions, the registry and its
 * residents (but not the `work` of one that is busy, which is its worker's), uploads, counters, and what connections
 * have still to send. Whoever uses any of it, on whichever thread, holds the lock meanwhile: while a message is carried
 * out, while a finished job is brought to those who asked. That takes microseconds. Nobody holds it while it sleeps in
 * poll, receives, sends, simulates or encodes. The worker pool has a lock of its own, taken within this one and never
 * the other way round; published pictures are counted atomically and need none. */
#ifndef SERVICE_H
#define SERVICE_H

#include "accounts.h"
#include "handles.h"
#include "parking.h"
#include "worker.h"

#include <pthread.h>

typedef struct service_options {
    unsigned io_threads; /* for STATS */
    unsigned workers;    /* 0: jobs run where worker_pool_run_one is called */
    uint32_t max_forests, max_sessions;
    bool auth_required;
    uint8_t token[AUTH_TOKEN_SIZE]; /* the owner's */
    const account_list *accounts;   /* besides the owner; NULL: none. Copied */
    int64_t resume_grace_us;        /* that a session which was cut off can be resumed */
    int64_t forest_grace_us;        /* that a forest lives on when nobody has it open; 0: for ever */
    int64_t quiet_us;               /* that a client may be silent; 0: for ever */
    int64_t keep_us;                /* from one round of bringing forests to the disk to the next; 0: none */
    keeper *keeper;                 /* not the service's own; NULL: nothing is brought to the disk */
    int64_t (*clock_us)(void);      /* clock_monotonic_us, or a test's */
    void (*wake)(void *context);    /* called from workers, without a lock, when a job is done */
    void *wake_context;
} service_options;

typedef struct service_counters {
    uint64_t frames_encoded, frames_sent, bytes_sent, errors_sent;
    uint64_t steps, step_us, encode_us;
    uint64_t deadlines_missed; /* jobs that ended later than they should */
    uint64_t dropped_us;       /* simulated time that free-running forests passed over */
    uint32_t sessions, idle;   /* idle: of the sessions, those whose connections live in the cold home */
} service_counters;

typedef struct service {
    service_options options; /* never changed: read without the lock */
    pthread_mutex_t lock;    /* service_lock */
    bool has_lock;
    struct home *to_ring;              /* homes whose bells ring when the lock is let go: see home.h */
    struct home *door;                 /* whose loop tells how far forests have come; NULL: nobody's (in tests) */
    struct home_link *replies_waiting; /* connections that a worker will send its answers to: see connection_send.h */
    worker_pool *pool;
    registry forests;
    handle_table sessions; /* of struct session */
    account_book accounts;
    upload_budget uploads;
    parking parked;
    service_counters counters;
    bool stopping;          /* messages are refused */
    load_verdict load;      /* of the last look at what forests cost (load_watch.h) */
    int64_t load_looked_us; /* when that was */
    int64_t started_us;
    int64_t progress_us;    /* when PROGRESS is due next, if anyone wants it */
    int64_t forests_due_us; /* when forests are looked at next that nobody has open; INT64_MAX: never */
    int64_t keep_due_us;    /* when forests are brought to the disk next; likewise */
} service;

/* Starts the workers. False: no memory or no threads; nothing is left behind then. */
bool service_init(service *s, const service_options *options);
/* After the last session's end, without the lock. Waits for jobs that run. Accepts a zeroed one. */
void service_fini(service *s);

/* Something will be due (upkeep.h) earlier than it was. Under the lock. */
void service_ring_door(service *s);

/* The lock over all of it; not recursive. One thread alone, as in tests without threads, may do without. Letting it go
 * rings the bells of loops that have something to do. */
void service_lock(service *s);
void service_unlock(service *s);

#endif
