/* threads.c: see threads.h. */
#include "threads.h"

#include <signal.h>
#include <stddef.h>

bool threads_start(pthread_t *thread, void *(*run)(void *argument), void *argument)
{
    sigset_t all, before; /* a thread inherits the mask that stands while it is made */
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int failed = pthread_create(thread, NULL, run, argument);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return failed == 0;
}
