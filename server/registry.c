/* registry.c: see registry.h. */
#include "registry.h"
#include "base/assert.h"
#include "base/error.h"
#include "limits.h"
#include "metrics.h"
#include "random.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

bool registry_init(registry *reg, uint32_t greatest, worker_pool *pool,
                   void (*wish)(const resident *r, bool steps, wishes *out))
{
    *reg = (registry){.greatest = greatest, .pool = pool, .wish = wish};
    return handle_table_init(&reg->handles, greatest);
}

static void resident_free(registry *reg, resident *r)
{
    ASSERT(!r->subscriptions);
    *(r->previous ? &r->previous->next : &reg->first) = r->next;
    *(r->next ? &r->next->previous : &reg->last) = r->previous;
    reg->alive--;
    metrics_add(METRIC_FORESTS, -1);
    metrics_add(METRIC_FORESTS_ASLEEP, -(int64_t)r->asleep);
    metrics_add(METRIC_HAIR_BYTES, -(int64_t)r->bytes);
    reg->telling -= r->tells;
    forest_inputs_free(r->waiting);
    forest_inputs_free(r->looks);
    picture_release(r->latest);
    picture_release(r->binding);
    for (int i = 0; i < LIMIT_PICTURES_SPARE; i++) {
        picture_release(r->spare[i]);
    }
    forest_work_fini(&r->work);
    free(r);
}

void registry_fini(registry *reg)
{
    while (reg->first) {
        resident_free(reg, reg->first);
    }
    handle_table_fini(&reg->handles);
    *reg = (registry){0};
}

/* Puts it at the end of the list. */
static void link_resident(registry *reg, resident *r)
{
    r->waiting_end = &r->waiting;
    r->previous = reg->last;
    *(reg->last ? &reg->last->next : &reg->first) = r;
    reg->last = r;
    reg->alive++;
    metrics_add(METRIC_FORESTS, 1);
}

/* A resident with a new handle and new tokens. */
static resident *resident_create(registry *reg)
{
    resident *r = calloc(1, sizeof *r);
    if (!r) {
        return NULL;
    }
    r->handle = random_fill(r->drive_token, sizeof r->drive_token) && random_fill(r->view_token, sizeof r->view_token)
                    ? handle_add(&reg->handles, r)
                    : 0;
    if (r->handle == 0) {
        free(r);
        return NULL;
    }
    link_resident(reg, r);
    return r;
}

/* A picture that only the resident still has; NULL: none. */
static picture *take_spare(resident *r)
{
    for (int i = 0; i < LIMIT_PICTURES_SPARE; i++) {
        picture *p = r->spare[i];
        if (p && picture_renew(p)) {
            r->spare[i] = NULL;
            return p;
        }
    }
    return NULL;
}

static void submit(registry *reg, resident *r)
{
    r->busy = true;
    r->work.job.run = forest_work_run;
    r->work.job.class = r->work.making ? JOB_LONG : JOB_STEP;
    r->work.job.deadline_us = r->work.submitted_us + LIMIT_STEP_US;
    r->work.handle = r->handle;
    r->work.sequence = r->sequence;
    if (!r->work.spare) { /* a job that failed has left its own */
        r->work.spare = take_spare(r);
    }
    metrics_add(METRIC_JOBS_WAITING, 1);
    worker_pool_submit(reg->pool, &r->work.job);
}

/* Has a worker make what the recipe says. */
static void make(registry *reg, resident *r, recipe *making, int64_t now_us)
{
    memcpy(r->name, making->name, sizeof r->name);
    r->params = making->params;
    r->motion_us = making->start.time_us;
    atomic_init(&r->work.note, 0);
    r->work.making = making;
    r->work.submitted_us = now_us;
    submit(reg, r);
}

awt_status registry_create(registry *reg, recipe *making, origin from, int64_t now_us, awt_error *error)
{
    awt_status status = AWT_OK;
    if (reg->alive >= reg->greatest) {
        status = error_set(error, AWT_LIMIT, "%lu forests live here, and that is the limit: DESTROY one first",
                           (unsigned long)reg->alive);
    } else if (registry_bytes(reg) >= LIMIT_HAIR_BYTES) {
        status = error_set(error, AWT_LIMIT, "the forests here fill the memory set aside for them: DESTROY one first");
    }
    resident *r = status == AWT_OK ? resident_create(reg) : NULL;
    if (!r) {
        recipe_destroy(making);
        return status == AWT_OK ? error_set(error, AWT_NO_MEMORY, NULL) : status;
    }
    r->creator = from;
    r->tells = making->tells;
    reg->telling += r->tells;
    make(reg, r, making, now_us);
    return AWT_OK;
}

awt_status registry_restore(registry *reg, const saved *from, upload *file, int64_t now_us, awt_error *error)
{
    recipe *making = NULL;
    resident *r = reg->alive < reg->greatest ? calloc(1, sizeof *r) : NULL;
    const size_t offset = (size_t)file->total - from->state_size;
    awt_status status = r ? recipe_restore(file, offset, proto_str_of(from->name), &making, error) : AWT_LIMIT;
    if (!r) {
        return error_set(error, AWT_LIMIT, "there is no room for more than %lu forests", (unsigned long)reg->alive);
    }
    if (status == AWT_OK && !handle_put(&reg->handles, from->handle, r)) {
        status =
            error_set(error, AWT_BAD_VALUE, "its handle cannot be, or is taken; is --max-forests less than it was?");
    }
    if (status != AWT_OK) {
        recipe_destroy(making);
        free(r);
        return status;
    }
    r->handle = from->handle;
    _Static_assert((int)SAVED_TOKEN_SIZE == (int)REGISTRY_TOKEN_SIZE, "tokens are kept whole");
    memcpy(r->drive_token, from->drive_token, sizeof r->drive_token);
    memcpy(r->view_token, from->view_token, sizeof r->view_token);
    r->sequence = from->sequence;
    r->kept_sequence = from->sequence + 1; /* that of the frame which is drawn of it now: nothing has changed */
    r->restored = true;
    r->left_us = now_us;
    reg->restoring++;
    link_resident(reg, r);
    make(reg, r, making, now_us);
    return AWT_OK;
}

resident *registry_find(const registry *reg, uint64_t handle)
{
    resident *r = handle_find(&reg->handles, handle);
    return r && r->ready ? r : NULL;
}

/* A forest that was ended is not to come back; its last job may have brought it to the disk once more. */
static void resident_end(registry *reg, resident *r)
{
    if (reg->keeper) {
        keeper_remove(reg->keeper, r->work.handle);
    }
    resident_free(reg, r);
}

forest_input *registry_destroy(registry *reg, resident *r)
{
    ASSERT(!r->doomed && !r->subscriptions);
    handle_remove(&reg->handles, r->handle);
    r->handle = 0;
    r->doomed = true;
    *r->waiting_end = r->looks;
    forest_input *waiting = r->waiting;
    r->waiting = r->looks = NULL;
    r->waiting_end = &r->waiting;
    r->waiting_inputs = r->waiting_queries = r->waiting_looks = 0;
    if (!r->busy) {
        resident_end(reg, r);
    }
    return waiting;
}

/* Everything up to the first query becomes the job's. */
static void take_step(resident *r)
{
    r->work.inputs = r->waiting;
    forest_input *query = r->waiting;
    for (; query->kind != FOREST_QUERY; query = query->next) {
        r->waiting_inputs--;
    }
    r->waiting_queries--;
    r->waiting = query->next;
    r->waiting_end = r->waiting ? r->waiting_end : &r->waiting;
    query->next = NULL;
    r->work.submitted_us = query->arrived_us;
    wishes_add(&r->work.wanted, (view_name){.form = query->as.query.form});
}

/* So do all who want to see the forest. */
static void take_looks(resident *r)
{
    r->work.looks = r->looks;
    for (const forest_input *look = r->looks; look; look = look->next) {
        if (look->kind == FOREST_BINDING) {
            r->work.wants_binding = !r->binding;
        } else if (look->kind == FOREST_STATE) {
            r->work.wants_state = true;
        } else {
            wishes_add(&r->work.wanted, (view_name){.form = look->as.query.form});
        }
        r->work.submitted_us = r->work.inputs ? r->work.submitted_us : look->arrived_us;
    }
    r->looks = NULL;
    r->waiting_looks = 0;
}

/* The state after this job goes to the disk, if that is due. */
static void take_keeping(registry *reg, resident *r)
{
    r->work.keeper = r->keep_due ? reg->keeper : NULL;
    r->keep_due = false;
    if (r->work.keeper) {
        saved *s = &r->work.saving;
        *s = (saved){.handle = r->handle};
        memcpy(s->drive_token, r->drive_token, sizeof s->drive_token);
        memcpy(s->view_token, r->view_token, sizeof s->view_token);
        memcpy(s->name, r->name, sizeof s->name);
    }
}

/* What waits becomes a job, if no worker has the forest already. */
static void start_next(registry *reg, resident *r)
{
    const bool steps = r->waiting_queries > 0;
    if (r->busy || !(steps || r->looks || r->redraw || r->keep_due)) {
        return;
    }
    r->work.wanted = (wishes){0};
    r->work.wants_binding = r->work.wants_state = false;
    if (steps) {
        take_step(r);
    }
    take_looks(r);
    reg->wish(r, steps, &r->work.wanted);
    take_keeping(reg, r);
    r->redraw = false;
    submit(reg, r);
}

static bool push_look(registry *reg, resident *r, forest_input *look)
{
    if (r->waiting_looks >= LIMIT_FOREST_QUERIES) {
        return false;
    }
    r->waiting_looks++;
    look->next = r->looks;
    r->looks = look;
    start_next(reg, r);
    return true;
}

bool registry_push(registry *reg, resident *r, forest_input *input)
{
    if (input->kind > FOREST_QUERY) {
        return push_look(reg, r, input);
    }
    bool query = input->kind == FOREST_QUERY;
    if (query ? r->waiting_queries >= LIMIT_FOREST_QUERIES : r->waiting_inputs >= LIMIT_FOREST_INPUTS) {
        return false;
    }
    *(query ? &r->waiting_queries : &r->waiting_inputs) += 1;
    input->next = NULL;
    *r->waiting_end = input;
    r->waiting_end = &input->next;
    start_next(reg, r);
    return true;
}

void registry_keep(registry *reg, resident *r)
{
    if (reg->keeper && r->ready && !r->doomed && r->sequence != r->kept_sequence) {
        r->keep_due = true;
        start_next(reg, r);
    }
}

void registry_redraw(registry *reg, resident *r, int64_t now_us)
{
    r->redraw = true;
    if (!r->busy) {
        r->work.submitted_us = now_us;
    }
    start_next(reg, r);
}

static void keep_spare(resident *r, picture *p)
{
    for (int i = 0; i < LIMIT_PICTURES_SPARE; i++) {
        if (!r->spare[i]) {
            r->spare[i] = p;
            return;
        }
    }
    picture_release(r->spare[0]); /* someone has had it for long */
    r->spare[0] = p;
}

static void note_sizes(resident *r, const picture *drawn)
{
    const uint64_t sequence = drawn->figures.sequence;
    for (uint32_t i = 0; i < drawn->view_count; i++) {
        const view *v = &drawn->views[i];
        form_size *last = v->name.base ? &r->delta[v->name.form] : &r->whole[v->name.form];
        const bool larger = last->sequence != sequence || v->glb.size > last->bytes;
        *last = (form_size){.sequence = sequence, .bytes = larger ? v->glb.size : last->bytes};
    }
}

static bool shows_more(const picture *drawn, const picture *before)
{
    for (uint32_t i = 0; i < drawn->view_count; i++) {
        if (!picture_view(before, drawn->views[i].name)) {
            return true;
        }
    }
    return false;
}

bool registry_publish(resident *r, picture *drawn)
{
    picture *before = r->latest;
    const bool again = before && before->figures.sequence == drawn->figures.sequence;
    note_sizes(r, drawn);
    if (again && !shows_more(drawn, before)) { /* else a client could pile up pictures of one step */
        keep_spare(r, drawn);
        return false;
    }
    r->latest = drawn;
    r->sequence = drawn->figures.sequence;
    if (again) {
        drawn->earlier = before;
    } else if (before) {
        keep_spare(r, before);
    }
    return true;
}

resident *registry_take_back(job *done)
{
    size_t offset = offsetof(resident, work) + offsetof(forest_work, job);
    resident *r = (resident *)(void *)((unsigned char *)done - offset);
    ASSERT(r->busy);
    uint64_t bytes = forest_work_bytes(&r->work);
    metrics_add(METRIC_HAIR_BYTES, (int64_t)(bytes - r->bytes));
    metrics_add(METRIC_FORESTS_ASLEEP, (int64_t)r->work.asleep - (int64_t)r->asleep);
    r->bytes = bytes;
    r->asleep = r->work.asleep;
    r->kept_sequence = r->work.keeper ? r->work.sequence : r->kept_sequence;
    for (int i = 0; i < FORM_COUNT && r->work.draws; i++) {
        r->form_bytes[i] = drawing_form_bytes(r->work.draws, i);
    }
    return r;
}

void registry_continue(registry *reg, resident *r)
{
    r->busy = false;
    if (r->doomed) {
        resident_end(reg, r);
    } else {
        start_next(reg, r);
    }
}

uint64_t registry_bytes(const registry *reg)
{
    uint64_t bytes = 0;
    for (const resident *r = reg->first; r; r = r->next) {
        bytes += r->bytes;
    }
    return bytes;
}

uint32_t registry_ready_count(const registry *reg)
{
    uint32_t count = 0;
    for (const resident *r = reg->first; r; r = r->next) {
        count += r->ready && !r->doomed;
    }
    return count;
}
