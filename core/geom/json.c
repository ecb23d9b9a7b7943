/* json.c: see json.h. */
#include "geom/json.h"

#include "base/error.h"
#include "geom/json_number.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct json_reader {
    json_document *document;
    const char *text;
    size_t size, at;
    uint32_t open[JSON_MAX_DEPTH]; /* the objects and arrays around the place */
    uint32_t depth;
    awt_status status;
} json_reader;

static bool refuse(json_reader *r, awt_status status)
{
    r->status = status;
    return false;
}

static void skip_space(json_reader *r)
{
    while (r->at < r->size && strchr(" \t\r\n", r->text[r->at]) && r->text[r->at]) {
        r->at++;
    }
}

/* The next character that is no space, 0 at the end. */
static char peek(json_reader *r)
{
    skip_space(r);
    return r->at < r->size ? r->text[r->at] : '\0';
}

static bool add_token(json_reader *r, json_kind kind, size_t begin, size_t end)
{
    json_document *d = r->document;
    if (d->count == d->capacity) {
        uint32_t capacity = d->capacity ? 2 * d->capacity : 256;
        json_token *larger = realloc(d->tokens, capacity * sizeof *larger);
        if (!larger) {
            return refuse(r, AWT_NO_MEMORY);
        }
        d->tokens = larger;
        d->capacity = capacity;
    }
    d->tokens[d->count] = (json_token){.begin = (uint32_t)begin, .end = (uint32_t)end, .after = d->count + 1};
    d->tokens[d->count].kind = (unsigned char)kind;
    d->count++;
    return true;
}

static bool take_string(json_reader *r)
{
    size_t begin = ++r->at;
    for (; r->at < r->size && r->text[r->at] != '"'; r->at++) {
        if ((unsigned char)r->text[r->at] < 0x20) {
            return refuse(r, AWT_BAD_FORMAT);
        }
        r->at += r->text[r->at] == '\\';
    }
    return r->at < r->size ? add_token(r, JSON_STRING, begin, r->at++) : refuse(r, AWT_BAD_FORMAT);
}

/* A number or one of true, false, null: whatever stands up to the next separator; json_real reads it strictly. */
static bool take_word(json_reader *r)
{
    size_t begin = r->at;
    while (r->at < r->size && (unsigned char)r->text[r->at] > 0x20 && !strchr(",:[]{}\"", r->text[r->at])) {
        r->at++;
    }
    size_t length = r->at - begin;
    const char *word = r->text + begin;
    if (length > 0 && (word[0] == '-' || (word[0] >= '0' && word[0] <= '9'))) {
        return add_token(r, JSON_NUMBER, begin, r->at);
    }
    bool literal = (length == 4 && (memcmp(word, "true", 4) == 0 || memcmp(word, "null", 4) == 0)) ||
                   (length == 5 && memcmp(word, "false", 5) == 0);
    return literal ? add_token(r, JSON_LITERAL, begin, r->at) : refuse(r, AWT_BAD_FORMAT);
}

/* A member's name and its colon, where the place is in an object. */
static bool take_name(json_reader *r)
{
    if (r->depth == 0 || r->document->tokens[r->open[r->depth - 1]].kind != JSON_OBJECT) {
        return true;
    }
    if (peek(r) != '"' || !take_string(r) || peek(r) != ':') {
        return refuse(r, r->status ? r->status : AWT_BAD_FORMAT);
    }
    r->at++;
    return true;
}

/* A value; of an object or array only its beginning: `opened` then. */
static bool take_value(json_reader *r, bool *opened)
{
    char c = peek(r);
    *opened = c == '{' || c == '[';
    if (c == '"') {
        return take_string(r);
    }
    if (!*opened) {
        return take_word(r);
    }
    if (r->depth == JSON_MAX_DEPTH) {
        return refuse(r, AWT_LIMIT);
    }
    r->open[r->depth++] = r->document->count;
    bool added = add_token(r, c == '{' ? JSON_OBJECT : JSON_ARRAY, r->at, r->at);
    r->at++;
    return added;
}

/* Closes what ends here. `more`: another member or item follows, a comma stood before it. */
static bool take_ends(json_reader *r, bool opened, bool *more)
{
    for (; r->depth > 0; opened = false) {
        json_token *around = &r->document->tokens[r->open[r->depth - 1]];
        char close = around->kind == JSON_OBJECT ? '}' : ']';
        char c = peek(r);
        if (opened && c != close) {
            *more = true;
            return true;
        }
        around->count += !opened;
        if (around->kind == JSON_OBJECT && around->count > JSON_MAX_MEMBERS) {
            return refuse(r, AWT_LIMIT);
        }
        if (c != close && c != ',') {
            return refuse(r, AWT_BAD_FORMAT);
        }
        r->at++;
        if (c == ',') {
            *more = true;
            return true;
        }
        around->after = r->document->count;
        around->end = (uint32_t)r->at;
        r->depth--;
    }
    *more = false;
    return true;
}

static bool read_all(json_reader *r)
{
    bool more = true, opened = false;
    while (more) {
        if (!take_name(r) || !take_value(r, &opened) || !take_ends(r, opened, &more)) {
            return false;
        }
    }
    skip_space(r);
    return r->at == r->size ? true : refuse(r, AWT_BAD_FORMAT);
}

awt_status json_read(const char *text, size_t size, json_document *out, awt_error *error)
{
    *out = (json_document){.text = text};
    json_reader reader = {.document = out, .text = text, .size = size};
    if (size > JSON_MAX_SIZE) {
        reader.status = AWT_LIMIT;
    } else if (read_all(&reader)) {
        return AWT_OK;
    }
    json_fini(out);
    return reader.status == AWT_NO_MEMORY
               ? error_set(error, AWT_NO_MEMORY, NULL)
               : error_set(error, reader.status, "the frame's JSON is %s at byte %u of %u",
                           reader.status == AWT_LIMIT ? "larger than any frame's" : "damaged", (unsigned)reader.at,
                           (unsigned)size);
}

void json_fini(json_document *document)
{
    free(document->tokens);
    *document = (json_document){0};
}

static bool is_kind(const json_document *d, uint32_t value, json_kind kind)
{
    return value != JSON_NONE && d->tokens[value].kind == kind;
}

bool json_is_text(const json_document *d, uint32_t value, const char *text)
{
    size_t length = strlen(text);
    return is_kind(d, value, JSON_STRING) && d->tokens[value].end - d->tokens[value].begin == length &&
           memcmp(d->text + d->tokens[value].begin, text, length) == 0;
}

bool json_hexadecimal(const json_document *d, uint32_t value, uint64_t *out)
{
    static const char digits[] = "0123456789abcdef";
    if (!is_kind(d, value, JSON_STRING) || d->tokens[value].end - d->tokens[value].begin != 16) {
        return false;
    }
    *out = 0;
    for (uint32_t at = d->tokens[value].begin; at < d->tokens[value].end; at++) {
        const char *digit = strchr(digits, d->text[at]);
        if (!digit || !*digit) {
            return false;
        }
        *out = *out << 4 | (uint64_t)(digit - digits);
    }
    return true;
}

uint32_t json_member(const json_document *d, uint32_t object, const char *name)
{
    if (!is_kind(d, object, JSON_OBJECT)) {
        return JSON_NONE;
    }
    for (uint32_t at = object + 1; at < d->tokens[object].after; at = d->tokens[at + 1].after) {
        if (json_is_text(d, at, name)) {
            return at + 1;
        }
    }
    return JSON_NONE;
}

uint32_t json_items(const json_document *d, uint32_t array)
{
    return is_kind(d, array, JSON_ARRAY) ? d->tokens[array].count : 0;
}

bool json_real(const json_document *d, uint32_t value, double *out)
{
    return is_kind(d, value, JSON_NUMBER) &&
           json_number(d->text + d->tokens[value].begin, d->text + d->tokens[value].end, out);
}

bool json_whole(const json_document *d, uint32_t value, uint32_t *out)
{
    double number;
    if (!json_real(d, value, &number) || !(number >= 0 && number < (double)UINT32_MAX)) {
        return false;
    }
    *out = (uint32_t)number;
    return (double)*out == number;
}

bool json_reals(const json_document *d, uint32_t array, uint32_t count, double *out)
{
    if (json_items(d, array) != count) {
        return false;
    }
    for (uint32_t i = 0; i < count; i++) {
        /* an item that is no number is refused, so each item is one token */
        if (!json_real(d, array + 1 + i, &out[i])) {
            return false;
        }
    }
    return true;
}
