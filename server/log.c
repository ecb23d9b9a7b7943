/* log.c: see log.h. */
#include "log.h"
#include "limits.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char *const level_names[] = {
    [LOG_ERROR] = "error", [LOG_WARN] = "warn", [LOG_INFO] = "info", [LOG_DEBUG] = "debug"};

static log_level greatest_level = LOG_INFO;

bool log_level_parse(const char *text, log_level *out)
{
    for (size_t i = 0; i < sizeof level_names / sizeof level_names[0]; i++) {
        if (strcmp(text, level_names[i]) == 0) {
            *out = (log_level)i;
            return true;
        }
    }
    return false;
}

void log_set_level(log_level level)
{
    greatest_level = level;
}

/* Appends what snprintf left of the line; `used` never passes the end. */
static size_t line_advance(size_t used, int written, size_t size)
{
    size_t next = used + (written > 0 ? (size_t)written : 0);
    return next < size ? next : size - 1;
}

void log_write(log_level level, const char *event, const char *details, ...)
{
    if (level > greatest_level) {
        return;
    }
    struct timespec now = {0};
    struct tm utc = {0};
    clock_gettime(CLOCK_REALTIME, &now);
    gmtime_r(&now.tv_sec, &utc);

    char line[LIMIT_LOG_LINE];
    size_t size = sizeof line - 1, used = 0; /* the last byte is the line's end */
    used = line_advance(used, (int)strftime(line, size, "%Y-%m-%dT%H:%M:%S", &utc), size);
    used = line_advance(
        used, snprintf(line + used, size - used, ".%03ldZ %-5s %s ", now.tv_nsec / 1000000, level_names[level], event),
        size);
    va_list arguments;
    va_start(arguments, details);
    used = line_advance(used, vsnprintf(line + used, size - used, details, arguments), size);
    va_end(arguments);
    line[used++] = '\n';
    if (write(STDERR_FILENO, line, used) < 0) {
        return; /* nobody reads the log: the daemon goes on */
    }
}

const char *log_quote(const char *text, size_t length, char out[LOG_QUOTED])
{
    static const char digits[] = "0123456789abcdef";
    size_t used = 0;
    out[used++] = '"';
    for (size_t i = 0; i < length && used + 6 < LOG_QUOTED; i++) { /* room for \xNN, the quote and the end */
        unsigned char c = (unsigned char)text[i];
        if (c == '"' || c == '\\') {
            out[used++] = '\\';
            out[used++] = (char)c;
        } else if (c >= 0x20 && c < 0x7f) {
            out[used++] = (char)c;
        } else {
            out[used++] = '\\';
            out[used++] = 'x';
            out[used++] = digits[c >> 4];
            out[used++] = digits[c & 15];
        }
    }
    out[used++] = '"';
    out[used] = '\0';
    return out;
}
