/* promises.h: answers that a session was promised by a deadline (STEP_MANY). What is not there by then is answered
 * with the latest frame, and the step's own frame answers nobody any more. */
#ifndef PROMISES_H
#define PROMISES_H

#include <stdbool.h>
#include <stdint.h>

typedef struct promise {
    struct promise *next;
    uint64_t request, forest;
    int form;
    int64_t deadline_us; /* monotonic clock */
} promise;

/* A list of promises is NULL where there are none. False: no memory. */
bool promises_make(promise **list, const promise *made);
/* The answer is there. False: it comes too late, the promise was broken. */
bool promises_keep(promise **list, uint64_t request, uint64_t forest);
/* Takes one whose deadline has passed: it is broken. False: there is none. */
bool promises_break(promise **list, int64_t now_us, promise *broken);
/* The next deadline; INT64_MAX: there is none. */
int64_t promises_due_us(const promise *list);
/* Forgets all. */
void promises_free(promise **list);

#endif
