/* read_hierarchy.c: a hierarchy file, text that people write by hand or by a few lines of script:
 *
 *     # tree, wisp, lock
 *     0, 3, 17
 *     0, 3, 18
 *     1, 4, 19
 *
 * Read twice: first to check every line and count them, then, with memory for exactly what there is, to keep them. */
#include "awt.h"

#include "base/error.h"

#include <stdlib.h>
#include <string.h>

typedef struct hierarchy_text {
    const unsigned char *at, *end;
    unsigned long line; /* counted from 1 */
} hierarchy_text;

static hierarchy_text text_begin(const void *bytes, size_t size)
{
    static const unsigned char mark[3] = {0xEF, 0xBB, 0xBF}; /* some editors put it before UTF-8 */
    hierarchy_text text = {.at = bytes, .end = (const unsigned char *)bytes + size};
    if (size >= sizeof mark && memcmp(text.at, mark, sizeof mark) == 0) {
        text.at += sizeof mark;
    }
    return text;
}

static bool is_between(unsigned char c)
{
    return c == ' ' || c == '\t' || c == ',' || c == ';' || c == '\r';
}

/* A whole number at text->at; goes behind it. */
static awt_status take_number(hierarchy_text *text, uint32_t *out, awt_error *error)
{
    uint64_t number = 0;
    const unsigned char *first = text->at;
    while (text->at < text->end && *text->at >= '0' && *text->at <= '9' && number <= UINT32_MAX) {
        number = 10 * number + (uint64_t)(*text->at++ - '0');
    }
    bool ends = text->at == text->end || *text->at == '\n' || *text->at == '#' || is_between(*text->at);
    if (text->at == first || !ends || number > UINT32_MAX) {
        return error_set(error, AWT_BAD_VALUE,
                         "line %lu of the hierarchy: a wisp's number is a whole number from 0 to 4294967295",
                         text->line);
    }
    *out = (uint32_t)number;
    return AWT_OK;
}

/* The next line that says something. *count is 0 at the end of the text. */
static awt_status take_line(hierarchy_text *text, uint32_t numbers[AWT_MAX_LEVELS], uint32_t *count, awt_error *error)
{
    *count = 0;
    while (text->at < text->end && *count == 0) {
        text->line++;
        while (text->at < text->end && *text->at != '\n' && *text->at != '#') {
            if (is_between(*text->at)) {
                text->at++;
                continue;
            }
            if (*count == AWT_MAX_LEVELS) {
                return error_set(error, AWT_LIMIT,
                                 "line %lu of the hierarchy has more than %d numbers; that is the "
                                 "limit for levels",
                                 text->line, AWT_MAX_LEVELS);
            }
            awt_status status = take_number(text, &numbers[(*count)++], error);
            if (status != AWT_OK) {
                return status;
            }
        }
        const unsigned char *newline = memchr(text->at, '\n', (size_t)(text->end - text->at));
        text->at = newline ? newline + 1 : text->end;
    }
    return AWT_OK;
}

/* Checks every line and counts. */
static awt_status count_lines(hierarchy_text text, awt_hierarchy *counts, awt_error *error)
{
    uint32_t numbers[AWT_MAX_LEVELS], count;
    for (;;) {
        awt_status status = take_line(&text, numbers, &count, error);
        if (status != AWT_OK || count == 0) {
            return status;
        }
        if (counts->strand_count == 0) {
            counts->levels = count;
        }
        if (count != counts->levels) {
            return error_set(error, AWT_BAD_VALUE,
                             "line %lu of the hierarchy has %lu numbers where the first has %lu: one for each level",
                             text.line, (unsigned long)count, (unsigned long)counts->levels);
        }
        if (counts->strand_count == AWT_MAX_STRANDS) {
            return error_set(error, AWT_LIMIT, "the hierarchy has more than %d lines; that is the limit for strands",
                             AWT_MAX_STRANDS);
        }
        counts->strand_count++;
    }
}

/* Keeps what count_lines counted. */
static void keep_lines(hierarchy_text text, awt_hierarchy *out)
{
    uint32_t numbers[AWT_MAX_LEVELS], count;
    for (uint32_t s = 0; s < out->strand_count; s++) {
        take_line(&text, numbers, &count, NULL);
        memcpy(out->wisps + (size_t)s * out->levels, numbers, out->levels * sizeof *numbers);
    }
}

awt_status awt_hierarchy_read(const void *bytes, size_t size, awt_hierarchy *out, awt_error *error)
{
    awt_hierarchy hierarchy = {0};
    awt_status status = count_lines(text_begin(bytes, size), &hierarchy, error);
    if (status != AWT_OK) {
        return status;
    }
    if (hierarchy.strand_count == 0) {
        return error_set(error, AWT_BAD_VALUE, "the hierarchy has no line with the wisps of a strand");
    }
    hierarchy.wisps = malloc((size_t)hierarchy.strand_count * hierarchy.levels * sizeof *hierarchy.wisps);
    if (!hierarchy.wisps) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    keep_lines(text_begin(bytes, size), &hierarchy);
    *out = hierarchy;
    return AWT_OK;
}

void awt_hierarchy_fini(awt_hierarchy *hierarchy)
{
    free(hierarchy->wisps);
    *hierarchy = (awt_hierarchy){0};
}
