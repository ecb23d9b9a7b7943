/* log.c: see log.h. */
#include "log.h"
#include "clock.h"
#include "log_limit.h"
#include "log_line.h"
#include "metrics.h"

#include <inttypes.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static atomic_int greatest_level = LOG_INFO, written_format = LOG_TEXT;
static log_limiter limiter; /* under limiter_lock */
static pthread_mutex_t limiter_lock = PTHREAD_MUTEX_INITIALIZER;

void log_set_level(log_level level)
{
    atomic_store(&greatest_level, (int)level);
}

void log_set_format(log_format format)
{
    atomic_store(&written_format, (int)format);
}

static bool may_write(const char *event, uint64_t *suppressed)
{
    pthread_mutex_lock(&limiter_lock);
    bool may = log_limit_take(&limiter, event, clock_monotonic_us(), suppressed);
    pthread_mutex_unlock(&limiter_lock);
    metrics_count(METRIC_LOG_SUPPRESSED, !may);
    return may;
}

/* UTC as RFC 3339 has it, with milliseconds. */
static void tell_time(char *out, size_t size)
{
    struct timespec now = {0};
    struct tm utc = {0};
    clock_gettime(CLOCK_REALTIME, &now);
    gmtime_r(&now.tv_sec, &utc);
    size_t used = strftime(out, size, "%Y-%m-%dT%H:%M:%S", &utc);
    snprintf(out + used, size - used, ".%03ldZ", now.tv_nsec / 1000000);
}

void log_write(log_level level, const char *event, const char *details, ...)
{
    uint64_t suppressed = 0;
    if ((int)level > atomic_load(&greatest_level) || !may_write(event, &suppressed)) {
        return;
    }
    char time[64], pairs[LIMIT_LOG_LINE], line[LOG_LINE_BYTES];
    int before = suppressed ? snprintf(pairs, sizeof pairs, "suppressed=%" PRIu64 " ", suppressed) : 0;
    va_list arguments;
    va_start(arguments, details);
    vsnprintf(pairs + before, sizeof pairs - (size_t)before, details, arguments);
    va_end(arguments);
    tell_time(time, sizeof time);
    size_t size = log_line_write((log_format)atomic_load(&written_format), time, level, event, pairs, line);
    if (write(STDERR_FILENO, line, size) < 0) {
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
