/* caller_ask.c: callers that ask for the latest frame of a head: some stay, some come and go: see caller.h. */
#include "load/caller_job.h"

#include "load/wait.h"

#include <stdlib.h>
#include <string.h>

enum { MAKER_STRANDS = 200 };

/* An answer to what was due, with the frame's age: when it was written, and half of the way there and back. */
static void take_frame(caller *c, const proto_message *message)
{
    const int64_t now_ns = wait_now_ns();
    member_due due;
    if (!member_answered(&c->m, message->request, &due)) {
        return;
    }
    const int64_t age_ns = (int64_t)message->as.frame.age_us * 1000 + (now_ns - due.sent_ns) / 2;
    book_answer(&c->m.run->book, member_mode(&c->m, due.slice), due.slice, now_ns - due.due_ns, age_ns,
                proto_encoded_size(message));
}

/* ---- those who stay ---------------------------------------------------------------------------------------------- */

static void asker_entered(caller *c)
{
    caller_attach(c, c->m.run->heads.heads[c->head].view_token);
}

static void asker_heard(caller *c, const proto_message *message)
{
    if (message->type == PROTO_ATTACH_REPLY) {
        c->m.ready = true;
    } else if (message->type == PROTO_FRAME) {
        take_frame(c, message);
        member_next(&c->m);
    }
}

static void asker_due(member *m, uint32_t slice, int64_t due_ns, int64_t now_ns)
{
    caller *c = (caller *)m;
    book_sent(&m->run->book, member_mode(m, slice), now_ns - due_ns, 1);
    const uint64_t request = caller_query(c, m->run->heads.heads[c->head].forest);
    if (request != 0) {
        member_sent(m, request, slice, due_ns, now_ns);
    }
    caller_settle(c);
}

member *caller_asker_create(load_run *run, uint32_t head, int64_t phase_ns, int64_t period_ns)
{
    static const caller_job job = {.face = {.due = asker_due, .turn = caller_turn, .leave = caller_leave},
                                   .entered = asker_entered,
                                   .heard = asker_heard};
    return caller_connected(caller_create(run, &job, head, phase_ns, period_ns));
}

/* ---- those who come and go --------------------------------------------------------------------------------------- */

/* A visit is over. What was due meanwhile follows at once. */
static void visitor_go(caller *c)
{
    member_due due;
    member_answered(&c->m, c->visit, &due); /* where it failed */
    caller_disconnect(c);
    c->visit++;
    if (c->m.waiting_count > 0 && !caller_connect(c)) {
        c->m.waiting_count = 0;
    }
}

/* The requests that a visitor writes down are its visits, counted from 1; `step` is the last one that was due. */
static void visitor_due(member *m, uint32_t slice, int64_t due_ns, int64_t now_ns)
{
    caller *c = (caller *)m;
    const bool busy = m->waiting_count > 0;
    if (c->viewers > 0) { /* it is measured */
        book_sent(&m->run->book, member_mode(m, slice), now_ns - due_ns, 1);
    }
    if (!member_sent(m, c->step + 1, slice, due_ns, now_ns)) {
        return;
    }
    c->step++;
    if (!busy) {
        c->visit = c->step;
        if (!caller_connect(c)) {
            m->waiting_count = 0;
        }
    }
}

static void visitor_entered(caller *c)
{
    if (caller_attach(c, c->m.run->heads.heads[c->head].view_token) != 0) {
        caller_query(c, c->m.run->heads.heads[c->head].forest);
    }
}

static void visitor_heard(caller *c, const proto_message *message)
{
    if (message->type == PROTO_FRAME) {
        proto_message frame = *message;
        frame.request = c->visit;
        take_frame(c, &frame);
        visitor_go(c);
    }
}

static void visitor_refused(caller *c, uint64_t request)
{
    (void)request;
    visitor_go(c);
}

member *caller_visitor_create(load_run *run, uint32_t head, int64_t phase_ns, int64_t period_ns)
{
    static const caller_job job = {.face = {.due = visitor_due, .turn = caller_turn, .leave = caller_leave},
                                   .entered = visitor_entered,
                                   .heard = visitor_heard,
                                   .refused = visitor_refused};
    caller *c = caller_create(run, &job, head, phase_ns, period_ns);
    if (c) {
        c->m.ready = true;
        c->viewers = 1;
    }
    return c ? &c->m : NULL;
}

/* ---- one that makes a head each time ----------------------------------------------------------------------------- */

static void maker_entered(caller *c)
{
    proto_message create;
    heads_fill_create(&c->m.run->heads, c->m.run->plan, MAKER_STRANDS, &create);
    caller_send(c, &create);
}

static void maker_heard(caller *c, const proto_message *message)
{
    if (message->type == PROTO_CREATE_REPLY) {
        proto_message query = {.type = PROTO_QUERY};
        c->forest = message->as.create_reply.forest;
        query.as.query.forest = c->forest;
        query.as.query.time_us = c->m.run->heads.step_us;
        query.as.query.kind = c->m.run->plan->kind;
        query.as.query.level = c->m.run->plan->level;
        caller_send(c, &query);
    } else if (message->type == PROTO_FRAME) {
        proto_message destroy = {.type = PROTO_DESTROY};
        destroy.as.destroy.forest = c->forest;
        caller_send(c, &destroy);
    } else if (message->type == PROTO_DESTROY_REPLY) {
        visitor_go(c);
    }
}

/* One head in each of the daemon's slices, if the last one is done. */
static void maker_tick(member *m, uint32_t slice)
{
    const int64_t now_ns = wait_now_ns();
    if (m->waiting_count == 0 && timeline_side(member_mode(m, slice)) == LOAD_DAEMON) {
        visitor_due(m, slice, now_ns, now_ns);
    }
}

member *caller_maker_create(load_run *run)
{
    static const caller_job job = {.face = {.tick = maker_tick, .turn = caller_turn, .leave = caller_leave},
                                   .entered = maker_entered,
                                   .heard = maker_heard,
                                   .refused = visitor_refused};
    caller *c = caller_create(run, &job, 0, 0, 0);
    if (c) {
        c->m.ready = true;
    }
    return c ? &c->m : NULL;
}
