/* subscription.h: new frames of a forest to a session, as its credit allows.
 *
 * A frame waits in `waiting` until the session's output is empty, the credit is not, and the rate asked for has come
 * round again. A newer one takes its place and is counted as skipped: what a slow receiver gets is never old, and it
 * slows nobody. A frame that has been handed to the output is sent whole. */
#ifndef SUBSCRIPTION_H
#define SUBSCRIPTION_H

#include "registry.h"

struct session;

typedef struct subscription {
    uint64_t handle;  /* never used twice in its session; 0: this place is free */
    uint64_t request; /* SUBSCRIBE's, which its FRAMEs carry */
    struct session *session;
    resident *forest;
    struct subscription *next_of_forest;
    uint32_t credit, skipped;
    int64_t interval_us, due_us; /* 0: every frame */
    published *waiting;          /* a reference, or NULL */
} subscription;

/* Fills a free place. */
void subscription_begin(subscription *s, struct session *session, resident *forest, uint64_t handle, uint64_t request,
                        uint32_t credit, uint32_t greatest_rate);
/* Frees the place. */
void subscription_end(subscription *s);

/* A frame that came out of the forest: waits in every subscription on it. */
void subscriptions_offer(resident *forest, published *frame);

/* True if it may send its waiting frame now. */
bool subscription_is_due(const subscription *s, int64_t now_us);

/* Takes the waiting frame (the reference is the caller's) and pays for it; *skipped: frames left out before it. */
published *subscription_take(subscription *s, int64_t now_us, uint32_t *skipped);

/* More credit; stays at UINT32_MAX rather than overflow. */
void subscription_credit(subscription *s, uint32_t frames);

#endif
