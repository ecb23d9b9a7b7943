/* subscription.c: see subscription.h. */
#include "subscription.h"
#include "base/assert.h"

void subscription_begin(subscription *s, struct session *session, resident *forest, const subscription_def *def)
{
    ASSERT(s->handle == 0);
    *s = (subscription){.handle = def->handle,
                        .request = def->request,
                        .session = session,
                        .forest = forest,
                        .next_of_forest = forest->subscriptions,
                        .credit = def->credit,
                        .interval_us = def->greatest_rate ? 1000000 / (int64_t)def->greatest_rate : 0,
                        .form = def->form,
                        .deltas = def->deltas};
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
    picture_release(s->waiting);
    *s = (subscription){0};
}

/* ---- views ------------------------------------------------------------------------------------------------------- */

static bool makes_deltas(const subscription *s, int form)
{
    return s->deltas && form_at(form)->has_deltas;
}

void subscriptions_wish(const resident *forest, bool steps, wishes *out)
{
    for (const subscription *s = forest->subscriptions; s; s = s->next_of_forest) {
        if (!steps && (!s->waiting || subscription_view(s))) {
            continue;
        }
        const bool deltas = makes_deltas(s, s->form);
        wishes_add(out, (view_name){.form = s->form, .base = deltas ? bases_at(&s->bases, s->form, 0) : 0});
        out->keeps[s->form] = out->keeps[s->form] || deltas;
    }
}

const view *subscription_view(const subscription *s)
{
    uint64_t base = 0;
    for (uint32_t n = 0; makes_deltas(s, s->form) && (base = bases_at(&s->bases, s->form, n)) != 0; n++) {
        const view *v = picture_view(s->waiting, (view_name){.form = s->form, .base = base});
        if (v) {
            return v;
        }
    }
    return picture_view(s->waiting, (view_name){.form = s->form});
}

bool subscription_asks(subscription *s)
{
    const uint64_t sequence = s->waiting->figures.sequence;
    const bool asks = s->asked_for != sequence;
    s->asked_for = sequence;
    return asks;
}

/* ---- frames ------------------------------------------------------------------------------------------------------ */

void subscriptions_offer(resident *forest, picture *offered)
{
    for (subscription *s = forest->subscriptions; s; s = s->next_of_forest) {
        const bool again = s->waiting && s->waiting->figures.sequence == offered->figures.sequence;
        if (offered->earlier && !again) {
            continue;
        }
        s->skipped += s->waiting && !again;
        picture_release(s->waiting);
        s->waiting = picture_hold(offered);
    }
}

bool subscription_is_due(const subscription *s, int64_t now_us)
{
    return s->handle && s->waiting && s->credit > 0 && now_us >= s->due_us;
}

picture *subscription_take(subscription *s, const view *v, int64_t now_us, uint32_t *skipped)
{
    picture *taken = s->waiting;
    *skipped = s->skipped;
    s->waiting = NULL;
    s->skipped = 0;
    s->credit--;
    s->due_us = s->interval_us ? now_us + s->interval_us : 0;
    bases_sent(&s->bases, taken->figures.sequence, v->name.form, v->name.base);
    return taken;
}

void subscription_credit(subscription *s, uint32_t frames)
{
    s->credit = frames > UINT32_MAX - s->credit ? UINT32_MAX : s->credit + frames;
}
