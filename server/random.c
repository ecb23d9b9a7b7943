/* random.c: see random.h. */
#include "random.h"

#include <errno.h>
#include <fcntl.h>
#include <unistd.h>

bool random_fill(void *bytes, size_t size)
{
    int fd = open("/dev/urandom", O_RDONLY | O_CLOEXEC);
    if (fd < 0) {
        return false;
    }
    size_t done = 0;
    while (done < size) {
        ssize_t got = read(fd, (unsigned char *)bytes + done, size - done);
        if (got <= 0 && !(got < 0 && errno == EINTR)) {
            break;
        }
        done += got > 0 ? (size_t)got : 0;
    }
    close(fd);
    return done == size;
}
