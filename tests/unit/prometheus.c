/* prometheus.c: see prometheus.h. Every metric has HELP, then TYPE, then its samples, and no other's in between. */
#include "prometheus.h"

#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINE = 512, FAMILIES = 256, SAMPLES = 2048 };

typedef struct reader {
    prometheus_result result;
    char *error;
    size_t error_size;
    bool wrong;

    char families[FAMILIES][128]; /* every name that had its HELP */
    char samples[SAMPLES][160];   /* every sample, with its labels */
    char type[16];                /* of the present family; empty: none was said yet */

    /* the present histogram */
    double last_bound, last_count;
    bool has_infinite, has_sum, has_count;
} reader;

static void fail(reader *r, const char *why, const char *line)
{
    if (!r->wrong) {
        snprintf(r->error, r->error_size, "%s: %.120s", why, line);
        r->wrong = true;
    }
}

static size_t name_length(const char *text)
{
    size_t length = 0;
    while (isalpha((unsigned char)text[length]) || text[length] == '_' || text[length] == ':' ||
           (length > 0 && isdigit((unsigned char)text[length]))) {
        length++;
    }
    return length;
}

static const char *family(const reader *r)
{
    return r->result.families ? r->families[r->result.families - 1] : "";
}

static bool ends_with(const char *text, const char *end)
{
    return strlen(text) >= strlen(end) && strcmp(text + strlen(text) - strlen(end), end) == 0;
}

/* A histogram is whole when the next metric begins. */
static void end_family(reader *r, const char *line)
{
    if (strcmp(r->type, "histogram") == 0 && !(r->has_infinite && r->has_sum && r->has_count)) {
        fail(r, "a histogram lacks +Inf, _sum or _count", line);
    }
    r->type[0] = '\0';
    r->last_bound = -INFINITY;
    r->last_count = 0;
    r->has_infinite = r->has_sum = r->has_count = false;
}

static void read_help(reader *r, const char *line)
{
    size_t length = name_length(line + 7);
    end_family(r, line);
    if (length == 0 || length >= sizeof r->families[0] || line[7 + length] != ' ' || line[8 + length] == '\0' ||
        r->result.families == FAMILIES) {
        fail(r, "HELP wants a name and a text", line);
        return;
    }
    char *name = r->families[r->result.families++];
    memcpy(name, line + 7, length);
    name[length] = '\0';
    for (size_t i = 0; i + 1 < r->result.families; i++) {
        if (strcmp(r->families[i], name) == 0) {
            fail(r, "a metric comes twice", line);
        }
    }
}

static void read_type(reader *r, const char *line)
{
    size_t length = name_length(line + 7);
    const char *type = line[7 + length] == ' ' ? line + 7 + length + 1 : "";
    if (strncmp(line + 7, family(r), length) != 0 || family(r)[length] != '\0' || length == 0) {
        fail(r, "TYPE is not of the metric that HELP named", line);
    } else if (r->type[0] != '\0') {
        fail(r, "TYPE comes twice", line);
    } else if (strcmp(type, "counter") != 0 && strcmp(type, "gauge") != 0 && strcmp(type, "histogram") != 0) {
        fail(r, "there is no such type", line);
    } else if ((strcmp(type, "counter") == 0) != ends_with(family(r), "_total")) {
        fail(r, "counters, and nothing else, end in _total", line);
    }
    snprintf(r->type, sizeof r->type, "%.15s", type);
}

/* Reads {name="value",...}, copying what `le` says. NULL: it is none. */
static const char *read_labels(const char *at, char *bound, size_t bound_size)
{
    bound[0] = '\0';
    if (*at != '{') {
        return at;
    }
    do {
        at++;
        size_t length = name_length(at);
        const char *value = at + length + 2, *end = value;
        if (length == 0 || at[length] != '=' || at[length + 1] != '"') {
            return NULL;
        }
        for (; *end != '"'; end += *end == '\\' ? 2 : 1) {
            if (*end == '\0' || (*end == '\\' && !strchr("\\\"n", end[1]))) {
                return NULL;
            }
        }
        if (length == 2 && memcmp(at, "le", 2) == 0) {
            snprintf(bound, bound_size, "%.*s", (int)(end - value), value);
        }
        at = end + 1;
    } while (*at == ',');
    return *at == '}' ? at + 1 : NULL;
}

static void take_bucket(reader *r, const char *line, const char *bound, double value)
{
    char *end;
    double le = strtod(bound, &end);
    if (bound[0] == '\0' || *end != '\0' || le <= r->last_bound || value < r->last_count) {
        fail(r, "buckets rise in bound and count", line);
    }
    r->last_bound = le;
    r->last_count = value;
    r->has_infinite = isinf(le);
}

static void take_histogram(reader *r, const char *line, const char *suffix, const char *bound, double value)
{
    if (strcmp(suffix, "_bucket") == 0) {
        take_bucket(r, line, bound, value);
    } else if (strcmp(suffix, "_sum") == 0) {
        r->has_sum = true;
    } else if (strcmp(suffix, "_count") == 0 && value == r->last_count) {
        r->has_count = true;
    } else {
        fail(r, "a histogram has buckets, _sum and, as great as its last bucket, _count", line);
    }
}

static void note_sample(reader *r, const char *line, const char *end)
{
    char *name = r->samples[r->result.samples];
    if (r->result.samples + 1 == SAMPLES || (size_t)(end - line) >= sizeof r->samples[0]) {
        fail(r, "too many samples for this reader, or too long a one", line);
        return;
    }
    memcpy(name, line, (size_t)(end - line));
    name[end - line] = '\0';
    for (size_t i = 0; i < r->result.samples; i++) {
        if (strcmp(r->samples[i], name) == 0) {
            fail(r, "a sample comes twice", line);
        }
    }
    r->result.samples++;
}

static void read_sample(reader *r, const char *line)
{
    char bound[64], *end = NULL;
    size_t length = name_length(line), own = strlen(family(r));
    const char *after = length ? read_labels(line + length, bound, sizeof bound) : NULL;
    double value = after && *after == ' ' ? strtod(after + 1, &end) : NAN;
    const bool histogram = strcmp(r->type, "histogram") == 0;
    if (!end || end == after + 1 || *end != '\0') {
        fail(r, "a sample is NAME{LABELS} NUMBER", line);
        return;
    }
    note_sample(r, line, after);
    if (r->type[0] == '\0' || length < own || memcmp(line, family(r), own) != 0 || (!histogram && length != own)) {
        fail(r, "a sample without its HELP and TYPE before it", line);
    } else if (strcmp(r->type, "gauge") != 0 && !(value >= 0)) {
        fail(r, "less than nothing was counted", line);
    } else if (histogram) {
        char suffix[16];
        snprintf(suffix, sizeof suffix, "%.*s", (int)(length - own), line + own);
        take_histogram(r, line, suffix, bound, value);
    }
}

prometheus_result prometheus_check(const char *text, char *error, size_t error_size)
{
    static reader r;
    memset(&r, 0, sizeof r);
    r.error = error;
    r.error_size = error_size;
    end_family(&r, "");
    while (*text) {
        char line[LINE];
        size_t length = strcspn(text, "\n");
        if (text[length] != '\n' || length >= sizeof line) {
            fail(&r, "a line without an end", text);
            break;
        }
        memcpy(line, text, length);
        line[length] = '\0';
        text += length + 1;
        if (strncmp(line, "# HELP ", 7) == 0) {
            read_help(&r, line);
        } else if (strncmp(line, "# TYPE ", 7) == 0) {
            read_type(&r, line);
        } else {
            read_sample(&r, line);
        }
    }
    end_family(&r, "the end");
    return r.result;
}

double prometheus_value(const char *text, const char *sample)
{
    size_t length = strlen(sample);
    for (const char *at = text; at; at = strchr(at, '\n') ? strchr(at, '\n') + 1 : NULL) {
        if (strncmp(at, sample, length) == 0 && at[length] == ' ') {
            return strtod(at + length, NULL);
        }
    }
    return NAN;
}
