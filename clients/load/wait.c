/* wait.c: see wait.h. */
#if defined(__linux__)
#define _GNU_SOURCE /* ppoll, which POSIX has only since 2024, and prctl's timer slack */
#endif

#include "load/wait.h"

#include <time.h>

#if defined(__linux__)
#include <signal.h>
#include <sys/prctl.h>
#endif

int64_t wait_now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

#if defined(__linux__)

void wait_exactly(void)
{
    prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
}

int wait_poll(struct pollfd *polls, nfds_t count, int64_t until_ns)
{
    const int64_t left = until_ns - wait_now_ns();
    const struct timespec wait = {left > 0 ? (time_t)(left / 1000000000) : 0, left > 0 ? (long)(left % 1000000000) : 0};
    return ppoll(polls, count, &wait, NULL);
}

#else

void wait_exactly(void)
{
}

int wait_poll(struct pollfd *polls, nfds_t count, int64_t until_ns)
{
    const int64_t left = until_ns - wait_now_ns();
    const int64_t ms = left > 0 ? left / 1000000 : 0;
    return poll(polls, count, ms > 60000 ? 60000 : (int)ms);
}

#endif
