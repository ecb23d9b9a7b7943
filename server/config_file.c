/* config_file.c: see config_file.h. */
#include "config_file.h"
#include "limits.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

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

static char *read_text(int fd, const char *path, char *error, size_t error_size)
{
    struct stat about;
    if (fstat(fd, &about) != 0 || !S_ISREG(about.st_mode)) {
        snprintf(error, error_size, "the settings file %s is not a plain file", path);
        return NULL;
    }
    char *text = malloc(LIMIT_CONFIG_FILE + 2);
    if (!text) {
        snprintf(error, error_size, "no memory for the settings file %s", path);
        return NULL;
    }
    const ssize_t size = read_all(fd, text, LIMIT_CONFIG_FILE + 1); /* one more tells that it is too long */
    if (size < 0) {
        snprintf(error, error_size, "the settings file %s cannot be read: %s", path, strerror(errno));
    } else if (size > LIMIT_CONFIG_FILE) {
        snprintf(error, error_size, "the settings file %s is longer than %d bytes", path, LIMIT_CONFIG_FILE);
    } else if (memchr(text, '\0', (size_t)size)) {
        snprintf(error, error_size, "the settings file %s is no text: there is a NUL in it", path);
    } else {
        text[size] = '\0';
        return text;
    }
    free(text);
    return NULL;
}

char *config_file_read(const char *path, char *error, size_t error_size)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); /* a pipe in its place must not stop the start */
    if (fd < 0) {
        snprintf(error, error_size, "the settings file %s cannot be opened: %s", path, strerror(errno));
        return NULL;
    }
    char *text = read_text(fd, path, error, error_size);
    close(fd);
    return text;
}
