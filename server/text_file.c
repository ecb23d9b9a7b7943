/* text_file.c: see text_file.h. */
#include "text_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { OTHERS = 077 };

/* Up to `size` bytes; the number read, or -1 with errno. */
static ssize_t read_all(int fd, char *text, size_t size)
{
    size_t used = 0;
    for (ssize_t got = 1; got > 0 && used < size; used += (size_t)got) {
        do {
            got = read(fd, text + used, size - used);
        } while (got < 0 && errno == EINTR);
        if (got < 0) {
            return -1;
        }
    }
    return (ssize_t)used;
}

static bool check(const text_file *kind, int fd, const char *path, char *error, size_t error_size)
{
    struct stat about;
    if (fstat(fd, &about) != 0 || !S_ISREG(about.st_mode)) {
        snprintf(error, error_size, "the %s %s is not a plain file", kind->what, path);
        return false;
    }
    if (kind->secret && (about.st_mode & OTHERS)) {
        snprintf(error, error_size, "the %s %s is open to others than its owner; run: chmod 600 %s", kind->what, path,
                 path);
        return false;
    }
    return true;
}

static char *read_text(const text_file *kind, int fd, const char *path, char *error, size_t error_size)
{
    char *text = malloc(kind->greatest + 2);
    if (!text) {
        snprintf(error, error_size, "no memory for the %s %s", kind->what, path);
        return NULL;
    }
    const ssize_t size = read_all(fd, text, kind->greatest + 1); /* one more tells that it is too long */
    if (size < 0) {
        snprintf(error, error_size, "the %s %s cannot be read: %s", kind->what, path, strerror(errno));
    } else if ((size_t)size > kind->greatest) {
        snprintf(error, error_size, "the %s %s is longer than %zu bytes", kind->what, path, kind->greatest);
    } else if (memchr(text, '\0', (size_t)size)) {
        snprintf(error, error_size, "the %s %s is no text: there is a NUL in it", kind->what, path);
    } else {
        text[size] = '\0';
        return text;
    }
    free(text);
    return NULL;
}

char *text_file_read(const text_file *kind, const char *path, char *error, size_t error_size)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); /* a pipe in its place must not stop the start */
    if (fd < 0) {
        snprintf(error, error_size, "the %s %s cannot be opened: %s", kind->what, path, strerror(errno));
        return NULL;
    }
    char *text = check(kind, fd, path, error, error_size) ? read_text(kind, fd, path, error, error_size) : NULL;
    close(fd);
    return text;
}
