/* files.h: whole files in and out. */
#ifndef CLIENTS_FILES_H
#define CLIENTS_FILES_H

#include <stdbool.h>
#include <stddef.h>

/* Reads a file of at most `limit` bytes into heap memory. NULL: `error` says why. */
unsigned char *files_read(const char *path, size_t limit, size_t *size, char *error, size_t error_size);

/* Writes a file whole or not at all: under another name in the same folder first, then renamed. */
bool files_write(const char *path, const void *bytes, size_t size, char *error, size_t error_size);

/* Makes a folder, and those it is in, where they are missing. */
bool files_make_folder(const char *path, char *error, size_t error_size);

#endif
