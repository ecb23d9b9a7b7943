/* metrics.h: what the process counts about itself, for /metrics: counters, gauges and histograms of metrics.def.
 *
 * All calls are for any thread, take no lock and no memory, and cost a few nanoseconds: every thread counts in a shard
 * of its own, and whoever reads adds them up. */
#ifndef SERVER_METRICS_H
#define SERVER_METRICS_H

#include "histogram.h"
#include "metrics.def"

typedef enum metrics_counter {
#define METRICS_ID(NAME, ...) METRIC_##NAME,
    METRICS_COUNTERS(METRICS_ID) METRIC_COUNTERS
} metrics_counter;

typedef enum metrics_gauge { METRICS_GAUGES(METRICS_ID) METRIC_GAUGES } metrics_gauge;

typedef enum metrics_histogram { METRICS_HISTOGRAMS(METRICS_ID) METRIC_HISTOGRAMS } metrics_histogram;
#undef METRICS_ID

/* Counts `n` more. */
void metrics_count(metrics_counter counter, uint64_t n);
/* One ERROR of this code (PROTO_ERROR_...) was sent. */
void metrics_count_error(int code);
/* Counts one duration. */
void metrics_observe(metrics_histogram histogram, uint64_t us);
/* The gauge rises by so much, or falls. */
void metrics_add(metrics_gauge gauge, int64_t by);
/* The gauge stands there. */
void metrics_set(metrics_gauge gauge, int64_t value);

/* ---- reading ----------------------------------------------------------------------------------------------------- */

uint64_t metrics_counted(metrics_counter counter);
uint64_t metrics_counted_errors(int code);
int64_t metrics_gauge_value(metrics_gauge gauge);

/* A histogram as it stands; `count[i]` is of bucket i alone. */
typedef struct metrics_distribution {
    uint64_t count[HISTOGRAM_BUCKETS];
    uint64_t sum_us;
} metrics_distribution;
metrics_distribution metrics_distribution_of(metrics_histogram histogram);

#endif
