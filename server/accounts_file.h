/* accounts_file.h: the file of accounts besides the owner's, readable by its owner alone:
 *
 *   # name  token (32 hexadecimal digits)     bounds, all of them optional
 *   studio  00112233445566778899aabbccddeeff  connections=8 forests=20 points=2000000 hair-mb=500 upload-mb=64
 *   wall    ffeeddccbbaa99887766554433221100  views-only messages-per-s=200
 */
#ifndef ACCOUNTS_FILE_H
#define ACCOUNTS_FILE_H

#include "accounts.h"

/* Reads it whole. False: `error` (of `error_size` bytes) says in which line and what. */
bool accounts_file_read(const char *path, account_list *out, char *error, size_t error_size);

/* The same of a text, which is changed; `path` is for errors. */
bool accounts_file_parse(char *text, const char *path, account_list *out, char *error, size_t error_size);

#endif
