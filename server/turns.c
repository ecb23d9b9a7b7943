/* turns.c: see turns.h. */
#include "turns.h"
#include "limits.h"
#include "metrics.h"
#include "pacing.h"
#include "published.h"

#include <stdlib.h>
#include <string.h>

void turns_submit(registry *reg, resident *r)
{
    r->busy = true;
    r->running = r->work.runs;
    r->work.job.run = forest_work_run;
    r->work.job.class = r->work.making ? JOB_LONG : JOB_STEP;
    r->work.handle = r->handle;
    r->work.sequence = r->sequence;
    if (!r->work.spare) { /* a job that failed has left its own */
        r->work.spare = published_take_spare(r);
    }
    metrics_add(METRIC_JOBS_WAITING, 1);
    worker_pool_submit(reg->pool, &r->work.job);
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
    r->work.job.deadline_us = query->as.query.deadline_us;
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
        memcpy(s->account, r->account->is.name, sizeof s->account);
        s->mode = r->clock.mode;
        s->rate = r->clock.rate;
        s->importance = r->importance;
    }
}

/* In lock-step, or for those who look: now. */
static void start_now(registry *reg, resident *r, bool steps)
{
    r->work.runs = false;
    r->work.job.deadline_us = 0;
    if (r->looks) {
        r->work.submitted_us = r->looks->arrived_us;
    }
    if (steps) {
        take_step(r);
    }
    take_looks(r);
    reg->wish(r, steps, &r->work.wanted);
    r->work.job.not_before_us = 0;
    if (r->work.job.deadline_us == 0) {
        r->work.job.deadline_us = r->work.submitted_us + LIMIT_STEP_US;
    }
    turns_submit(reg, r);
}

/* By the daemon's clock: when it is time. What comes in until then is taken too (turns_recall). */
static void start_free(registry *reg, resident *r)
{
    const pacing known = {.clock = &r->clock,
                          .shown_us = r->shown_us,
                          .interval_us = reg->interval_us(r),
                          .asleep = r->asleep && r->moves_until_us <= r->work.state_us,
                          .wanted_now = r->looks || r->waiting_inputs > LIMIT_FOREST_INPUTS / 2};
    const pacing_turn turn = pacing_next(&known, reg->clock_us());
    r->work.runs = true;
    r->work.free = (free_task){.clock = r->clock, .to_us = turn.to_us, .clock_us = reg->clock_us};
    r->work.submitted_us = r->looks ? r->looks->arrived_us : turn.not_before_us;
    if (turn.to_us > r->work.state_us) { /* else there is no step to take them */
        r->work.inputs = r->waiting;
        r->waiting = NULL;
        r->waiting_end = &r->waiting;
        r->waiting_inputs = 0;
    }
    take_looks(r);
    reg->wish(r, true, &r->work.wanted);
    r->work.job.not_before_us = turn.not_before_us;
    r->work.job.deadline_us = turn.deadline_us;
    turns_submit(reg, r);
}

void turns_next(registry *reg, resident *r)
{
    const bool steps = r->waiting_queries > 0, runs = !steps && r->clock.mode == CLOCK_FREE;
    if (r->busy || r->doomed || !(steps || runs || r->looks || r->redraw || r->keep_due)) {
        return;
    }
    r->work.wanted = (wishes){0};
    r->work.wants_binding = r->work.wants_state = false;
    take_keeping(reg, r);
    if (runs) {
        start_free(reg, r);
    } else {
        start_now(reg, r, steps);
    }
    r->redraw = false;
}

/* Puts a list in front of another. Returns how many it held. */
static uint32_t give_back(forest_input **taken, forest_input **waiting, forest_input ***waiting_end)
{
    uint32_t count = 0;
    forest_input **end = taken;
    for (; *end; end = &(*end)->next) {
        count++;
    }
    if (waiting_end && count > 0 && !*waiting) {
        *waiting_end = end == taken ? waiting : end;
    }
    *end = *waiting;
    *waiting = *taken;
    *taken = NULL;
    return count;
}

void turns_recall(registry *reg, resident *r)
{
    if (!r->busy || !r->running || !worker_pool_withdraw(reg->pool, &r->work.job)) {
        return;
    }
    metrics_add(METRIC_JOBS_WAITING, -1);
    r->busy = r->running = false;
    r->waiting_inputs += give_back(&r->work.inputs, &r->waiting, &r->waiting_end);
    r->waiting_looks += give_back(&r->work.looks, &r->looks, NULL);
    r->keep_due = r->keep_due || r->work.keeper;
}

static bool push_look(resident *r, forest_input *look)
{
    if (r->waiting_looks >= LIMIT_FOREST_QUERIES) {
        return false;
    }
    r->waiting_looks++;
    look->next = r->looks;
    r->looks = look;
    return true;
}

/* Where no QUERY will come for them, the oldest motion makes room: it is the latest that count. */
static void drop_oldest_motion(resident *r)
{
    forest_input **link = &r->waiting;
    while (*link && (*link)->kind != FOREST_MOTION) {
        link = &(*link)->next;
    }
    forest_input *oldest = *link, *next = oldest ? oldest->next : NULL;
    while (next && next->kind != FOREST_MOTION) {
        next = next->next;
    }
    if (next) {
        forest_motion_absorb(&next->as.motion, &oldest->as.motion);
        *link = oldest->next;
        free(oldest);
        r->waiting_inputs--;
    }
}

static bool push_input(resident *r, forest_input *input)
{
    const bool query = input->kind == FOREST_QUERY;
    if (r->clock.mode != CLOCK_LOCK_STEP && r->waiting_inputs >= LIMIT_FOREST_INPUTS) {
        drop_oldest_motion(r);
    }
    if (query ? r->waiting_queries >= LIMIT_FOREST_QUERIES : r->waiting_inputs >= LIMIT_FOREST_INPUTS) {
        return false;
    }
    *(query ? &r->waiting_queries : &r->waiting_inputs) += 1;
    r->asked_us = query && input->as.query.time_us > r->asked_us ? input->as.query.time_us : r->asked_us;
    input->next = NULL;
    *r->waiting_end = input;
    r->waiting_end = &input->next;
    return true;
}

bool turns_push(registry *reg, resident *r, forest_input *input)
{
    turns_recall(reg, r);
    const bool pushed = input->kind > FOREST_QUERY ? push_look(r, input) : push_input(r, input);
    turns_next(reg, r);
    return pushed;
}

bool turns_is_late(const resident *r, int64_t now_us)
{
    return r->busy && !r->back && now_us > r->work.job.deadline_us;
}

void turns_attend(registry *reg, resident *r)
{
    turns_recall(reg, r);
    turns_next(reg, r);
}

void turns_keep(registry *reg, resident *r)
{
    if (reg->keeper && r->ready && !r->doomed && (r->keep_lost || r->sequence != r->kept_sequence)) {
        r->keep_due = true;
        r->keep_lost = false;
        turns_attend(reg, r);
    }
}

void turns_redraw(registry *reg, resident *r, int64_t now_us)
{
    r->redraw = true;
    if (!r->busy) {
        r->work.submitted_us = now_us;
    }
    turns_attend(reg, r);
}

void turns_set_clock(registry *reg, resident *r, clock_mode mode, double rate)
{
    turns_recall(reg, r);
    const int64_t now_us = reg->clock_us();
    int64_t least_us = r->asked_us > r->latest->figures.time_us ? r->asked_us : r->latest->figures.time_us;
    least_us = least_us > r->state_us ? least_us : r->state_us;
    if (mode == CLOCK_FREE && r->clock.mode != CLOCK_FREE) {
        r->delay = (pose_delay){0};
    }
    sim_clock_set(&r->clock, mode, rate, least_us, now_us);
    r->shown_us = r->clock.sim_us;
    if (mode != CLOCK_FREE && r->motion_us < r->moves_until_us) {
        r->motion_us = r->moves_until_us; /* poses were taken later than they were given for */
    }
    turns_next(reg, r);
}
