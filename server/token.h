/* token.h: the token file: made on first start, readable by its owner alone, found by local clients by themselves. */
#ifndef TOKEN_H
#define TOKEN_H

#include "auth.h"

#include <stdbool.h>
#include <stddef.h>

/* Makes `directory` and those above it that are missing, for the owner alone. False: `error` says which and why. */
bool token_make_directory(const char *directory, char *error, size_t error_size);

/* Reads the token from the file at `path`, making it first if there is none. A file that others may read or write is
 * refused. False: `error` (of `error_size` bytes) says what is wrong and what to do. */
bool token_open(const char *path, uint8_t token[AUTH_TOKEN_SIZE], char *error, size_t error_size);

/* Whether token_open would read or make it, as far as that is known without making anything; `makes_directory`: after
 * token_make_directory. False: `error` says why not. */
bool token_check(const char *path, bool makes_directory, char *error, size_t error_size);

#endif
