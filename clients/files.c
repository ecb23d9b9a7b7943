/* files.c: see files.h. */
#include "files.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FILES_MAX_PATH = 4096 };

/* Reads to the end, however long the file is or becomes meanwhile. NULL: see errno; EFBIG beyond the limit. */
static unsigned char *files_drain(FILE *file, size_t limit, size_t *size)
{
    size_t capacity = 1 << 16, used = 0;
    unsigned char *bytes = malloc(capacity);
    while (bytes) {
        used += fread(bytes + used, 1, capacity - used, file);
        if (used < capacity) {
            break;
        }
        capacity *= 2;
        unsigned char *larger = used <= limit ? realloc(bytes, capacity) : NULL;
        if (!larger) {
            errno = used > limit ? EFBIG : ENOMEM;
            free(bytes);
            return NULL;
        }
        bytes = larger;
    }
    if (bytes && (ferror(file) || used > limit)) {
        errno = used > limit ? EFBIG : errno;
        free(bytes);
        return NULL;
    }
    *size = used;
    return bytes;
}

unsigned char *files_read(const char *path, size_t limit, size_t *size, char *error, size_t error_size)
{
    FILE *file = fopen(path, "rb");
    unsigned char *bytes = file ? files_drain(file, limit, size) : NULL;
    if (!bytes) {
        snprintf(error, error_size, "%s cannot be read: %s", path, strerror(errno));
    }
    if (file) {
        fclose(file);
    }
    return bytes;
}

bool files_write(const char *path, const void *bytes, size_t size, char *error, size_t error_size)
{
    char beside[FILES_MAX_PATH];
    FILE *file = NULL;
    int length = snprintf(beside, sizeof beside, "%s.%ld.part", path, (long)getpid());
    errno = ENAMETOOLONG;
    if (length < 0 || (size_t)length >= sizeof beside || !(file = fopen(beside, "wb"))) {
        goto fail;
    }
    bool written = fwrite(bytes, 1, size, file) == size;
    if (fclose(file) != 0 || !written || rename(beside, path) != 0) {
        int why = errno;
        unlink(beside);
        errno = why;
        goto fail;
    }
    return true;
fail:
    snprintf(error, error_size, "%s cannot be written: %s", path, strerror(errno));
    return false;
}

bool files_make_folder(const char *path, char *error, size_t error_size)
{
    char part[FILES_MAX_PATH];
    struct stat found;
    size_t length = strlen(path);
    errno = ENAMETOOLONG;
    if (length == 0 || length >= sizeof part) {
        goto fail;
    }
    for (size_t i = 1; i <= length; i++) {
        if (path[i] != '/' && path[i] != '\0') {
            continue;
        }
        memcpy(part, path, i);
        part[i] = '\0';
        if (mkdir(part, 0777) != 0 && errno != EEXIST) {
            goto fail;
        }
    }
    if (stat(path, &found) == 0 && S_ISDIR(found.st_mode)) {
        return true;
    }
    errno = ENOTDIR;
fail:
    snprintf(error, error_size, "the folder %s cannot be made: %s", path, strerror(errno));
    return false;
}
