/* disk.c: see disk.h. */
#include "disk.h"

#include <errno.h>
#include <unistd.h>

bool disk_write(int fd, const void *bytes, size_t size)
{
    const unsigned char *from = bytes;
    size_t done = 0;
    while (done < size) {
        ssize_t wrote = write(fd, from + done, size - done);
        if (wrote < 0 && errno != EINTR) {
            return false;
        }
        done += wrote > 0 ? (size_t)wrote : 0;
    }
    return fsync(fd) == 0;
}
