/* threads.h: threads beside the main one, which alone takes signals. */
#ifndef THREADS_H
#define THREADS_H

#include <pthread.h>
#include <stdbool.h>

/* Starts one with all signals blocked. False: there are no more. */
bool threads_start(pthread_t *thread, void *(*run)(void *argument), void *argument);

#endif
