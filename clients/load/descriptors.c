/* descriptors.c: see descriptors.h. */
#include "load/descriptors.h"

#include <sys/resource.h>
#include <unistd.h>

uint32_t descriptors_raise(void)
{
    struct rlimit limit;
    if (getrlimit(RLIMIT_NOFILE, &limit) == 0) {
        limit.rlim_cur = limit.rlim_max;
        setrlimit(RLIMIT_NOFILE, &limit);
    }
    const long open = sysconf(_SC_OPEN_MAX);
    return open < 0 || open > 1000000 ? 1000000 : (uint32_t)open;
}
