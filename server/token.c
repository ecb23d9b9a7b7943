/* token.c: see token.h.
 *
 * The file comes into being whole: it is written under a temporary name and linked to its own, which fails where
 * another daemon was faster; then that one's token is read like any other. */
#include "token.h"
#include "disk.h"
#include "limits.h"
#include "random.h"
#include "text_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { TOKEN_FILE_MODE = 0600, TOKEN_DIRECTORY_MODE = 0700 };

bool token_make_directory(const char *directory, char *error, size_t error_size)
{
    char path[LIMIT_PATH];
    size_t length = strlen(directory);
    if (length == 0 || length >= sizeof path) {
        snprintf(error, error_size, "the state directory's path is empty or longer than %d bytes", LIMIT_PATH - 1);
        return false;
    }
    memcpy(path, directory, length + 1);
    for (size_t i = 1; i <= length; i++) {
        if (path[i] != '/' && path[i] != '\0') {
            continue;
        }
        char end = path[i];
        path[i] = '\0';
        if (mkdir(path, TOKEN_DIRECTORY_MODE) != 0 && errno != EEXIST) {
            snprintf(error, error_size, "the state directory %s cannot be made: %s", path, strerror(errno));
            return false;
        }
        path[i] = end;
    }
    return true;
}

/* Writes a new token under `temporary`, which must not exist. */
static bool write_token(const char *temporary)
{
    uint8_t token[AUTH_TOKEN_SIZE];
    char text[AUTH_TOKEN_TEXT + 1];
    if (!random_fill(token, sizeof token)) {
        return false;
    }
    auth_token_format(token, text);
    text[AUTH_TOKEN_TEXT - 1] = '\n';
    int fd = open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, TOKEN_FILE_MODE);
    if (fd < 0) {
        return false;
    }
    /* fchmod: a umask may have taken rights from the owner too */
    bool written = fchmod(fd, TOKEN_FILE_MODE) == 0 && disk_write(fd, text, AUTH_TOKEN_TEXT);
    int reason = errno;
    if (close(fd) != 0 || !written) {
        unlink(temporary);
        errno = reason;
        return false;
    }
    return true;
}

/* Gives the finished file its name unless that is taken. Some file systems have no links: rename, there. */
static bool name_token(const char *temporary, const char *path)
{
    if (link(temporary, path) == 0 || errno == EEXIST) {
        unlink(temporary);
        return true;
    }
    if (rename(temporary, path) == 0) {
        return true;
    }
    int reason = errno;
    unlink(temporary);
    errno = reason;
    return false;
}

static bool make_token(const char *path, char *error, size_t error_size)
{
    char temporary[LIMIT_PATH + 32];
    snprintf(temporary, sizeof temporary, "%s.%ld", path, (long)getpid());
    unlink(temporary); /* left behind by a process of the same number that was killed here */
    if (!write_token(temporary) || !name_token(temporary, path)) {
        snprintf(error, error_size, "the token file %s cannot be made: %s", path, strerror(errno));
        return false;
    }
    return true;
}

bool token_open(const char *path, uint8_t token[AUTH_TOKEN_SIZE], char *error, size_t error_size)
{
    static const text_file kind = {.what = "token file", .greatest = LIMIT_TOKEN_FILE, .secret = true};
    if (access(path, F_OK) != 0 && errno == ENOENT && !make_token(path, error, error_size)) {
        return false;
    }
    char *text = text_file_read(&kind, path, error, error_size);
    const bool taken = text && auth_token_parse(text, token);
    if (text && !taken) {
        snprintf(error, error_size,
                 "the token file %s does not hold 32 hexadecimal digits; remove it and a new one is made", path);
    }
    free(text);
    return taken;
}

/* Cuts the last name off, or leaves "/" or ".". False: it is one of them. */
static bool cut_name(char *path)
{
    char *slash = strrchr(path, '/');
    if (strcmp(path, "/") == 0 || strcmp(path, ".") == 0) {
        return false;
    }
    if (!slash) {
        memcpy(path, ".", 2);
    } else {
        slash[slash == path] = '\0';
    }
    return true;
}

bool token_check(const char *path, bool makes_directory, char *error, size_t error_size)
{
    uint8_t token[AUTH_TOKEN_SIZE];
    char above[LIMIT_PATH];
    if (access(path, F_OK) == 0) {
        return token_open(path, token, error, error_size);
    }
    snprintf(above, sizeof above, "%s", path);
    bool cut = cut_name(above);
    while (makes_directory && cut && access(above, F_OK) != 0 && errno == ENOENT) {
        cut = cut_name(above);
    }
    if (access(above, W_OK | X_OK) != 0) {
        snprintf(error, error_size, "the token file %s cannot be made: in %s: %s", path, above, strerror(errno));
        return false;
    }
    return true;
}
