/* vault.c: see vault.h. */
#include "vault.h"
#include "disk.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { VAULT_PATH = LIMIT_PATH + 64, FOLDER_MODE = 0700, FILE_MODE = 0600, HANDLE_DIGITS = 16 };

static const char folder_name[] = "/forests";
static const char whole[] = ".forest", part[] = ".part", aside[] = ".bad";

static void path_of(const vault *v, uint64_t handle, const char *ending, char path[VAULT_PATH])
{
    snprintf(path, VAULT_PATH, "%s/%016" PRIx64 "%s", v->folder, handle, ending);
}

/* The handle in the name of a file with that ending; 0: it is another file's. */
static uint64_t handle_of(const char *name, const char *ending)
{
    if (strlen(name) != HANDLE_DIGITS + strlen(ending) || strcmp(name + HANDLE_DIGITS, ending) != 0 ||
        strspn(name, "0123456789abcdef") < HANDLE_DIGITS) {
        return 0;
    }
    return strtoull(name, NULL, 16);
}

/* ---- writing ----------------------------------------------------------------------------------------------------- */

static int create(const char *path)
{
    return open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, FILE_MODE);
}

/* Writes and brings to the disk. The folder is made again where somebody has removed it. */
static bool write_file(const vault *v, const char *path, const void *bytes, size_t size)
{
    int fd = create(path);
    if (fd < 0 && errno == ENOENT && mkdir(v->folder, FOLDER_MODE) == 0) {
        fd = create(path);
    }
    if (fd < 0) {
        return false;
    }
    bool written = disk_write(fd, bytes, size);
    int why = errno;
    written = close(fd) == 0 && written;
    if (!written) {
        unlink(path);
        errno = why;
    }
    return written;
}

/* A renamed file stays renamed through a loss of power only when its folder is on the disk. */
static bool sync_folder(const vault *v)
{
    int fd = open(v->folder, O_RDONLY | O_CLOEXEC);
    if (fd < 0) {
        return false;
    }
    bool synced = fsync(fd) == 0 || errno == EINVAL; /* some file systems have nothing to do there */
    int why = errno;
    close(fd);
    errno = why;
    return synced;
}

bool vault_write(const vault *v, uint64_t handle, const void *bytes, size_t size)
{
    char place[VAULT_PATH], beside[VAULT_PATH];
    path_of(v, handle, whole, place);
    path_of(v, handle, part, beside);
    if (!write_file(v, beside, bytes, size)) {
        return false;
    }
    if (rename(beside, place) != 0) {
        int why = errno;
        unlink(beside);
        errno = why;
        return false;
    }
    return sync_folder(v);
}

bool vault_remove(const vault *v, uint64_t handle)
{
    char place[VAULT_PATH];
    path_of(v, handle, whole, place);
    return unlink(place) == 0 || errno == ENOENT || errno == ENOTDIR;
}

void vault_set_aside(const vault *v, uint64_t handle)
{
    char place[VAULT_PATH], away[VAULT_PATH];
    path_of(v, handle, whole, place);
    path_of(v, handle, aside, away);
    rename(place, away);
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

static bool each_file(const vault *v, const char *ending, bool (*found)(void *context, uint64_t handle), void *context)
{
    DIR *folder = opendir(v->folder);
    if (!folder) {
        return false;
    }
    bool goes_on = true;
    for (struct dirent *entry; goes_on && (entry = readdir(folder)) != NULL;) {
        uint64_t handle = handle_of(entry->d_name, ending);
        goes_on = handle == 0 || found(context, handle);
    }
    closedir(folder);
    return true;
}

bool vault_list(const vault *v, bool (*found)(void *context, uint64_t handle), void *context)
{
    return each_file(v, whole, found, context);
}

static unsigned char *read_all(int fd, size_t size)
{
    unsigned char *bytes = malloc(size > 0 ? size : 1);
    size_t done = 0;
    errno = bytes ? errno : ENOMEM; /* the compiler takes malloc to leave it alone */
    while (bytes && done < size) {
        ssize_t got = read(fd, bytes + done, size - done);
        if (got == 0 || (got < 0 && errno != EINTR)) {
            errno = got == 0 ? EIO : errno;
            free(bytes);
            return NULL;
        }
        done += got > 0 ? (size_t)got : 0;
    }
    return bytes;
}

unsigned char *vault_read(const vault *v, uint64_t handle, size_t *size)
{
    char place[VAULT_PATH];
    struct stat about;
    path_of(v, handle, whole, place);
    int fd = open(place, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0) {
        return NULL;
    }
    unsigned char *bytes = NULL;
    if (fstat(fd, &about) == 0) {
        errno = S_ISREG(about.st_mode) ? EFBIG : EINVAL;
        if (S_ISREG(about.st_mode) && about.st_size >= 0 && (uint64_t)about.st_size <= LIMIT_SAVED_BYTES) {
            *size = (size_t)about.st_size;
            bytes = read_all(fd, *size);
        }
    }
    int why = errno;
    close(fd);
    errno = why;
    return bytes;
}

/* ---- the folder -------------------------------------------------------------------------------------------------- */

static bool remove_part(void *context, uint64_t handle)
{
    char path[VAULT_PATH];
    path_of(context, handle, part, path);
    unlink(path);
    return true;
}

bool vault_open(vault *v, const char *state_directory, char *error, size_t error_size)
{
    if (strlen(state_directory) + sizeof folder_name > sizeof v->folder) {
        snprintf(error, error_size, "the state directory's path is longer than %zu bytes",
                 sizeof v->folder - sizeof folder_name);
        return false;
    }
    snprintf(v->folder, sizeof v->folder, "%s%s", state_directory, folder_name);
    if (mkdir(v->folder, FOLDER_MODE) != 0 && errno != EEXIST) {
        snprintf(error, error_size, "%s cannot be made: %s", v->folder, strerror(errno));
        return false;
    }
    if (access(v->folder, R_OK | W_OK | X_OK) != 0 || !each_file(v, part, remove_part, v)) {
        snprintf(error, error_size, "%s cannot be written: %s; give another --state-dir", v->folder, strerror(errno));
        return false;
    }
    return true;
}
