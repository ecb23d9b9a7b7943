/* load_watch.c: see load_watch.h. */
#include "load_watch.h"
#include "health.h"
#include "limits.h"
#include "log.h"
#include "metrics.h"

#include <stdlib.h>

#define WORKER_SHARE 0.8 /* of a processor that a worker can give to forests: the rest is I/O's and the system's */

static uint32_t list_forests(service *shared, int64_t span_us, load_forest *list)
{
    uint32_t count = 0;
    for (resident *r = shared->forests.first; r; r = r->next) {
        load_meter_take(&r->meter, &r->lowered, span_us);
        list[count++] = (load_forest){.owner = r,
                                      .step_share = r->meter.step_share,
                                      .encode_share = r->meter.encode_share,
                                      .importance = r->importance,
                                      .streams = r->clock.mode == CLOCK_FREE,
                                      .measures = r->lowered};
    }
    return count;
}

static void tell(service *shared, const load_verdict *v)
{
    if (v->full != shared->load.full) {
        log_write(LOG_WARN, v->full ? "overloaded" : "not overloaded any more", "cost=%.2f capacity=%.2f", v->cost,
                  v->capacity);
    }
    metrics_set(METRIC_LOAD_COST, (int64_t)(v->cost * 1e6));
    metrics_set(METRIC_LOAD_CAPACITY, (int64_t)(v->capacity * 1e6));
}

static void look(service *shared, int64_t now_us)
{
    const unsigned workers = shared->options.workers ? shared->options.workers : 1;
    load_forest *list = calloc(shared->forests.alive ? shared->forests.alive : 1, sizeof *list);
    if (!list) {
        return; /* at the next look, then */
    }
    const uint32_t count = list_forests(shared, now_us - shared->load_looked_us, list);
    const load_verdict v = load_decide(list, count, WORKER_SHARE * workers);
    for (uint32_t i = 0; i < count; i++) {
        resident *r = list[i].owner;
        r->lowered = list[i].measures;
    }
    free(list);
    tell(shared, &v);
    health_set_overloaded(v.full, now_us);
    shared->load = v;
    shared->load_looked_us = now_us;
}

static void look_if_due(service *shared)
{
    const int64_t now_us = shared->options.clock_us();
    if (now_us - shared->load_looked_us >= LIMIT_LOAD_LOOK_US) {
        look(shared, now_us);
    }
}

void load_watch_count(service *shared, resident *r)
{
    if (!r->work.making) {
        r->meter.step_us += r->work.step_us;
        r->meter.encode_us += r->work.encode_us;
    }
    look_if_due(shared);
}

bool load_watch_is_full(service *shared)
{
    look_if_due(shared);
    return shared->load.full;
}
