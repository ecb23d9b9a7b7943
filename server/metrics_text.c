/* metrics_text.c: see metrics_text.h. */
#include "metrics_text.h"
#include "metrics.h"
#include "process.h"
#include "proto.h"
#include "base/version.h"

#include <inttypes.h>

static void write_head(FILE *file, const char *name, const char *type, const char *text)
{
    fprintf(file, "# HELP %s %s\n# TYPE %s %s\n", name, text, name, type);
}

/* Whole numbers stay whole; nine digits tell microseconds in seconds apart for weeks. */
static void write_value(FILE *file, double value)
{
    fprintf(file, " %.15g\n", value);
}

static void write_counters(FILE *file)
{
#define WRITE_COUNTER(NAME, name, scale, text) \
    write_head(file, name, "counter", text);   \
    fputs(name, file);                         \
    write_value(file, (double)metrics_counted(METRIC_##NAME) * (scale));
    METRICS_COUNTERS(WRITE_COUNTER)
#undef WRITE_COUNTER
}

static void write_errors(FILE *file)
{
    static const char name[] = "awtd_errors_sent_total";
    write_head(file, name, "counter", "ERRORs sent, by their code in PROTOCOL.md.");
#define WRITE_ERROR(NAME, number, retry, closes, text) \
    fprintf(file, "%s{code=\"%d\",name=\"%s\"} %" PRIu64 "\n", name, number, #NAME, metrics_counted_errors(number));
    PROTO_ERRORS(WRITE_ERROR)
#undef WRITE_ERROR
}

static void write_gauges(FILE *file)
{
#define WRITE_GAUGE(NAME, name, scale, text) \
    write_head(file, name, "gauge", text);   \
    fputs(name, file);                       \
    write_value(file, (double)metrics_gauge_value(METRIC_##NAME) * (scale));
    METRICS_GAUGES(WRITE_GAUGE)
#undef WRITE_GAUGE
}

static void write_histogram(FILE *file, const char *name, metrics_distribution d)
{
    uint64_t total = 0;
    for (size_t i = 0; i < HISTOGRAM_BOUNDS; i++) {
        total += d.count[i];
        fprintf(file, "%s_bucket{le=\"%g\"} %" PRIu64 "\n", name, (double)histogram_bound_us(i) * 1e-6, total);
    }
    total += d.count[HISTOGRAM_BOUNDS];
    fprintf(file, "%s_bucket{le=\"+Inf\"} %" PRIu64 "\n%s_sum", name, total, name);
    write_value(file, (double)d.sum_us * 1e-6);
    fprintf(file, "%s_count %" PRIu64 "\n", name, total);
}

static void write_histograms(FILE *file)
{
#define WRITE_HISTOGRAM(NAME, name, text)      \
    write_head(file, name, "histogram", text); \
    write_histogram(file, name, metrics_distribution_of(METRIC_##NAME));
    METRICS_HISTOGRAMS(WRITE_HISTOGRAM)
#undef WRITE_HISTOGRAM
}

static void write_process_value(FILE *file, const char *name, const char *type, const char *text, double value)
{
    if (value >= 0) {
        write_head(file, name, type, text);
        fputs(name, file);
        write_value(file, value);
    }
}

/* Under the names that all programs have. */
static void write_process(FILE *file)
{
    const process_figures p = process_look();
    write_process_value(file, "process_cpu_seconds_total", "counter", "Processor time, all threads.", p.processor_s);
    write_process_value(file, "process_start_time_seconds", "gauge", "When it began, since 1970.", p.started_s);
    write_process_value(file, "process_open_fds", "gauge", "Descriptors that are open.", p.descriptors);
    write_process_value(file, "process_max_fds", "gauge", "Descriptors that may be open.", p.descriptors_greatest);
    write_process_value(file, "process_resident_memory_bytes", "gauge", "Memory in use.", p.memory_bytes);
}

void metrics_write(FILE *file)
{
    write_head(file, "awtd_build_info", "gauge", "The daemon's version; always 1.");
    fputs("awtd_build_info{version=\"" AWTD_VERSION "\"} 1\n", file);
    write_counters(file);
    write_errors(file);
    write_gauges(file);
    write_histograms(file);
    write_process(file);
}
