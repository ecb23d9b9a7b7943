/* subscription.h: new frames of a forest to a session, as its credit allows.
 *
 * A picture waits in `waiting` until the session's output is empty, the credit is not, and the rate asked for has come
 * round again. A newer one takes its place and is counted as skipped: what a slow receiver gets is never old, and it
 * slows nobody. Which view of it is sent is decided when it goes out: the newest delta that the receiver can use, else
 * the whole frame; within a budget, the richest form that fits. Where the picture has nothing for it, the forest is
 * asked once to draw it. A frame that has been handed to the output is sent whole. */
#ifndef SUBSCRIPTION_H
#define SUBSCRIPTION_H

#include "bases.h"
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
    int form;                    /* asked for; within a budget the richest */
    bool deltas;                 /* frames may be deltas */
    uint32_t budget;             /* bytes of a frame; 0: none */
    bases bases;                 /* what the receiver has */
    picture *waiting;            /* a reference, or NULL */
    uint64_t asked_for;          /* sequence of the last picture that it wanted drawn again; 0: none */
} subscription;

typedef struct subscription_def {
    uint64_t handle, request;
    uint32_t credit, greatest_rate;
    int form;
    bool deltas;
    uint32_t budget;
} subscription_def;

/* Fills a free place. */
void subscription_begin(subscription *s, struct session *session, resident *forest, const subscription_def *def);
/* Frees the place. */
void subscription_end(subscription *s);

/* Adds what the forest's subscriptions want of its next step, or, where the next job `steps` not, of the picture that
 * they wait with and that lacks their view. */
void subscriptions_wish(const resident *forest, bool steps, wishes *out);

/* The shortest interval between frames that one of them wants which has credit; 0: none has. */
int64_t subscriptions_interval_us(const resident *forest);

/* A picture that came out of the forest: waits in every subscription on it. One of the same step as the last goes to
 * those alone that still wait with that. */
void subscriptions_offer(resident *forest, picture *offered);

/* True if nothing but the right view keeps it from sending now. */
bool subscription_is_due(const subscription *s, int64_t now_us);
/* The view of its waiting picture that it can use; NULL: there is none. */
const view *subscription_view(const subscription *s);
/* True once for each step: the view is missing, and the forest should be asked for it. */
bool subscription_asks(subscription *s);

/* Takes the waiting picture (the reference is the caller's) of which `v` goes out, and pays for it; *skipped: frames
 * left out before it. */
picture *subscription_take(subscription *s, const view *v, int64_t now_us, uint32_t *skipped);

/* More credit; stays at UINT32_MAX rather than overflow. */
void subscription_credit(subscription *s, uint32_t frames);

#endif
