/* text.c: see text.h. strtod and strtoll want terminated text, so numbers pass through a small buffer; what does not
 * fit into it is no number that a motion file has reason to hold. */
#include "motion/text.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { TEXT_MAX_NUMBER = 63, TEXT_MAX_SHOWN = 40 };

static bool text_blank(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

text_cursor text_begin(const void *bytes, size_t size)
{
    static const char mark[3] = {'\xef', '\xbb', '\xbf'};
    text_cursor cursor = {bytes, bytes, 1};
    if (size > 0) {
        cursor.end += size;
    }
    if (size >= sizeof mark && memcmp(bytes, mark, sizeof mark) == 0) {
        cursor.at += sizeof mark;
    }
    return cursor;
}

bool text_next_word(text_cursor *cursor, text_span *word)
{
    while (cursor->at < cursor->end && text_blank(*cursor->at)) {
        cursor->line += *cursor->at == '\n';
        cursor->at++;
    }
    *word = (text_span){cursor->at, 0};
    while (cursor->at < cursor->end && !text_blank(*cursor->at)) {
        cursor->at++;
        word->length++;
    }
    return word->length > 0;
}

bool text_next_line(text_cursor *cursor, text_span *line)
{
    if (cursor->at == cursor->end) {
        return false;
    }
    size_t left = (size_t)(cursor->end - cursor->at);
    const char *stop = memchr(cursor->at, '\n', left);
    *line = (text_span){cursor->at, stop ? (size_t)(stop - cursor->at) : left};
    cursor->at = stop ? stop + 1 : cursor->end;
    cursor->line++;
    return true;
}

static text_span text_trim(text_span span)
{
    while (span.length > 0 && (text_blank(span.text[0]) || span.text[0] == '"')) {
        span.text++;
        span.length--;
    }
    while (span.length > 0 && (text_blank(span.text[span.length - 1]) || span.text[span.length - 1] == '"')) {
        span.length--;
    }
    return span;
}

bool text_next_field(text_span *line, bool *done, text_span *field)
{
    if (*done) {
        return false;
    }
    const char *comma = line->length > 0 ? memchr(line->text, ',', line->length) : NULL;
    size_t length = comma ? (size_t)(comma - line->text) : line->length;
    *field = text_trim((text_span){line->text, length});
    *done = !comma;
    if (comma) {
        line->text += length + 1;
        line->length -= length + 1;
    }
    return true;
}

bool text_is(text_span span, const char *word)
{
    return span.length == strlen(word) && strncasecmp(span.text, word, span.length) == 0;
}

/* Copies a span that looks like a number: nothing but digits and "+-.eE", so no "nan", "inf" or hexadecimals. */
static bool text_number(text_span span, char number[TEXT_MAX_NUMBER + 1])
{
    if (span.length == 0 || span.length > TEXT_MAX_NUMBER) {
        return false;
    }
    for (size_t i = 0; i < span.length; i++) {
        if (!isdigit((unsigned char)span.text[i]) && !(span.text[i] && strchr("+-.eE", span.text[i]))) {
            return false;
        }
    }
    memcpy(number, span.text, span.length);
    number[span.length] = '\0';
    return true;
}

bool text_real(text_span span, double *value)
{
    char number[TEXT_MAX_NUMBER + 1];
    if (!text_number(span, number)) {
        return false;
    }
    char *end = NULL;
    *value = strtod(number, &end);
    return *end == '\0' && isfinite(*value);
}

bool text_integer(text_span span, int64_t *value)
{
    char number[TEXT_MAX_NUMBER + 1];
    if (!text_number(span, number)) {
        return false;
    }
    char *end = NULL;
    errno = 0;
    *value = strtoll(number, &end, 10);
    return errno == 0 && *end == '\0';
}

int text_shown(text_span span)
{
    return span.length < TEXT_MAX_SHOWN ? (int)span.length : TEXT_MAX_SHOWN;
}
