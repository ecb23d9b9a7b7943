/* text.h: reading numbers and words out of text that need not be trusted or terminated. Private to motion. */
#ifndef MOTION_TEXT_H
#define MOTION_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Some bytes of the text; not terminated. */
typedef struct text_span {
    const char *text;
    size_t length;
} text_span;

typedef struct text_cursor {
    const char *at, *end;
    size_t line; /* from 1, for error texts */
} text_cursor;

/* At the first byte, behind a byte order mark where there is one. */
text_cursor text_begin(const void *bytes, size_t size);

/* The next run of bytes that are not white space. False at the end. */
bool text_next_word(text_cursor *cursor, text_span *word);
/* The next line without its line end, and on to the one after it. False at the end. */
bool text_next_line(text_cursor *cursor, text_span *line);
/* Cuts the next field off a comma-separated line, without surrounding white space or quotes. False when none is left.
 * `*done` begins as false and belongs to the function. */
bool text_next_field(text_span *line, bool *done, text_span *field);

/* True if the span says `word`, in upper or lower case. */
bool text_is(text_span span, const char *word);

/* A finite number in decimal notation. */
bool text_real(text_span span, double *value);
bool text_integer(text_span span, int64_t *value);

/* Length for a "%.*s", cut to what an error text can show. */
int text_shown(text_span span);

#endif
