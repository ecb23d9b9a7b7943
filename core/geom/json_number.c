/* json_number.c: see json_number.h. */
#include "geom/json_number.h"

#include <locale.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* Passes over one digit or more. */
static bool pass_digits(const char **at, const char *end)
{
    const char *begin = *at;
    while (*at < end && **at >= '0' && **at <= '9') {
        (*at)++;
    }
    return *at > begin;
}

static bool pass(const char **at, const char *end, const char *any)
{
    bool there = *at < end && strchr(any, **at) && **at;
    *at += there;
    return there;
}

/* Whether the text is a number as JSON has them; `point` is where its decimal point stands, or NULL. */
static bool is_number(const char *at, const char *end, const char **point)
{
    *point = NULL;
    pass(&at, end, "-");
    if (!pass_digits(&at, end)) {
        return false;
    }
    if (pass(&at, end, ".")) {
        *point = at - 1;
        if (!pass_digits(&at, end)) {
            return false;
        }
    }
    if (pass(&at, end, "eE")) {
        pass(&at, end, "+-");
        if (!pass_digits(&at, end)) {
            return false;
        }
    }
    return at == end;
}

/* By strtod, which wants the decimal point of the host program's locale. */
bool json_number(const char *begin, const char *end, double *out)
{
    enum { MOST_NUMBER = 64, MOST_POINT = 8 };
    const char *point, *asked = localeconv()->decimal_point;
    char text[MOST_NUMBER + MOST_POINT];
    const size_t length = (size_t)(end - begin), wide = strlen(asked);
    if (length >= MOST_NUMBER || wide > MOST_POINT || !is_number(begin, end, &point)) {
        return false;
    }
    size_t before = point ? (size_t)(point - begin) : length, at = before;
    memcpy(text, begin, before);
    if (point) {
        memcpy(text + before, asked, wide);
        at = before + wide;
        memcpy(text + at, point + 1, length - before - 1);
        at += length - before - 1;
    }
    text[at] = '\0';
    *out = strtod(text, NULL);
    return isfinite(*out);
}
