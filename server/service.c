/* service.c: see service.h. */
#include "service.h"
#include "base/assert.h"
#include "home.h"
#include "limits.h"
#include "metrics.h"
#include "subscription.h"

bool service_init(service *s, const service_options *options)
{
    *s = (service){.options = *options};
    s->uploads.greatest = LIMIT_UPLOADS_BYTES;
    accounts_init(&s->accounts, options->token, &s->uploads);
    if (options->accounts) {
        accounts_set(&s->accounts, options->accounts);
        s->options.accounts = NULL;
    }
    s->started_us = options->clock_us();
    s->load_looked_us = s->started_us;
    s->forests_due_us = options->forest_grace_us > 0 ? s->started_us : INT64_MAX;
    s->keep_due_us = options->keeper && options->keep_us > 0 ? s->started_us + options->keep_us : INT64_MAX;
    s->has_lock = pthread_mutex_init(&s->lock, NULL) == 0;
    if (!s->has_lock) {
        return false;
    }
    s->pool = worker_pool_create(&(worker_pool_def){.workers = options->workers,
                                                    .greatest = options->max_forests,
                                                    .clock_us = options->clock_us,
                                                    .wake = options->wake,
                                                    .context = options->wake_context});
    const registry_def forests = {.greatest = options->max_forests,
                                  .accounts = &s->accounts,
                                  .pool = s->pool,
                                  .clock_us = options->clock_us,
                                  .wish = subscriptions_wish,
                                  .interval_us = subscriptions_interval_us};
    if (s->pool && registry_init(&s->forests, &forests) && handle_table_init(&s->sessions, options->max_sessions)) {
        metrics_set(METRIC_WORKERS, options->workers);
        s->forests.keeper = options->keeper;
        return true;
    }
    service_fini(s);
    return false;
}

void service_fini(service *s)
{
    worker_pool_destroy(s->pool); /* first: no worker may hold what is freed next */
    parking_fini(&s->parked, &s->forests, 0);
    registry_fini(&s->forests);
    handle_table_fini(&s->sessions);
    if (s->has_lock) {
        pthread_mutex_destroy(&s->lock);
    }
    *s = (service){0};
}

void service_ring_door(service *s)
{
    if (s->door) {
        home_ring(s->door, s);
    }
}

void service_lock(service *s)
{
    /* whoever has it lets it go within microseconds, sooner than a thread falls asleep and is woken */
    for (int n = 0; n < LIMIT_LOCK_TRIES; n++) {
        if (pthread_mutex_trylock(&s->lock) == 0) {
            return;
        }
    }
    int failed = pthread_mutex_lock(&s->lock);
    ASSERT(!failed);
}

void service_unlock(service *s)
{
    /* noted before the lock is let go: a home may be in the list anew right after */
    wake *bells[LIMIT_IO_THREADS_GREATEST + 2];
    unsigned count = 0;
    for (; s->to_ring; s->to_ring = s->to_ring->next_rung) {
        bells[count++] = &s->to_ring->bell;
    }
    int failed = pthread_mutex_unlock(&s->lock);
    ASSERT(!failed);
    while (count > 0) {
        wake_ring(bells[--count]);
    }
}
