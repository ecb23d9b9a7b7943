/* jsonout.c: see jsonout.h. */
#include "jsonout.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

jsonout jsonout_begin(FILE *file)
{
    return (jsonout){.file = file};
}

bool jsonout_done(jsonout *j)
{
    if (fputc('\n', j->file) == EOF || ferror(j->file)) {
        j->failed = true;
    }
    return j->finished && !j->failed;
}

static void jsonout_break(jsonout *j)
{
    if (j->compact) {
        fputc(' ', j->file);
        return;
    }
    fprintf(j->file, "\n%*s", (int)(2 * j->depth), "");
}

/* Bytes of the UTF-8 sequence at `text`, 0 if there is none (RFC 3629: shortest form, no surrogates). */
static int utf8_length(const unsigned char *text)
{
    unsigned char first = text[0];
    int length = first < 0x80 ? 1 : first < 0xc2 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : first < 0xf5 ? 4 : 0;
    for (int i = 1; i < length; i++) {
        if ((text[i] & 0xc0) != 0x80) {
            return 0;
        }
    }
    bool overlong = (first == 0xe0 && text[1] < 0xa0) || (first == 0xf0 && text[1] < 0x90);
    bool beyond = (first == 0xed && text[1] > 0x9f) || (first == 0xf4 && text[1] > 0x8f);
    return overlong || beyond ? 0 : length;
}

static void jsonout_quote(jsonout *j, const char *text)
{
    fputc('"', j->file);
    for (const unsigned char *c = (const unsigned char *)text; *c;) {
        int length = utf8_length(c);
        if (length == 0) {
            fputs("\xef\xbf\xbd", j->file);
            c++;
            continue;
        }
        if (*c == '"' || *c == '\\') {
            fprintf(j->file, "\\%c", *c);
        } else if (*c < 0x20 || *c == 0x7f) {
            fprintf(j->file, "\\u%04x", *c);
        } else {
            fwrite(c, 1, (size_t)length, j->file);
        }
        c += length;
    }
    fputc('"', j->file);
}

/* Comma, line break and key before a value. False where no value may stand. */
static bool jsonout_place(jsonout *j, const char *key)
{
    bool in_object = j->depth > 0 && !j->open[j->depth - 1].array;
    if (j->failed || j->finished || in_object != (key != NULL)) {
        j->failed = true;
        return false;
    }
    if (j->depth > 0) {
        if (j->open[j->depth - 1].filled) {
            fputc(',', j->file);
        }
        j->open[j->depth - 1].filled = true;
        jsonout_break(j);
    }
    if (key) {
        jsonout_quote(j, key);
        fputs(": ", j->file);
    }
    j->finished = j->depth == 0;
    return true;
}

static void jsonout_nest(jsonout *j, const char *key, bool array)
{
    if (j->depth == JSONOUT_MAX_DEPTH) {
        j->failed = true;
    }
    if (jsonout_place(j, key)) {
        fputc(array ? '[' : '{', j->file);
        j->finished = false;
        j->open[j->depth].array = array;
        j->open[j->depth].filled = false;
        j->depth++;
    }
}

void jsonout_object(jsonout *j, const char *key)
{
    jsonout_nest(j, key, false);
}

void jsonout_array(jsonout *j, const char *key)
{
    jsonout_nest(j, key, true);
}

void jsonout_close(jsonout *j)
{
    if (j->depth == 0) {
        j->failed = true;
        return;
    }
    j->depth--;
    if (j->open[j->depth].filled) {
        jsonout_break(j);
    }
    fputc(j->open[j->depth].array ? ']' : '}', j->file);
    j->finished = j->depth == 0;
}

void jsonout_text(jsonout *j, const char *key, const char *text)
{
    if (!jsonout_place(j, key)) {
        return;
    }
    if (text) {
        jsonout_quote(j, text);
    } else {
        fputs("null", j->file);
    }
}

/* The fewest digits from `least` to `most` that read back as the same number. */
static void jsonout_number(jsonout *j, double value, int least, int most, bool single)
{
    char text[40];
    if (!isfinite(value)) {
        fputs("null", j->file);
        return;
    }
    for (int digits = least; digits <= most; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (single ? strtof(text, NULL) == (float)value : strtod(text, NULL) == value) {
            break;
        }
    }
    fputs(text, j->file);
}

void jsonout_real(jsonout *j, const char *key, double value)
{
    if (jsonout_place(j, key)) {
        jsonout_number(j, value, 15, 17, false);
    }
}

void jsonout_float(jsonout *j, const char *key, float value)
{
    if (jsonout_place(j, key)) {
        jsonout_number(j, (double)value, 6, 9, true);
    }
}

void jsonout_integer(jsonout *j, const char *key, int64_t value)
{
    if (jsonout_place(j, key)) {
        fprintf(j->file, "%" PRId64, value);
    }
}

void jsonout_unsigned(jsonout *j, const char *key, uint64_t value)
{
    if (jsonout_place(j, key)) {
        fprintf(j->file, "%" PRIu64, value);
    }
}

void jsonout_bool(jsonout *j, const char *key, bool value)
{
    if (jsonout_place(j, key)) {
        fputs(value ? "true" : "false", j->file);
    }
}

void jsonout_reals(jsonout *j, const char *key, const double *values, size_t count)
{
    bool compact = j->compact;
    jsonout_array(j, key);
    j->compact = true;
    for (size_t i = 0; i < count; i++) {
        jsonout_real(j, NULL, values[i]);
    }
    jsonout_close(j);
    j->compact = compact;
}
