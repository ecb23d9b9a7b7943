/* registry.c: see registry.h. */
#include "registry.h"
#include "base/assert.h"
#include "base/error.h"
#include "limits.h"
#include "metrics.h"
#include "random.h"
#include "turns.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

bool registry_init(registry *reg, const registry_def *def)
{
    *reg = (registry){.greatest = def->greatest,
                      .accounts = def->accounts,
                      .pool = def->pool,
                      .clock_us = def->clock_us,
                      .wish = def->wish,
                      .interval_us = def->interval_us};
    reg->grooms = groom_cache_create(LIMIT_GROOMS_SPARE_BYTES);
    return reg->grooms && handle_table_init(&reg->handles, def->greatest);
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
    r->account->forests--;
    r->account->hair_bytes -= r->bytes;
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
    groom_cache_destroy(reg->grooms);
    handle_table_fini(&reg->handles);
    *reg = (registry){0};
}

/* Puts it at the end of the list. */
static void link_resident(registry *reg, resident *r, account *who)
{
    r->account = who;
    who->forests++;
    r->waiting_end = &r->waiting;
    r->importance = 1;
    r->lowered.thin = 1;
    r->previous = reg->last;
    *(reg->last ? &reg->last->next : &reg->first) = r;
    reg->last = r;
    reg->alive++;
    metrics_add(METRIC_FORESTS, 1);
}

/* A resident with a new handle and new tokens. */
static resident *resident_create(registry *reg, account *who)
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
    link_resident(reg, r, who);
    return r;
}

/* Has a worker make what the recipe says. */
static void make(registry *reg, resident *r, recipe *making, int64_t now_us)
{
    memcpy(r->name, making->name, sizeof r->name);
    r->params = making->params;
    r->motion_us = making->start.time_us;
    atomic_init(&r->work.note, 0);
    r->work.grooms = reg->grooms;
    r->work.helpers = worker_pool_spread(reg->pool);
    r->work.making = making;
    r->work.submitted_us = now_us;
    turns_submit(reg, r);
}

awt_status registry_create(registry *reg, recipe *making, origin from, account *who, int64_t now_us, awt_error *error)
{
    awt_status status = account_may_make(who, error) ? AWT_OK : AWT_LIMIT;
    if (status == AWT_OK && reg->alive >= reg->greatest) {
        status = error_set(error, AWT_LIMIT, "%lu forests live here, and that is the limit: DESTROY one first",
                           (unsigned long)reg->alive);
    } else if (status == AWT_OK && registry_bytes(reg) >= LIMIT_HAIR_BYTES) {
        status = error_set(error, AWT_LIMIT, "the forests here fill the memory set aside for them: DESTROY one first");
    }
    resident *r = status == AWT_OK ? resident_create(reg, who) : NULL;
    if (!r) {
        recipe_destroy(making);
        return status == AWT_OK ? error_set(error, AWT_NO_MEMORY, NULL) : status;
    }
    making->greatest_points = who->is.caps.points;
    r->creator = from;
    r->tells = making->tells;
    reg->telling += r->tells;
    make(reg, r, making, now_us);
    return AWT_OK;
}

awt_status registry_restore(registry *reg, const saved *from, upload *file, int64_t now_us, awt_error *error)
{
    recipe *making = NULL;
    const size_t offset = (size_t)file->total - from->state_size;
    if (reg->alive >= reg->greatest) {
        return error_set(error, AWT_LIMIT, "there is no room for more than %lu forests", (unsigned long)reg->alive);
    }
    resident *r = calloc(1, sizeof *r);
    awt_status status = r ? recipe_restore(file, offset, proto_str_of(from->name), &making, error)
                          : error_set(error, AWT_NO_MEMORY, NULL);
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
    making->greatest_points = UINT64_MAX; /* it is here already, whatever its account may have today */
    account *who = accounts_find(reg->accounts, from->account);
    reg->restoring++;
    link_resident(reg, r, who ? who : accounts_owner(reg->accounts));
    r->importance = from->importance;
    r->work.saving = *from; /* take_restored sets the clock by it */
    r->work.saving.state = NULL;
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
    turns_recall(reg, r);
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

resident *registry_take_back(job *done)
{
    size_t offset = offsetof(resident, work) + offsetof(forest_work, job);
    resident *r = (resident *)(void *)((unsigned char *)done - offset);
    ASSERT(r->busy);
    r->back = true;
    uint64_t bytes = forest_work_bytes(&r->work);
    metrics_add(METRIC_HAIR_BYTES, (int64_t)(bytes - r->bytes));
    r->account->hair_bytes += bytes - r->bytes;
    metrics_add(METRIC_FORESTS_ASLEEP, (int64_t)r->work.asleep - (int64_t)r->asleep);
    r->bytes = bytes;
    r->state_us = r->work.state_us;
    if (r->work.runs) {
        r->shown_us = r->work.free.to_us + r->work.dropped_us;
    }
    r->asleep = r->work.asleep;
    r->kept_sequence = r->work.kept ? r->work.sequence : r->kept_sequence;
    r->keep_lost = r->keep_lost || (r->work.keeper && !r->work.kept);
    for (int i = 0; i < FORM_COUNT && r->work.draws; i++) {
        r->form_bytes[i] = drawing_form_bytes(r->work.draws, i);
    }
    return r;
}

void registry_continue(registry *reg, resident *r)
{
    r->busy = r->running = r->back = false;
    if (r->doomed) {
        resident_end(reg, r);
    } else {
        turns_next(reg, r);
    }
}

uint64_t registry_bytes(const registry *reg)
{
    uint64_t bytes = groom_cache_bytes(reg->grooms);
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
