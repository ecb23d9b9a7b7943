/* caller_watch.c: callers that move heads, and callers that watch them: see caller.h.
 *
 * A driver's step has a number, and its simulated time tells the viewers which step a frame shows: so the latency of a
 * frame counts from when its step was due, however the frame came to them. */
#include "load/caller_job.h"

#include "load/wait.h"

#include <string.h>

enum { STALLED_CREDIT = 1000 };

/* ---- drivers ----------------------------------------------------------------------------------------------------- */

static void driver_entered(caller *c)
{
    caller_attach(c, c->m.run->heads.heads[c->head].drive_token);
}

/* From now on its time goes by the daemon's clock. */
static void driver_free(caller *c)
{
    load_head *head = &c->m.run->heads.heads[c->head];
    proto_message clock = {.type = PROTO_SET_CLOCK};
    clock.as.set_clock.forest = head->forest;
    clock.as.set_clock.mode = 1;
    clock.as.set_clock.rate = 1;
    atomic_store(&head->freed_ns, wait_now_ns());
    caller_send(c, &clock);
}

static void driver_heard(caller *c, const proto_message *message)
{
    member_due due;
    if (message->type == PROTO_ATTACH_REPLY && c->m.run->plan->free) {
        driver_free(c);
        c->m.ready = true;
    } else if (message->type == PROTO_ATTACH_REPLY) {
        c->m.ready = true;
    } else if (message->type == PROTO_FRAME && member_answered(&c->m, message->request, &due)) {
        member_next(&c->m);
    }
}

static void driver_due(member *m, uint32_t slice, int64_t due_ns, int64_t now_ns)
{
    caller *c = (caller *)m;
    load_heads *heads = &m->run->heads;
    proto_message move, query;
    book_sent(&m->run->book, member_mode(m, slice), now_ns - due_ns, c->viewers);
    c->step++;
    proto_begin(&query, PROTO_QUERY);
    heads_fill_motion(heads, c->head, c->step, heads_time_us(heads, c->step), &move);
    query.as.query.forest = move.as.motion.forest;
    query.as.query.time_us = move.as.motion.time_us;
    query.as.query.kind = m->run->plan->kind;
    query.as.query.level = m->run->plan->level;
    steps_put(&heads->heads[c->head].steps[LOAD_DAEMON], c->step, slice, due_ns, now_ns);
    caller_send(c, &move);
    const uint64_t request = caller_send(c, &query);
    if (request != 0) {
        member_sent(m, request, slice, due_ns, now_ns);
    }
    caller_settle(c);
}

/* A pose for the present time, as the daemon's clock has it about. What holds still needs none. */
static void driver_pose(member *m, uint32_t slice, int64_t due_ns, int64_t now_ns)
{
    caller *c = (caller *)m;
    load_heads *heads = &m->run->heads;
    const load_head *head = &heads->heads[c->head];
    const int64_t time_us = (now_ns - atomic_load(&head->freed_ns)) / 1000;
    book_sent(&m->run->book, member_mode(m, slice), now_ns - due_ns, c->viewers);
    if (!head->still && time_us > c->pose_us) {
        proto_message move;
        heads_fill_motion(heads, c->head, ++c->step, time_us, &move);
        c->pose_us = time_us;
        caller_send(c, &move);
    }
    caller_settle(c);
}

member *caller_driver_create(load_run *run, uint32_t head, uint32_t viewers, int64_t phase_ns, int64_t period_ns)
{
    static const caller_job job = {.face = {.due = driver_due, .turn = caller_turn, .leave = caller_leave},
                                   .entered = driver_entered,
                                   .heard = driver_heard};
    static const caller_job free_job = {.face = {.due = driver_pose, .turn = caller_turn, .leave = caller_leave},
                                        .entered = driver_entered,
                                        .heard = driver_heard};
    caller *c = caller_create(run, run->plan->free ? &free_job : &job, head, phase_ns, period_ns);
    if (c) {
        c->viewers = viewers;
    }
    return caller_connected(c);
}

/* ---- viewers ----------------------------------------------------------------------------------------------------- */

static void viewer_entered(caller *c)
{
    caller_attach(c, c->m.run->heads.heads[c->head].view_token);
}

static void viewer_subscribe(caller *c)
{
    const load_plan *p = c->m.run->plan;
    proto_message subscribe = {.type = PROTO_SUBSCRIBE};
    subscribe.as.subscribe.forest = c->m.run->heads.heads[c->head].forest;
    subscribe.as.subscribe.kind = p->kind;
    subscribe.as.subscribe.level = p->level;
    subscribe.as.subscribe.credit = c->stalls ? STALLED_CREDIT : p->credit;
    subscribe.as.subscribe.deltas = p->deltas;
    subscribe.as.subscribe.greatest_rate = (uint16_t)(p->free ? p->rate + 0.5 : 0);
    c->request = caller_send(c, &subscribe);
}

/* Age on arrival: since the end of the step, as far as it can be told from here: since it was asked for, less the way
 * there, the wait for a worker and the step itself. */
static int64_t age_of(const caller *c, const struct proto_frame *frame, int64_t since_sent_ns)
{
    const int64_t before_ns =
        (int64_t)atomic_load(&c->m.run->heads.way_ns) + ((int64_t)frame->queue_us + (int64_t)frame->step_us) * 1000;
    return since_sent_ns > before_ns ? since_sent_ns - before_ns : 0;
}

/* Of a head that runs freely: from the moment that the frame shows, by the daemon's clock, to now. What comes in the
 * quiet part of a slice, in which nothing is due, does not count. */
static void viewer_measure_free(caller *c, const proto_message *message, int64_t freed_ns)
{
    const load_run *run = c->m.run;
    const struct proto_frame *frame = &message->as.frame;
    const int64_t now_ns = wait_now_ns(), way_ns = (int64_t)atomic_load(&run->heads.way_ns);
    const int64_t shown_ns = freed_ns + way_ns + frame->time_us * 1000, at_ns = now_ns - run->begin_ns;
    const uint32_t slice = timeline_slice_at(&run->line, at_ns);
    if (run->begin_ns > 0 && slice < run->line.slices && at_ns - slice * run->line.slice_ns < run->line.busy_ns) {
        book_answer(&c->m.run->book, member_mode(&c->m, slice), slice, now_ns - shown_ns,
                    (int64_t)frame->age_us * 1000 + way_ns, proto_encoded_size(message));
    }
}

static void viewer_measure(caller *c, const proto_message *message)
{
    const struct proto_frame *frame = &message->as.frame;
    const load_heads *heads = &c->m.run->heads;
    const int64_t now_ns = wait_now_ns();
    int64_t due_ns, sent_ns;
    uint32_t slice;
    if (frame->time_us >= 0 && steps_get(&heads->heads[c->head].steps[LOAD_DAEMON],
                                         (uint64_t)(frame->time_us / heads->step_us), &slice, &due_ns, &sent_ns)) {
        book_answer(&c->m.run->book, member_mode(&c->m, slice), slice, now_ns - due_ns,
                    age_of(c, frame, now_ns - sent_ns), proto_encoded_size(message));
    }
}

static void viewer_count(caller *c, const struct proto_frame *frame)
{
    enum { STALE = 1 };
    load_run *run = c->m.run;
    const uint32_t slice = timeline_slice_at(&run->line, wait_now_ns() - run->begin_ns);
    if (run->begin_ns > 0 && slice < run->line.slices) {
        const load_mode mode = member_mode(&c->m, slice);
        atomic_fetch_add_explicit(&run->book.skipped[mode], frame->skipped, memory_order_relaxed);
        atomic_fetch_add_explicit(&run->book.stale[mode], frame->flags & STALE, memory_order_relaxed);
    }
}

/* Gives back the credit of frames that have come: of a large window half of it in one message; of a small one, which is
 * as long as the way, and where deltas count on what is here, at once. */
enum { VIEWER_LARGE_WINDOW = 16 };

static void viewer_give_credit(caller *c, const struct proto_frame *frame)
{
    const load_plan *p = c->m.run->plan;
    c->spent++;
    if (!p->deltas && p->credit >= VIEWER_LARGE_WINDOW && 2 * c->spent < p->credit) {
        return;
    }
    proto_message credit;
    proto_begin(&credit, PROTO_CREDIT);
    credit.as.credit.subscription = c->subscription;
    credit.as.credit.frames = c->spent;
    credit.as.credit.have = frame->sequence;
    c->spent = 0;
    caller_send(c, &credit);
}

static void viewer_heard(caller *c, const proto_message *message)
{
    if (message->type == PROTO_ATTACH_REPLY) {
        viewer_subscribe(c);
    } else if (message->type == PROTO_SUBSCRIBE_REPLY) {
        c->subscription = message->as.subscribe_reply.subscription;
        c->m.ready = true;
    } else if (message->type == PROTO_FRAME && message->request == c->request) {
        const int64_t freed_ns = (int64_t)atomic_load(&c->m.run->heads.heads[c->head].freed_ns);
        if (freed_ns > 0) {
            viewer_measure_free(c, message, freed_ns);
        } else if (!c->stalls) {
            viewer_measure(c, message);
        }
        viewer_count(c, &message->as.frame);
        viewer_give_credit(c, &message->as.frame);
    }
}

static void viewer_tick(member *m, uint32_t slice)
{
    caller *c = (caller *)m;
    c->deaf = c->stalls && member_mode(m, slice) == LOAD_LADEN;
    caller_listen(c);
}

member *caller_viewer_create(load_run *run, uint32_t head, bool stalls)
{
    static const caller_job job = {.face = {.turn = caller_turn, .tick = viewer_tick, .leave = caller_leave},
                                   .entered = viewer_entered,
                                   .heard = viewer_heard};
    caller *c = caller_create(run, &job, head, 0, 0);
    if (c) {
        c->stalls = stalls;
    }
    return caller_connected(c);
}
