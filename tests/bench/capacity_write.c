/* capacity_write.c: what it costs to hand a frame to a socket: see capacity.h. */
#include "bench/capacity.h"

#include "quantile.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <pthread.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

enum { WRITE_REPEATS = 41 };

/* Two ends of a TCP connection. */
static bool connection(int ends[2])
{
    struct sockaddr_in place = {.sin_family = AF_INET};
    socklen_t size = sizeof place;
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    int listener = socket(AF_INET, SOCK_STREAM, 0);
    ends[0] = socket(AF_INET, SOCK_STREAM, 0);
    ends[1] = -1;
    if (listener >= 0 && bind(listener, (struct sockaddr *)&place, size) == 0 && listen(listener, 1) == 0 &&
        getsockname(listener, (struct sockaddr *)&place, &size) == 0 &&
        connect(ends[0], (struct sockaddr *)&place, size) == 0) {
        ends[1] = accept(listener, NULL, NULL);
    }
    if (listener >= 0) {
        close(listener);
    }
    if (ends[1] < 0 && ends[0] >= 0) {
        close(ends[0]);
    }
    return ends[1] >= 0;
}

static void *reader_run(void *descriptor)
{
    char bytes[65536];
    while (recv(*(int *)descriptor, bytes, sizeof bytes, 0) > 0) {
    }
    return NULL;
}

static bool write_all(int descriptor, const char *bytes, size_t size)
{
    while (size > 0) {
        ssize_t sent = send(descriptor, bytes, size, MSG_NOSIGNAL);
        if (sent <= 0) {
            return false;
        }
        bytes += sent;
        size -= (size_t)sent;
    }
    return true;
}

double capacity_write_ms(size_t bytes)
{
    double times[WRITE_REPEATS], median = -1;
    int ends[2];
    pthread_t reader;
    char *frame = calloc(1, bytes);
    if (!frame || !connection(ends)) {
        free(frame);
        return -1;
    }
    if (pthread_create(&reader, NULL, reader_run, &ends[1]) == 0) {
        bool good = true;
        for (int n = 0; n < WRITE_REPEATS && good; n++) {
            double begin = bench_thread_ms();
            good = write_all(ends[0], frame, bytes);
            times[n] = bench_thread_ms() - begin;
        }
        shutdown(ends[0], SHUT_WR);
        pthread_join(reader, NULL);
        quantile_sort(times, good ? WRITE_REPEATS : 0);
        median = good ? quantile_at(times, WRITE_REPEATS, 0.5) : -1;
    }
    close(ends[0]);
    close(ends[1]);
    free(frame);
    return median;
}
