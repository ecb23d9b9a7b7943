/* session_frames.c: QUERY, BINDING, SUBSCRIBE, UNSUBSCRIBE, CREDIT: what comes out of a forest. (What a worker has to
 * do first is answered in completions.c.) */
#include "handlers.h"
#include "turns.h"

/* True if a field that says yes or no does so, else an ERROR was sent. */
static bool is_yes_or_no(session *s, const proto_message *message, const char *name, uint8_t value)
{
    if (value > 1) {
        session_error(s, message->type, message->request, PROTO_ERROR_BAD_VALUE, "%s is %u; it is 0 or 1", name,
                      (unsigned)value);
    }
    return value <= 1;
}

/* The form asked for; FORM_NONE: an ERROR was sent. */
static int find_form(session *s, const proto_message *message, uint8_t kind, uint8_t level, uint8_t deltas,
                     uint8_t attributes)
{
    if (!is_yes_or_no(s, message, "deltas", deltas) || !is_yes_or_no(s, message, "attributes", attributes)) {
        return FORM_NONE;
    }
    if (kind > FORM_KIND_GREATEST || level > FORM_LEVEL_GREATEST) {
        session_error(s, message->type, message->request, PROTO_ERROR_BAD_VALUE,
                      "kind is %u and level %u; the greatest are %d and %d", (unsigned)kind, (unsigned)level,
                      FORM_KIND_GREATEST, FORM_LEVEL_GREATEST);
        return FORM_NONE;
    }
    int found = form_find(kind, level, (deltas ? FORM_DELTAS : 0) | (attributes ? FORM_ATTRIBUTES : 0));
    if (found == FORM_NONE) {
        session_error(
            s, message->type, message->request, PROTO_ERROR_NOT_SUPPORTED,
            "there are no frames of kind %u at level %u%s; guides and nodes have level 0 (full) alone, and no "
            "attributes",
            (unsigned)kind, (unsigned)level, attributes ? " with attributes" : "");
    }
    return found;
}

/* Has a worker answer. */
static void push(session *s, const proto_message *message, resident *r, forest_input *input)
{
    if (session_push(s, message, r, input)) {
        s->pending++;
    }
}

/* True if the latest frame is as new as a frame of that forest can be: those that run by the daemon's clock are shown
 * now and then where nobody looks, and a QUERY is somebody who does. */
static bool is_fresh(const session *s, const resident *r)
{
    const int64_t now_us = sim_clock_at(&r->clock, s->shared->options.clock_us());
    return r->clock.mode != CLOCK_FREE || now_us - r->shown_us <= 2 * AWT_STEP_US;
}

/* An ERROR says so where the forest is not the driver's to advance. */
static bool may_advance(session *s, const proto_message *message, const resident *r)
{
    if (r->clock.mode != CLOCK_LOCK_STEP) {
        session_error(s, message->type, message->request, PROTO_ERROR_BAD_TIME,
                      "the forest %s: ask for the latest, or put it in lock-step with SET_CLOCK",
                      r->clock.mode == CLOCK_FREE ? "runs by the daemon's clock" : "is paused");
        return false;
    }
    return true;
}

/* One of several: answered by the deadline with what there is. */
static void step_one(session *s, const proto_message *message, const struct proto_step_request *one, int form)
{
    resident *r = session_resident(s, message, one->forest, true);
    if (!r || !may_advance(s, message, r)) {
        return;
    }
    const int64_t deadline_us = s->shared->options.clock_us() + (int64_t)message->as.step_many.deadline_us;
    const promise made = {.request = message->request, .forest = one->forest, .form = form, .deadline_us = deadline_us};
    forest_input *input = promises_make(&s->promised, &made) ? session_input(s, message, FOREST_QUERY) : NULL;
    if (input) {
        input->as.query.time_us = one->time_us;
        input->as.query.form = form;
        input->as.query.deadline_us = deadline_us;
        input->as.query.promised = one->forest;
    }
    if (session_push(s, message, r, input)) {
        s->pending++;
    } else {
        promises_keep(&s->promised, message->request, one->forest);
    }
}

void session_step_many(session *s, const proto_message *message)
{
    const struct proto_step_many *many = &message->as.step_many;
    if (many->forests.count == 0) {
        session_error(s, message->type, message->request, PROTO_ERROR_BAD_VALUE, "there is no forest in the list");
        return;
    }
    const int form = find_form(s, message, many->kind, many->level, 0, many->attributes);
    for (uint16_t i = 0; form != FORM_NONE && i < many->forests.count; i++) {
        step_one(s, message, &many->forests.items[i], form);
    }
}

void session_query(session *s, const proto_message *message)
{
    const struct proto_query *query = &message->as.query;
    resident *r = session_resident(s, message, query->forest, !query->latest);
    int form = r ? find_form(s, message, query->kind, query->level, 0, query->attributes) : FORM_NONE;
    if (form == FORM_NONE) {
        return;
    }
    if (!query->latest && !may_advance(s, message, r)) {
        return;
    }
    const view *v = query->latest ? picture_view(r->latest, (view_name){.form = form}) : NULL;
    const bool stale = v && !is_fresh(s, r) && turns_is_late(r, s->shared->options.clock_us());
    if (stale) {
        session_stale_picture(s, r->latest, v, message->request);
        return;
    }
    if (v && is_fresh(s, r)) {
        session_picture(s, r->latest, v, message->request);
        return;
    }
    forest_input *input = session_input(s, message, query->latest ? FOREST_LATEST : FOREST_QUERY);
    if (input) {
        input->as.query.time_us = query->time_us;
        input->as.query.form = form;
    }
    push(s, message, r, input);
}

void session_binding(session *s, const proto_message *message)
{
    const struct proto_binding *binding = &message->as.binding;
    resident *r = session_resident(s, message, binding->forest, false);
    if (!r || find_form(s, message, GEOM_GUIDES, binding->level, 0, 0) == FORM_NONE) {
        return;
    }
    if (r->binding) {
        session_picture(s, r->binding, &r->binding->views[0], message->request);
    } else {
        push(s, message, r, session_input(s, message, FOREST_BINDING));
    }
}

void session_subscribe(session *s, const proto_message *message)
{
    const struct proto_subscribe *subscribe = &message->as.subscribe;
    resident *r = session_resident(s, message, subscribe->forest, false);
    int form = r ? find_form(s, message, subscribe->kind, subscribe->level, subscribe->deltas, subscribe->attributes)
                 : FORM_NONE;
    if (form == FORM_NONE) {
        return;
    }
    subscription *place = session_subscription_place(s);
    if (!s->subscriptions) {
        session_error(s, message->type, message->request, PROTO_ERROR_NO_MEMORY, NULL);
        return;
    }
    if (!place) {
        session_error(s, message->type, message->request, PROTO_ERROR_LIMIT,
                      "a connection has %d subscriptions at most", LIMIT_SESSION_SUBSCRIPTIONS);
        return;
    }
    const subscription_def def = {.handle = ++s->subscription_serial,
                                  .request = message->request,
                                  .credit = subscribe->credit,
                                  .greatest_rate = subscribe->greatest_rate,
                                  .form = form,
                                  .deltas = subscribe->deltas,
                                  .budget = subscribe->budget};
    subscription_begin(place, s, r, &def);
    proto_message reply = {.type = PROTO_SUBSCRIBE_REPLY, .request = message->request};
    reply.as.subscribe_reply.subscription = place->handle;
    session_send(s, &reply);
    turns_attend(&s->shared->forests, r);
}

/* The subscription that the message names; NULL: an ERROR was sent. */
static subscription *find(session *s, const proto_message *message, uint64_t handle)
{
    subscription *sub = session_subscription(s, handle);
    if (!sub) {
        session_error(s, message->type, message->request, PROTO_ERROR_NO_SUBSCRIPTION, NULL);
    }
    return sub;
}

void session_unsubscribe(session *s, const proto_message *message)
{
    subscription *sub = find(s, message, message->as.unsubscribe.subscription);
    if (sub) {
        subscription_end(sub);
    }
}

void session_credit(session *s, const proto_message *message)
{
    subscription *sub = find(s, message, message->as.credit.subscription);
    if (!sub) {
        return;
    }
    if (sub->deltas && !bases_acknowledge(&sub->bases, message->as.credit.have)) {
        session_error(s, message->type, message->request, PROTO_ERROR_BAD_VALUE,
                      "frame %llu was never sent on this subscription", (unsigned long long)message->as.credit.have);
        return;
    }
    const bool had_none = sub->credit == 0;
    subscription_credit(sub, message->as.credit.frames);
    session_stream(s);
    if (had_none) {
        turns_attend(&s->shared->forests, sub->forest);
    }
}
