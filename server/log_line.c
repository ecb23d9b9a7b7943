/* log_line.c: see log_line.h. */
#include "log_line.h"
#include "limits.h"
#include "base/assert.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

static const char *const level_names[] = {
    [LOG_ERROR] = "error", [LOG_WARN] = "warn", [LOG_INFO] = "info", [LOG_DEBUG] = "debug"};

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

bool log_format_parse(const char *text, log_format *out)
{
    const bool json = strcmp(text, "json") == 0;
    *out = json ? LOG_JSON : LOG_TEXT;
    return json || strcmp(text, "text") == 0;
}

/* ---- JSON -------------------------------------------------------------------------------------------------------- */

typedef struct writer {
    char *out;
    size_t used;
} writer;

static void put(writer *w, const char *text)
{
    size_t size = strlen(text);
    ASSERT(w->used + size + 1 < LOG_LINE_BYTES);
    memcpy(w->out + w->used, text, size);
    w->used += size;
}

static void put_character(writer *w, unsigned char c)
{
    char text[8];
    const bool plain = c >= 0x20 && c < 0x7f && c != '"' && c != '\\';
    snprintf(text, sizeof text, plain ? "%c" : "\\u%04x", c);
    put(w, text);
}

static unsigned digit_value(char c)
{
    return isdigit((unsigned char)c) ? (unsigned)(c - '0') : (unsigned)(tolower((unsigned char)c) - 'a' + 10);
}

/* What log_quote wrote, without its escapes; returns what follows. A byte that is no ASCII becomes the character of
 * that number. */
static const char *put_quoted(writer *w, const char *at)
{
    for (at++; *at && *at != '"'; at++) {
        unsigned char c = (unsigned char)*at;
        if (c == '\\' && at[1] == 'x' && isxdigit((unsigned char)at[2]) && isxdigit((unsigned char)at[3])) {
            c = (unsigned char)(digit_value(at[2]) << 4 | digit_value(at[3]));
            at += 3;
        } else if (c == '\\' && at[1]) {
            c = (unsigned char)*++at;
        }
        put_character(w, c);
    }
    return *at ? at + 1 : at;
}

/* A whole number that every reader of JSON takes exactly. */
static bool is_number(const char *text, size_t length)
{
    const size_t sign = text[0] == '-';
    const size_t digits = length - sign;
    return digits > 0 && digits <= 15 && strspn(text + sign, "0123456789") >= digits &&
           (text[sign] != '0' || digits == 1);
}

static const char *put_bare(writer *w, const char *at)
{
    const size_t length = strcspn(at, " ");
    const bool number = is_number(at, length);
    put(w, number ? "" : "\"");
    for (size_t i = 0; i < length; i++) {
        put_character(w, (unsigned char)at[i]);
    }
    put(w, number ? "" : "\"");
    return at + length;
}

static void put_details(writer *w, const char *at)
{
    while (*at) {
        const size_t key = strcspn(at, "= ");
        if (at[key] != '=' || key == 0) {
            at += key + (at[key] != '\0');
            continue;
        }
        put(w, ",\"");
        for (size_t i = 0; i < key; i++) {
            put_character(w, (unsigned char)at[i]);
        }
        put(w, "\":");
        at += key + 1;
        if (*at == '"') {
            put(w, "\"");
            at = put_quoted(w, at);
            put(w, "\"");
        } else {
            at = put_bare(w, at);
        }
    }
}

static size_t write_json(const char *time, log_level level, const char *event, const char *details, char *out)
{
    writer w = {.out = out};
    put(&w, "{\"time\":\"");
    put(&w, time);
    put(&w, "\",\"level\":\"");
    put(&w, level_names[level]);
    put(&w, "\",\"msg\":\"");
    put(&w, event);
    put(&w, "\"");
    put_details(&w, details);
    put(&w, "}\n");
    return w.used;
}

/* ---- text -------------------------------------------------------------------------------------------------------- */

static size_t write_text(const char *time, log_level level, const char *event, const char *details, char *out)
{
    writer w = {.out = out};
    put(&w, "time=");
    put(&w, time);
    put(&w, " level=");
    put(&w, level_names[level]);
    put(&w, " msg=\"");
    put(&w, event);
    put(&w, "\"");
    put(&w, *details ? " " : "");
    put(&w, details);
    put(&w, "\n");
    return w.used;
}

size_t log_line_write(log_format format, const char *time, log_level level, const char *event, const char *details,
                      char out[LOG_LINE_BYTES])
{
    /* a byte of a value becomes six at most: \u00NN */
    _Static_assert(LOG_LINE_BYTES >= 7 * LIMIT_LOG_LINE, "a line has room");
    return format == LOG_JSON ? write_json(time, level, event, details, out)
                              : write_text(time, level, event, details, out);
}
