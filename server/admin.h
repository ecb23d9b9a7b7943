/* admin.h: the operator's thread: answers HTTP at an address of its own, and has settings read again on SIGHUP.
 *
 * It waits for nothing that clients or simulation hold up, so that /livez and /metrics answer when they do not. Nobody
 * there has shown a token: a request is small or refused, a connection has LIMIT_ADMIN_US from its first byte to the
 * last of its answer, and of LIMIT_ADMIN_CONNECTIONS the oldest makes room for the next. */
#ifndef ADMIN_H
#define ADMIN_H

#include <stdbool.h>

typedef struct admin admin;

typedef struct admin_def {
    int listener;                  /* taken; -1: no HTTP */
    void (*reload)(void *context); /* called on the thread after each SIGHUP, or several */
    void *context;
} admin_def;

/* Starts the thread; SIGHUP is its own from now on. Once in a process at a time. NULL: no memory, no thread or no
 * descriptors; the listener is closed then. */
admin *admin_create(const admin_def *def);
/* Ends the thread, and what it is about. Accepts NULL. */
void admin_destroy(admin *a);

#endif
