/* prometheus.h: a strict reader of Prometheus's text format 0.0.4, for what /metrics says. */
#ifndef PROMETHEUS_H
#define PROMETHEUS_H

#include <stddef.h>

typedef struct prometheus_result {
    size_t families, samples;
} prometheus_result;

/* Reads all of it. What does not follow the format, or the rules for names and histograms, is said in `error` (its
 * first), which stays as it is otherwise. */
prometheus_result prometheus_check(const char *text, char *error, size_t error_size);

/* The value of the sample that is written exactly so (labels too); NAN: there is none. */
double prometheus_value(const char *text, const char *sample);

#endif
