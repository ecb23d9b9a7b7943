/* caller.c: see caller.h and caller_job.h. A caller is a link with a job: what it asks for once it is in, what it sends
 * when its time has come, what it makes of what comes. */
#include "load/caller_job.h"

#include "base/version.h"

#include <poll.h>
#include <stdlib.h>
#include <string.h>

/* ---- the link ---------------------------------------------------------------------------------------------------- */

void caller_listen(caller *c)
{
    const unsigned wanted = c->link && !c->deaf ? awtlink_wanted(c->link) : 0;
    c->m.descriptor = c->link ? awtlink_descriptor(c->link) : -1;
    c->m.events = (short)((wanted & AWTLINK_READ ? POLLIN : 0) | (wanted & AWTLINK_WRITE ? POLLOUT : 0));
}

bool caller_connect(caller *c)
{
    awtclient_error error = {0};
    const load_plan *p = c->m.run->plan;
    const awtclient_options options = {
        .address = p->address, .token_file = p->token_file, .name = "awt-load " AWTD_VERSION};
    c->in = false;
    c->link = awtlink_open(&options, awtclient_now_us(), &error);
    if (!c->link) {
        book_error(&c->m.run->book, "%s", error.text);
    }
    caller_listen(c);
    return c->link != NULL;
}

member *caller_connected(caller *c)
{
    if (c && !caller_connect(c)) {
        free(c);
        return NULL;
    }
    return c ? &c->m : NULL;
}

void caller_disconnect(caller *c)
{
    awtlink_close(c->link);
    c->link = NULL;
    caller_listen(c);
}

void caller_fail(caller *c, const char *text)
{
    book_error(&c->m.run->book, "%s", text);
    caller_disconnect(c);
    c->m.waiting_count = 0;
    if (!c->m.ready) {
        atomic_store(&c->m.run->failed, true);
    }
}

caller *caller_create(load_run *run, const caller_job *job, uint32_t head, int64_t phase_ns, int64_t period_ns)
{
    caller *c = calloc(1, sizeof *c);
    if (!c) {
        book_error(&run->book, "not enough memory");
        return NULL;
    }
    c->m = (member){.face = &job->face,
                    .run = run,
                    .side = LOAD_DAEMON,
                    .descriptor = -1,
                    .phase_ns = phase_ns,
                    .period_ns = period_ns};
    c->job = job;
    c->head = head;
    return c;
}

void caller_leave(member *m)
{
    awtlink_close(((caller *)m)->link);
    free(m);
}

/* ---- what goes out ----------------------------------------------------------------------------------------------- */

uint64_t caller_send(caller *c, proto_message *message)
{
    awtclient_error error = {0};
    if (!c->link) {
        return 0;
    }
    if (!awtlink_queue(c->link, message, &error)) {
        caller_fail(c, error.text);
        return 0;
    }
    c->dirty = true;
    return message->request;
}

uint64_t caller_attach(caller *c, const uint8_t token[16])
{
    proto_message attach = {.type = PROTO_ATTACH};
    attach.as.attach.forest = c->m.run->heads.heads[c->head].forest;
    memcpy(attach.as.attach.token, token, sizeof attach.as.attach.token);
    return caller_send(c, &attach);
}

uint64_t caller_query(caller *c, uint64_t forest)
{
    proto_message query;
    proto_begin(&query, PROTO_QUERY);
    query.as.query.forest = forest;
    query.as.query.latest = 1;
    query.as.query.kind = c->m.run->plan->kind;
    query.as.query.level = c->m.run->plan->level;
    return caller_send(c, &query);
}

/* ---- what comes -------------------------------------------------------------------------------------------------- */

static void caller_refused(caller *c, const proto_message *message)
{
    char text[240 + 1];
    member_due due;
    proto_str_copy(message->as.error.text, text, sizeof text);
    if (!c->m.ready) {
        caller_fail(c, text);
        return;
    }
    book_error(&c->m.run->book, "%s", text);
    member_answered(&c->m, message->request, &due);
    if (c->job->refused) {
        c->job->refused(c, message->request);
    }
}

static void caller_heard(caller *c, const proto_message *message)
{
    if (message->type == PROTO_ERROR) {
        caller_refused(c, message);
    } else {
        c->job->heard(c, message);
    }
}

/* One turn of the link. A job may close it, and open another, whenever it hears something. */
static void caller_pump(caller *c)
{
    awtclient_error error = {0};
    proto_message message;
    c->dirty = false;
    awtlink_pump(c->link, awtclient_now_us(), &error);
    if (!c->in && awtlink_ready(c->link)) {
        c->in = true;
        c->job->entered(c);
    }
    while (c->link && awtlink_next(c->link, &message, &error)) {
        caller_heard(c, &message);
    }
    if (c->link && error.code != 0) {
        caller_fail(c, error.text);
        if (c->job->refused) {
            c->job->refused(c, 0);
        }
    }
}

void caller_settle(caller *c)
{
    if (c->settling) {
        return;
    }
    c->settling = true;
    while (c->link) {
        caller_pump(c);
        if (!c->link || (!c->dirty && !awtlink_pending(c->link))) {
            break;
        }
    }
    c->settling = false;
    caller_listen(c);
}

void caller_turn(member *m, short revents)
{
    (void)revents;
    if (((caller *)m)->link) {
        caller_settle((caller *)m);
    }
}
