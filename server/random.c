/* random.c: see random.h. */
#include "random.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static int source = -1; /* under the lock; never closed */

static int open_source(void)
{
    pthread_mutex_lock(&lock);
    if (source < 0) {
        source = open("/dev/urandom", O_RDONLY | O_CLOEXEC);
    }
    const int fd = source;
    pthread_mutex_unlock(&lock);
    return fd;
}

bool random_open(void)
{
    return open_source() >= 0;
}

bool random_fill(void *bytes, size_t size)
{
    const int fd = open_source();
    size_t done = 0;
    while (fd >= 0 && done < size) {
        ssize_t got = read(fd, (unsigned char *)bytes + done, size - done);
        if (got <= 0 && !(got < 0 && errno == EINTR)) {
            break;
        }
        done += got > 0 ? (size_t)got : 0;
    }
    return done == size;
}
