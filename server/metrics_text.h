/* metrics_text.h: what the process counts, as Prometheus reads it (text format 0.0.4). */
#ifndef SERVER_METRICS_TEXT_H
#define SERVER_METRICS_TEXT_H

#include <stdio.h>

/* Writes every metric of metrics.def, and what is known of the process itself. Any thread. */
void metrics_write(FILE *file);

#endif
