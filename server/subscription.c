/* subscription.c: see subscription.h. */
#include "subscription.h"
#include "base/assert.h"

void subscription_begin(subscription *s, struct session *session, resident *forest, uint64_t handle, uint64_t request,
                        uint32_t credit, uint32_t greatest_rate)
{
    ASSERT(s->handle == 0);
    *s = (subscription){.handle = handle,
                        .request = request,
                        .session = session,
                        .forest = forest,
                        .next_of_forest = forest->subscriptions,
                        .credit = credit,
                        .interval_us = greatest_rate ? 1000000 / (int64_t)greatest_rate : 0};
    forest->subscriptions = s;
    forest->subscription_count++;
}

void subscription_end(subscription *s)
{
    subscription **link = &s->forest->subscriptions;
    while (*link != s) {
        link = &(*link)->next_of_forest;
    }
    *link = s->next_of_forest;
    s->forest->subscription_count--;
    published_release(s->waiting);
    *s = (subscription){0};
}

void subscriptions_offer(resident *forest, published *frame)
{
    for (subscription *s = forest->subscriptions; s; s = s->next_of_forest) {
        s->skipped += s->waiting != NULL;
        published_release(s->waiting);
        s->waiting = published_hold(frame);
    }
}

bool subscription_is_due(const subscription *s, int64_t now_us)
{
    return s->handle && s->waiting && s->credit > 0 && now_us >= s->due_us;
}

published *subscription_take(subscription *s, int64_t now_us, uint32_t *skipped)
{
    published *frame = s->waiting;
    *skipped = s->skipped;
    s->waiting = NULL;
    s->skipped = 0;
    s->credit--;
    s->due_us = s->interval_us ? now_us + s->interval_us : 0;
    return frame;
}

void subscription_credit(subscription *s, uint32_t frames)
{
    s->credit = frames > UINT32_MAX - s->credit ? UINT32_MAX : s->credit + frames;
}
