/* text_file.h: the operator's files: settings, tokens, accounts. */
#ifndef TEXT_FILE_H
#define TEXT_FILE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct text_file {
    const char *what; /* "settings file": for errors */
    size_t greatest;  /* bytes */
    bool secret;      /* refused if others than its owner may read or write it */
} text_file;

/* The whole text of the plain file at `path`, NUL behind it; heap, the caller's. NULL: `error` (of `error_size` bytes)
 * says why: it cannot be opened or read, is not plain, open to others, too long, or has a NUL in it. */
char *text_file_read(const text_file *kind, const char *path, char *error, size_t error_size);

#endif
