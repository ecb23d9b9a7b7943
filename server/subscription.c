/* subscription.c: see subscription.h. */
#include "subscription.h"
#include "metrics.h"
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
                        .deltas = def->deltas,
                        .budget = def->budget};
    forest->subscriptions = s;
    forest->subscription_count++;
    metrics_add(METRIC_SUBSCRIPTIONS, 1);
}

void subscription_end(subscription *s)
{
    subscription **link = &s->forest->subscriptions;
    while (*link != s) {
        link = &(*link)->next_of_forest;
    }
    *link = s->next_of_forest;
    s->forest->subscription_count--;
    metrics_add(METRIC_SUBSCRIPTIONS, -1);
    picture_release(s->waiting);
    *s = (subscription){0};
}

/* ---- views ------------------------------------------------------------------------------------------------------- */

static bool makes_deltas(const subscription *s, int form)
{
    return s->deltas && form_at(form)->has_deltas;
}

/* The newest frame of that form that a delta can be made against; 0: none. */
static uint64_t newest_base(const subscription *s, int number)
{
    return makes_deltas(s, number) ? bases_at(&s->bases, number, 0) : 0;
}

/* The form asked for, or what is made instead while there is too much to do. */
static int richest(const subscription *s)
{
    int form = s->form;
    for (uint32_t n = 0; n < s->forest->lowered.coarser && form_at(form)->poorer != FORM_NONE; n++) {
        form = form_at(form)->poorer;
    }
    return form;
}

static void wish(const subscription *s, int number, wishes *out)
{
    wishes_add(out, (view_name){.form = number, .base = newest_base(s, number)});
    out->keeps[number] = out->keeps[number] || makes_deltas(s, number);
}

static bool is_known(const resident *forest, const form_size *last)
{
    return last->sequence != 0 && forest->sequence - last->sequence < LIMIT_SIZE_FRAMES;
}

/* The richest form whose last frame fits, and the poorest where none does; on the way there all whose size is not known
 * any more, to be measured. */
static void wish_within_budget(const subscription *s, wishes *out)
{
    for (int i = richest(s); i != FORM_NONE; i = form_at(i)->poorer) {
        const form_size *whole = &s->forest->whole[i], *delta = &s->forest->delta[i];
        const form_size *last = newest_base(s, i) && is_known(s->forest, delta) ? delta : whole;
        const bool known = is_known(s->forest, last), fits = known && last->bytes <= s->budget;
        if (!known || fits || form_at(i)->poorer == FORM_NONE) {
            wish(s, i, out);
        }
        if (fits) {
            return;
        }
    }
}

void subscriptions_wish(const resident *forest, bool steps, wishes *out)
{
    for (const subscription *s = forest->subscriptions; s; s = s->next_of_forest) {
        if (!steps && (!s->waiting || subscription_view(s))) {
            continue;
        }
        if (forest->clock.mode == CLOCK_FREE && s->credit == 0) {
            continue; /* more frames will come without being asked for */
        }
        if (s->budget > 0) {
            wish_within_budget(s, out);
        } else {
            wish(s, richest(s), out);
        }
    }
}

int64_t subscriptions_interval_us(const resident *forest)
{
    int64_t shortest_us = 0;
    for (const subscription *s = forest->subscriptions; s; s = s->next_of_forest) {
        const int64_t interval_us = s->interval_us > AWT_STEP_US ? s->interval_us : AWT_STEP_US;
        if (s->credit > 0 && (shortest_us == 0 || interval_us < shortest_us)) {
            shortest_us = interval_us;
        }
    }
    return shortest_us * (int64_t)forest->lowered.thin;
}

/* The newest delta of a form that the receiver can use, else the whole frame; NULL: the picture has neither. */
static const view *view_of_form(const subscription *s, int number)
{
    uint64_t base = 0;
    for (uint32_t n = 0; makes_deltas(s, number) && (base = bases_at(&s->bases, number, n)) != 0; n++) {
        const view *v = picture_view(s->waiting, (view_name){.form = number, .base = base});
        if (v) {
            return v;
        }
    }
    return picture_view(s->waiting, (view_name){.form = number});
}

const view *subscription_view(const subscription *s)
{
    if (s->budget == 0) {
        return view_of_form(s, richest(s));
    }
    const view *least = NULL;
    for (int i = richest(s); i != FORM_NONE; i = form_at(i)->poorer) {
        const view *v = view_of_form(s, i);
        if (v && v->glb.size <= s->budget) {
            return v;
        }
        least = v && (!least || v->glb.size < least->glb.size) ? v : least;
    }
    return least;
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
        const bool skips = s->waiting && !again;
        s->skipped += skips;
        metrics_count(METRIC_FRAMES_SKIPPED, skips);
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
    /* A frame that went out a little late does not delay the next: so the rate is held. */
    const int64_t next_us = s->due_us + s->interval_us;
    s->due_us = s->interval_us == 0 ? 0 : next_us > now_us ? next_us : now_us + s->interval_us;
    bases_sent(&s->bases, taken->figures.sequence, v->name.form, v->name.base);
    return taken;
}

void subscription_credit(subscription *s, uint32_t frames)
{
    s->credit = frames > UINT32_MAX - s->credit ? UINT32_MAX : s->credit + frames;
}
