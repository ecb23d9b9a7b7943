/* json.h: a small JSON reader for the JSON chunk of a frame from a source that need not be trusted.
 *
 * The text becomes one flat array of tokens in the order of the text; an object's members are pairs of a string and a
 * value. Memory is at most 16 bytes for each value of the text, depth and members are limited, nothing recurses. */
#ifndef GEOM_JSON_H
#define GEOM_JSON_H

#include "awt.h"

enum {
    JSON_MAX_SIZE = 4 * 1024 * 1024, /* bytes of text */
    JSON_MAX_DEPTH = 24,
    JSON_MAX_MEMBERS = 64 /* of one object */
};

/* What a search that found nothing returns: no token is at this place. */
#define JSON_NONE UINT32_MAX

typedef enum json_kind { JSON_OBJECT, JSON_ARRAY, JSON_STRING, JSON_NUMBER, JSON_LITERAL } json_kind;

typedef struct json_token {
    uint32_t begin;      /* place in the text; of a string: after the quote */
    uint32_t end;        /* of a string: the closing quote (escapes are left as they stand) */
    uint32_t after;      /* the token after this value and everything in it */
    uint32_t count : 24; /* members or items; text size and so counts are below 2^24 */
    uint32_t kind : 8;
} json_token;

typedef struct json_document {
    const char *text;
    json_token *tokens; /* [count], heap: json_fini; token 0 is the whole */
    uint32_t count, capacity;
} json_document;

/* Reads `size` bytes of text, which must outlive the document. AWT_BAD_FORMAT, AWT_LIMIT, AWT_NO_MEMORY. */
awt_status json_read(const char *text, size_t size, json_document *out, awt_error *error);
void json_fini(json_document *document);

/* All of these take JSON_NONE or a value of another kind and then find nothing. */

/* The value of an object's member. */
uint32_t json_member(const json_document *document, uint32_t object, const char *name);
/* Whether a value is the string `text`. */
bool json_is_text(const json_document *document, uint32_t value, const char *text);
/* A string of exactly 16 hexadecimal digits, the highest first, letters small. */
bool json_hexadecimal(const json_document *document, uint32_t value, uint64_t *out);
/* An array's items; 0 for anything else. */
uint32_t json_items(const json_document *document, uint32_t array);
/* A number that is whole and in 0 .. 2^32-2. */
bool json_whole(const json_document *document, uint32_t value, uint32_t *out);
/* A finite number. */
bool json_real(const json_document *document, uint32_t value, double *out);
/* An array of exactly `count` finite numbers. */
bool json_reals(const json_document *document, uint32_t array, uint32_t count, double *out);

#endif
