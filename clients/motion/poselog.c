/* poselog.c: see poselog.h. Columns are found by their names in the first line. Times stay integers: 100-ns ticks since
 * the year 1 need 60 bits. */
#include "motion/poselog.h"

#include "base/error.h"
#include "motion/formats.h"

#include <math.h>
#include <stdlib.h>

#define POSELOG_MAX_DISTANCE 1e9 /* greatest coordinate, file units */

/* The kind of column of that name, or -1. */
static int column_kind(text_span name)
{
    static const struct {
        const char *name;
        int kind;
    } names[] = {
        {"timestamp", COLUMN_TIME},
        {"time", COLUMN_TIME},
        {"t", COLUMN_TIME},
        {"x", COLUMN_X},
        {"y", COLUMN_X + 1},
        {"z", COLUMN_X + 2},
        {"positionx", COLUMN_X},
        {"positiony", COLUMN_X + 1},
        {"positionz", COLUMN_X + 2},
        {"px", COLUMN_X},
        {"py", COLUMN_X + 1},
        {"pz", COLUMN_X + 2},
        {"qx", COLUMN_QX},
        {"qy", COLUMN_QX + 1},
        {"qz", COLUMN_QX + 2},
        {"qw", COLUMN_QX + 3},
        {"quaternionx", COLUMN_QX},
        {"quaterniony", COLUMN_QX + 1},
        {"quaternionz", COLUMN_QX + 2},
        {"quaternionw", COLUMN_QX + 3},
        {"viewindex", COLUMN_VIEW},
    };
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        if (text_is(name, names[i].name)) {
            return names[i].kind;
        }
    }
    return -1;
}

/* A file without a heading is a plain log in its usual order. */
static void columns_usual(poselog *log)
{
    log->column_count = COLUMN_VIEW;
    for (int i = 0; i < COLUMN_VIEW; i++) {
        log->columns[i] = i;
    }
}

static awt_status columns_read(poselog *log, text_cursor *text, awt_error *error)
{
    text_cursor before = *text;
    text_span line, field;
    double number;
    bool done = false, numbers = false;
    if (!text_next_line(text, &line)) {
        return error_set(error, AWT_TRUNCATED, "the log is empty");
    }
    for (int i = 0; i < COLUMN_KINDS; i++) {
        log->columns[i] = -1;
    }
    while (text_next_field(&line, &done, &field)) {
        int kind = column_kind(field);
        if (log->column_count == POSELOG_MAX_COLUMNS) {
            return error_set(error, AWT_LIMIT, "the log has more than %d columns", POSELOG_MAX_COLUMNS);
        }
        numbers = numbers || text_real(field, &number);
        if (kind >= 0 && log->columns[kind] < 0) {
            log->columns[kind] = log->column_count;
        }
        log->column_count++;
    }
    if (numbers && log->column_count == COLUMN_VIEW) {
        columns_usual(log);
        *text = before;
    }
    for (int i = 0; i < COLUMN_VIEW; i++) {
        if (log->columns[i] < 0) {
            return error_set(error, AWT_BAD_FORMAT,
                             "the log's first line does not name the columns timestamp,x,y,z,qx,qy,qz,qw (or "
                             "Timestamp, PositionX..Z, QuaternionX..W)");
        }
    }
    log->has_views = log->columns[COLUMN_VIEW] >= 0;
    return AWT_OK;
}

/* A timestamp in ticks: as it stands, or, where the log's timestamps have decimal points, in millionths. */
static bool reading_time(text_span field, bool fractions, int64_t *ticks)
{
    text_span whole = {field.text, 0}, part;
    while (whole.length < field.length && field.text[whole.length] != '.') {
        whole.length++;
    }
    bool negative = whole.length > 0 && field.text[0] == '-';
    if (!text_integer(whole, ticks) || (!fractions && whole.length < field.length)) {
        return false;
    }
    if (!fractions) {
        return true;
    }
    if (*ticks > INT64_MAX / POSELOG_FRACTION - 1 || *ticks < -(INT64_MAX / POSELOG_FRACTION - 1)) {
        return false;
    }
    *ticks *= POSELOG_FRACTION;
    part =
        (text_span){field.text + whole.length + 1, field.length > whole.length ? field.length - whole.length - 1 : 0};
    for (int64_t worth = POSELOG_FRACTION / 10; part.length > 0; part.text++, part.length--, worth /= 10) {
        if (part.text[0] < '0' || part.text[0] > '9') {
            return false;
        }
        *ticks += (negative ? -worth : worth) * (part.text[0] - '0');
    }
    return true;
}

static bool span_has_point(text_span span)
{
    for (size_t i = 0; i < span.length; i++) {
        if (span.text[i] == '.') {
            return true;
        }
    }
    return false;
}

/* Of a row's fields, one reading. The error names the line. */
static awt_status reading_parse(const poselog *log, const text_span *fields, size_t line, poselog_reading *reading,
                                awt_error *error)
{
    double numbers[COLUMN_VIEW];
    *reading = (poselog_reading){0};
    text_span time = fields[log->columns[COLUMN_TIME]];
    if (!reading_time(time, log->has_fractions, &reading->ticks)) {
        return error_set(error, AWT_BAD_VALUE, "log line %zu: \"%.*s\" is no timestamp", line, text_shown(time),
                         time.text);
    }
    for (int i = COLUMN_X; i < COLUMN_VIEW; i++) {
        text_span field = fields[log->columns[i]];
        if (!text_real(field, &numbers[i]) || fabs(numbers[i]) > POSELOG_MAX_DISTANCE) {
            return error_set(error, AWT_BAD_VALUE, "log line %zu: \"%.*s\" is no usable number", line,
                             text_shown(field), field.text);
        }
    }
    if (log->has_views && !text_integer(fields[log->columns[COLUMN_VIEW]], &reading->view)) {
        return error_set(error, AWT_BAD_VALUE, "log line %zu: the ViewIndex is no whole number", line);
    }
    reading->position = (dvec3){numbers[COLUMN_X], numbers[COLUMN_X + 1], numbers[COLUMN_X + 2]};
    dquat q = {numbers[COLUMN_QX], numbers[COLUMN_QX + 1], numbers[COLUMN_QX + 2], numbers[COLUMN_QX + 3]};
    double length = sqrt(dquat_dot(q, q));
    if (!(length >= 0.5 && length <= 2)) {
        return error_set(error, AWT_BAD_VALUE, "log line %zu: a quaternion of length %g is no orientation", line,
                         length);
    }
    reading->orientation = dquat_unit(q);
    return AWT_OK;
}

static poselog_reading *readings_push(poselog *log)
{
    if (log->count == log->capacity) {
        size_t capacity = log->capacity ? log->capacity * 2 : 1024;
        poselog_reading *larger = realloc(log->readings, capacity * sizeof *larger);
        if (!larger) {
            return NULL;
        }
        log->readings = larger;
        log->capacity = capacity;
    }
    return &log->readings[log->count++];
}

static awt_status readings_read(poselog *log, text_cursor *text, awt_error *error)
{
    text_span line;
    while (text_next_line(text, &line)) {
        text_span fields[POSELOG_MAX_COLUMNS], field;
        size_t number = text->line - 1;
        int count = 0;
        bool done = false;
        while (text_next_field(&line, &done, &field) && count < POSELOG_MAX_COLUMNS) {
            fields[count++] = field;
        }
        if (count == 1 && fields[0].length == 0) {
            continue; /* an empty line */
        }
        if (count != log->column_count) {
            return error_set(error, AWT_BAD_FORMAT, "log line %zu has %d columns where the first line has %d", number,
                             count, log->column_count);
        }
        if (log->count == 2 * (size_t)MOTION_MAX_SAMPLES) {
            return error_set(error, AWT_LIMIT, "the log has more than %d rows", 2 * MOTION_MAX_SAMPLES);
        }
        if (log->count == 0) {
            log->has_fractions = span_has_point(fields[log->columns[COLUMN_TIME]]);
        }
        poselog_reading *reading = readings_push(log);
        if (!reading) {
            return error_set(error, AWT_NO_MEMORY, NULL);
        }
        awt_status status = reading_parse(log, fields, number, reading, error);
        if (status != AWT_OK) {
            return status;
        }
    }
    return AWT_OK;
}

awt_status poselog_read(text_cursor text, poselog *out, awt_error *error)
{
    *out = (poselog){0};
    awt_status status = columns_read(out, &text, error);
    return status == AWT_OK ? readings_read(out, &text, error) : status;
}

void poselog_fini(poselog *log)
{
    free(log->readings);
    *log = (poselog){0};
}
