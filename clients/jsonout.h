/* jsonout.h: writing JSON, a value at a time, straight to a file.
 *
 * What is written is always one well-formed document or jsonout_done says false: keys only in objects, values without a
 * key only in arrays, everything closed. (geom/json.h reads JSON; this only writes.) Texts are escaped, and bytes that
 * are not UTF-8 become U+FFFD; numbers that JSON does not know become null. */
#ifndef CLIENTS_JSONOUT_H
#define CLIENTS_JSONOUT_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum { JSONOUT_MAX_DEPTH = 16 };

typedef struct jsonout {
    FILE *file;
    bool compact; /* from now on no line breaks: for short arrays and rows */
    bool failed, finished;
    unsigned depth;
    struct {
        bool array, filled;
    } open[JSONOUT_MAX_DEPTH];
} jsonout;

/* The file stays the caller's. */
jsonout jsonout_begin(FILE *file);
/* True if one whole document stands in the file and no write failed. Ends the last line. */
bool jsonout_done(jsonout *j);

/* `key` is NULL in arrays and for the document itself. */
void jsonout_object(jsonout *j, const char *key);
void jsonout_array(jsonout *j, const char *key);
/* Closes the innermost object or array. */
void jsonout_close(jsonout *j);

void jsonout_text(jsonout *j, const char *key, const char *text); /* NULL: null */
void jsonout_real(jsonout *j, const char *key, double value);     /* reads back as the same double */
void jsonout_float(jsonout *j, const char *key, float value);     /* reads back as the same float */
void jsonout_integer(jsonout *j, const char *key, int64_t value);
void jsonout_unsigned(jsonout *j, const char *key, uint64_t value);
void jsonout_bool(jsonout *j, const char *key, bool value);
/* An array of `count` numbers, on one line. */
void jsonout_reals(jsonout *j, const char *key, const double *values, size_t count);

#endif
