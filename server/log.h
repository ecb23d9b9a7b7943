/* log.h: one line per event on standard error, as text or as JSON:
 *
 *     time=2025-03-01T12:00:00.123Z level=info msg="forest created" name="long" strands=10000
 *     {"time":"2025-03-01T12:00:00.123Z","level":"info","msg":"forest created","name":"long","strands":10000}
 *
 * A line is one write. Text that came from a peer goes through log_quote, so that it can neither end a line nor forge
 * one. Of an event that comes too often lines are left out (log_limit.h), and the next one says how many. */
#ifndef SERVER_LOG_H
#define SERVER_LOG_H

#include <stdbool.h>
#include <stddef.h>

typedef enum log_level { LOG_ERROR, LOG_WARN, LOG_INFO, LOG_DEBUG } log_level;
typedef enum log_format { LOG_TEXT, LOG_JSON } log_format;

#if defined(__GNUC__)
#define LOG_FORMAT __attribute__((format(printf, 3, 4)))
#else
#define LOG_FORMAT
#endif

/* "error", "warn", "info", "debug". False: none of them. */
bool log_level_parse(const char *text, log_level *out);
/* "text", "json". False: none of them. */
bool log_format_parse(const char *text, log_format *out);

/* Lines above `level` are left out; LOG_INFO and LOG_TEXT until then. Any thread. */
void log_set_level(log_level level);
void log_set_format(log_format format);

/* `event` is a literal; `details` is printf's, and gives key=value pairs. Any thread. */
void log_write(log_level level, const char *event, const char *details, ...) LOG_FORMAT;

enum { LOG_QUOTED = 272 };

/* Writes `length` bytes of a stranger's text in quotes, with everything that is not printable ASCII escaped and the
 * rest cut. Returns `out`. */
const char *log_quote(const char *text, size_t length, char out[LOG_QUOTED]);

#endif
