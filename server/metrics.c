/* metrics.c: see metrics.h. */
#include "metrics.h"
#include "proto.h"

#include <stdatomic.h>

enum {
    SHARDS = 16, /* threads beyond share one */
#define COUNT_ERROR(...) +1
    ERRORS = 0 PROTO_ERRORS(COUNT_ERROR),
#undef COUNT_ERROR
    CACHE_LINE = 64
};

typedef struct shard {
    _Alignas(CACHE_LINE) atomic_uint_fast64_t counters[METRIC_COUNTERS];
    atomic_uint_fast64_t errors[ERRORS + 1]; /* the last: codes that are not in the list */
    atomic_uint_fast64_t buckets[METRIC_HISTOGRAMS][HISTOGRAM_BUCKETS];
    atomic_uint_fast64_t sums_us[METRIC_HISTOGRAMS];
} shard;

static shard shards[SHARDS];
static atomic_int_fast64_t gauges[METRIC_GAUGES];

/* The calling thread's shard. */
static shard *own_shard(void)
{
    static atomic_uint threads;
    static _Thread_local shard *own;
    if (!own) {
        own = &shards[atomic_fetch_add_explicit(&threads, 1, memory_order_relaxed) % SHARDS];
    }
    return own;
}

static void add(atomic_uint_fast64_t *to, uint64_t n)
{
    atomic_fetch_add_explicit(to, n, memory_order_relaxed);
}

static size_t error_place(int code)
{
    static const int codes[ERRORS] = {
#define ERROR_CODE(NAME, number, ...) number,
        PROTO_ERRORS(ERROR_CODE)
#undef ERROR_CODE
    };
    size_t i = 0;
    while (i < ERRORS && codes[i] != code) {
        i++;
    }
    return i;
}

void metrics_count(metrics_counter counter, uint64_t n)
{
    add(&own_shard()->counters[counter], n);
}

void metrics_count_error(int code)
{
    add(&own_shard()->errors[error_place(code)], 1);
}

void metrics_observe(metrics_histogram histogram, uint64_t us)
{
    shard *own = own_shard();
    add(&own->buckets[histogram][histogram_bucket(us)], 1);
    add(&own->sums_us[histogram], us);
}

void metrics_add(metrics_gauge gauge, int64_t by)
{
    atomic_fetch_add_explicit(&gauges[gauge], by, memory_order_relaxed);
}

void metrics_set(metrics_gauge gauge, int64_t value)
{
    atomic_store_explicit(&gauges[gauge], value, memory_order_relaxed);
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

static uint64_t value_of(const atomic_uint_fast64_t *from)
{
    return atomic_load_explicit(from, memory_order_relaxed);
}

uint64_t metrics_counted(metrics_counter counter)
{
    uint64_t sum = 0;
    for (size_t i = 0; i < SHARDS; i++) {
        sum += value_of(&shards[i].counters[counter]);
    }
    return sum;
}

uint64_t metrics_counted_errors(int code)
{
    const size_t place = error_place(code);
    uint64_t sum = 0;
    for (size_t i = 0; i < SHARDS; i++) {
        sum += value_of(&shards[i].errors[place]);
    }
    return sum;
}

int64_t metrics_gauge_value(metrics_gauge gauge)
{
    return atomic_load_explicit(&gauges[gauge], memory_order_relaxed);
}

metrics_distribution metrics_distribution_of(metrics_histogram histogram)
{
    metrics_distribution out = {0};
    for (size_t i = 0; i < SHARDS; i++) {
        out.sum_us += value_of(&shards[i].sums_us[histogram]);
        for (size_t b = 0; b < HISTOGRAM_BUCKETS; b++) {
            out.count[b] += value_of(&shards[i].buckets[histogram][b]);
        }
    }
    return out;
}
