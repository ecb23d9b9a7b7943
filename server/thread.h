/* thread.h: threads that leave signals to the main one. */
#ifndef THREAD_H
#define THREAD_H

#include <pthread.h>
#include <stdbool.h>

/* Starts a thread with all signals blocked. False: the system has none left. */
bool thread_start(pthread_t *thread, void *(*run)(void *argument), void *argument);

#endif
