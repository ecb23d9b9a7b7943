/* config_file.h: the text of a file of settings. */
#ifndef CONFIG_FILE_H
#define CONFIG_FILE_H

#include <stddef.h>

/* A plain file of at most LIMIT_CONFIG_FILE bytes, without NUL; on the heap. NULL: `error` says why. */
char *config_file_read(const char *path, char *error, size_t error_size);

#endif
