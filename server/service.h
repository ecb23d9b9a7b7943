/* service.h: what all sessions share. The I/O thread's, all of it. */
#ifndef SERVICE_H
#define SERVICE_H

#include "auth.h"
#include "handles.h"
#include "registry.h"
#include "upload.h"
#include "worker.h"

typedef struct service_options {
    unsigned workers; /* 0: jobs run where worker_pool_run_one is called */
    uint32_t max_forests, max_sessions;
    bool auth_required;
    uint8_t token[AUTH_TOKEN_SIZE];
    int64_t (*clock_us)(void);   /* clock_monotonic_us, or a test's */
    void (*wake)(void *context); /* called from workers when a job is done */
    void *wake_context;
} service_options;

typedef struct service_counters {
    uint64_t frames_encoded, frames_sent, bytes_sent, errors_sent;
    uint64_t steps, step_us, encode_us;
    uint32_t sessions;
} service_counters;

typedef struct service {
    service_options options;
    worker_pool *pool;
    registry forests;
    handle_table sessions; /* of struct session */
    upload_budget uploads;
    service_counters counters;
    int64_t started_us;
    int64_t progress_us; /* when PROGRESS is due next, if anyone wants it */
} service;

/* Starts the workers. False: no memory or no threads; nothing is left behind then. */
bool service_init(service *s, const service_options *options);
/* After the last session's end. Waits for jobs that run. Accepts a zeroed one. */
void service_fini(service *s);

#endif
