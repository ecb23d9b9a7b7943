/* log.h: one readable line per event on standard error:
 *
 *     2025-03-01T12:00:00.123Z info  forest created name="long" strands=10000
 *
 * UTC time, level, event, details as key=value. A line is one write. Text that came from a peer goes through
 * log_quote, so that it can neither end a line nor forge one. */
#ifndef SERVER_LOG_H
#define SERVER_LOG_H

#include <stdbool.h>
#include <stddef.h>

typedef enum log_level { LOG_ERROR, LOG_WARN, LOG_INFO, LOG_DEBUG } log_level;

#if defined(__GNUC__)
#define LOG_FORMAT __attribute__((format(printf, 3, 4)))
#else
#define LOG_FORMAT
#endif

/* "error", "warn", "info", "debug". False: none of them. */
bool log_level_parse(const char *text, log_level *out);

/* Lines above `level` are left out. Before the first thread is started; LOG_INFO until then. */
void log_set_level(log_level level);

/* `details` is printf's. Any thread. */
void log_write(log_level level, const char *event, const char *details, ...) LOG_FORMAT;

enum { LOG_QUOTED = 272 };

/* Writes `length` bytes of a stranger's text in quotes, with everything that is not printable ASCII escaped and the
 * rest cut. Returns `out`. */
const char *log_quote(const char *text, size_t length, char out[LOG_QUOTED]);

#endif
