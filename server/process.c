/* process.c: see process.h. Where there is a /proc as on Linux, it tells what POSIX has no call for. */
#include "process.h"

#include <dirent.h>
#include <stdio.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

static double started_s = -1;

static double seconds_of(clockid_t clock)
{
    struct timespec now;
    return clock_gettime(clock, &now) == 0 ? (double)now.tv_sec + (double)now.tv_nsec * 1e-9 : -1;
}

void process_note_start(void)
{
    started_s = seconds_of(CLOCK_REALTIME);
}

static double count_descriptors(void)
{
    DIR *open_ones = opendir("/proc/self/fd");
    if (!open_ones) {
        return -1;
    }
    int count = -3; /* ".", ".." and the folder's own */
    while (readdir(open_ones)) {
        count++;
    }
    closedir(open_ones);
    return count < 0 ? -1 : count;
}

static double greatest_descriptors(void)
{
    struct rlimit limit;
    return getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY ? (double)limit.rlim_cur : -1;
}

static double resident_bytes(void)
{
    FILE *file = fopen("/proc/self/statm", "r");
    unsigned long whole = 0, resident = 0;
    int read = file ? fscanf(file, "%lu %lu", &whole, &resident) : 0;
    if (file) {
        fclose(file);
    }
    return read == 2 ? (double)resident * (double)sysconf(_SC_PAGESIZE) : -1;
}

process_figures process_look(void)
{
    return (process_figures){.processor_s = seconds_of(CLOCK_PROCESS_CPUTIME_ID),
                             .started_s = started_s,
                             .descriptors = count_descriptors(),
                             .descriptors_greatest = greatest_descriptors(),
                             .memory_bytes = resident_bytes()};
}
