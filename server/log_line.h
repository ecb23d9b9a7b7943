/* log_line.h: one line of the log, from what is known of it to bytes. Pure: no clock, no descriptor. */
#ifndef SERVER_LOG_LINE_H
#define SERVER_LOG_LINE_H

#include "log.h"

enum { LOG_LINE_BYTES = 8192 /* of a line as it is written: more than LIMIT_LOG_LINE bytes of details can become */ };

/* Writes the line, its end included, and returns its length. `time` is in RFC 3339; `details` are key=value pairs with
 * a blank between, a value in quotes (log_quote) or without blanks. Details that were cut in a value end there. */
size_t log_line_write(log_format format, const char *time, log_level level, const char *event, const char *details,
                      char out[LOG_LINE_BYTES]);

#endif
