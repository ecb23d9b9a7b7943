/* heads.c: see heads.h. */
#include "load/heads.h"

#include "base/version.h"
#include "load/wait.h"
#include "progress.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { HEADS_TRIES = 100, HEADS_TRY_MS = 50, HEADS_CLOSED_RATE = 60, HEADS_PINGS = 5 };

/* ---- messages ---------------------------------------------------------------------------------------------------- */

static proto_pose wire_pose(const awt_pose *pose)
{
    proto_pose wire;
    memcpy(wire.position, pose->position, sizeof wire.position);
    memcpy(wire.orientation, pose->orientation, sizeof wire.orientation);
    return wire;
}

static motion_sample sample_at(const load_heads *h, int64_t time_us)
{
    const awt_pose still = {.orientation = {0, 0, 0, 1}};
    return h->clip.sample_count > 0 ? motion_at(&h->clip, time_us)
                                    : (motion_sample){.time_us = time_us, .head = still, .body = still};
}

void heads_fill_create(const load_heads *h, const load_plan *plan, uint32_t strands, proto_message *create)
{
    const motion_sample start = sample_at(h, 0);
    *create = (proto_message){.type = PROTO_CREATE};
    create->as.create.style = proto_str_of(plan->style);
    create->as.create.name = proto_str_of("awt-load");
    create->as.create.strands = strands;
    create->as.create.head = wire_pose(&start.head);
    create->as.create.body = wire_pose(&start.body);
}

int64_t heads_time_us(const load_heads *h, uint64_t number)
{
    return (int64_t)number * h->step_us;
}

void heads_fill_motion(const load_heads *h, uint32_t head, uint64_t number, int64_t time_us, proto_message *out)
{
    const awt_pose rest = sample_at(h, 0).head;
    motion_sample sample = sample_at(h, time_us);
    if (h->heads[head].still) {
        sample.head = sample.body = rest;
    }
    proto_begin(out, PROTO_MOTION);
    out->as.motion.forest = h->heads[head].forest;
    out->as.motion.epoch = 1;
    out->as.motion.sequence = (uint32_t)number;
    out->as.motion.time_us = time_us;
    out->as.motion.head = wire_pose(&sample.head);
    out->as.motion.body = wire_pose(&sample.body);
}

/* ---- steps ------------------------------------------------------------------------------------------------------- */

void steps_put(head_steps *s, uint64_t number, uint32_t slice, int64_t due_ns, int64_t sent_ns)
{
    const size_t at = number % HEADS_STEPS;
    atomic_store(&s->of[at].due_ns, due_ns);
    atomic_store(&s->of[at].sent_ns, sent_ns);
    atomic_store(&s->of[at].slice, slice);
    atomic_store(&s->of[at].number, number);
}

bool steps_get(const head_steps *s, uint64_t number, uint32_t *slice, int64_t *due_ns, int64_t *sent_ns)
{
    const size_t at = number % HEADS_STEPS;
    bool there = number > 0 && atomic_load(&s->of[at].number) == number;
    *due_ns = atomic_load(&s->of[at].due_ns);
    *sent_ns = atomic_load(&s->of[at].sent_ns);
    *slice = (uint32_t)atomic_load(&s->of[at].slice);
    return there && atomic_load(&s->of[at].number) == number;
}

/* ---- before and after the load ----------------------------------------------------------------------------------- */

/* A call that is tried again while the daemon has too much to do. */
static bool call(awtclient *client, proto_message *request, proto_message *answer, awtclient_error *error)
{
    for (int tries = 0; tries < HEADS_TRIES; tries++) {
        request->request = 0;
        if (awtclient_call(client, request, answer, error)) {
            return true;
        }
        if (error->code != PROTO_ERROR_BUSY) {
            return false;
        }
        nanosleep(&(struct timespec){0, HEADS_TRY_MS * 1000000L}, NULL);
    }
    return false;
}

static bool make_head(load_heads *h, const load_plan *plan, load_head *head, awtclient_error *error)
{
    proto_message request, answer;
    heads_fill_create(h, plan, plan->strands, &request);
    if (!call(h->owner, &request, &answer, error)) {
        return false;
    }
    head->forest = answer.as.create_reply.forest;
    head->still = (double)h->count >= plan->moving * plan->forests;
    memcpy(head->drive_token, answer.as.create_reply.drive_token, sizeof head->drive_token);
    memcpy(head->view_token, answer.as.create_reply.view_token, sizeof head->view_token);
    request = (proto_message){.type = PROTO_QUERY};
    request.as.query.forest = head->forest;
    request.as.query.kind = plan->kind;
    request.as.query.level = plan->level;
    if (!call(h->owner, &request, &answer, error)) {
        return false;
    }
    atomic_store(&head->frame_bytes, (int_fast64_t)proto_encoded_size(&answer));
    return true;
}

static bool take_motion(load_heads *h, const load_plan *plan, awtclient_error *error)
{
    if (strcmp(plan->motion, "still") == 0 || motion_builtin(plan->motion, &h->clip)) {
        return true;
    }
    error->code = AWTCLIENT_MEMORY;
    snprintf(error->text, sizeof error->text, "there is no clip \"%.60s\": still, lean, lean-forever, jump, run, shake",
             plan->motion);
    return false;
}

bool heads_open(load_heads *h, const load_plan *plan, awtclient_error *error)
{
    const awtclient_options options = {
        .address = plan->address, .token_file = plan->token_file, .name = "awt-load " AWTD_VERSION};
    *h = (load_heads){.step_us = (int64_t)(1e6 / (plan->closed ? HEADS_CLOSED_RATE : plan->rate) + 0.5)};
    atomic_store(&h->way_ns, INT64_MAX);
    if (!take_motion(h, plan, error) || !(h->owner = awtclient_open(&options, error))) {
        return false;
    }
    progress shown = progress_begin(stderr, "hair", plan->quiet);
    h->heads = calloc(plan->forests, sizeof *h->heads);
    bool made = h->heads != NULL;
    snprintf(error->text, sizeof error->text, "not enough memory");
    while (made && h->count < plan->forests) {
        made = make_head(h, plan, &h->heads[h->count], error);
        h->count += h->heads[h->count].forest != 0;
        progress_show(&shown, (double)h->count / plan->forests, "");
    }
    progress_hide(&shown);
    for (int n = 0; n < HEADS_PINGS && made; n++) {
        made = heads_tend(h, error);
    }
    return made;
}

bool heads_tend(load_heads *h, awtclient_error *error)
{
    proto_message ping = {.type = PROTO_PING}, pong;
    const int64_t begin_ns = wait_now_ns();
    ping.as.ping.sent_us = begin_ns / 1000;
    if (!awtclient_call(h->owner, &ping, &pong, error)) {
        return false;
    }
    const int64_t way_ns = (wait_now_ns() - begin_ns) / 2;
    if (way_ns < atomic_load(&h->way_ns)) {
        atomic_store(&h->way_ns, way_ns);
    }
    return true;
}

void heads_close(load_heads *h)
{
    awtclient_error ignored;
    for (uint32_t i = 0; i < h->count; i++) {
        proto_message request = {.type = PROTO_DESTROY}, answer;
        request.as.destroy.forest = h->heads[i].forest;
        if (!awtclient_call(h->owner, &request, &answer, &ignored)) {
            break;
        }
    }
    awtclient_close(h->owner);
    motion_fini(&h->clip);
    free(h->heads);
    *h = (load_heads){0};
}
