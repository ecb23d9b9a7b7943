/* free_run.c: see free_run.h. */
#include "free_run.h"
#include "limits.h"

/* ---- a forest, recorded or not ----------------------------------------------------------------------------------- */

static void drive_move(const free_forest *d, forest_input *input)
{
    if (d->recorder) {
        awt_recorder_move(d->recorder, &input->as.motion, &input->error);
    } else {
        awt_forest_move(d->forest, &input->as.motion, &input->error);
    }
}

static void drive_set_params(const free_forest *d, forest_input *input)
{
    if (d->recorder) {
        awt_recorder_set_params(d->recorder, &input->as.params, &input->error);
    } else {
        awt_forest_set_params(d->forest, &input->as.params, &input->error);
    }
}

static awt_status drive_advance(const free_forest *d, int64_t time_us, awt_step_stats *stats, awt_error *error)
{
    return d->recorder ? awt_recorder_advance(d->recorder, time_us, stats, error)
                       : awt_forest_advance(d->forest, time_us, stats, error);
}

static awt_status drive_skip(const free_forest *d, int64_t time_us, awt_error *error)
{
    return d->recorder ? awt_recorder_skip(d->recorder, time_us, error) : awt_forest_skip(d->forest, time_us, error);
}

/* ---- inputs ------------------------------------------------------------------------------------------------------ */

static void take_inputs(const free_forest *d, forest_input *inputs)
{
    const int64_t now_us = awt_forest_time(d->forest);
    forest_input *late = NULL;
    for (forest_input *input = inputs; input; input = input->next) {
        if (input->kind == FOREST_PARAMS) {
            drive_set_params(d, input);
            continue;
        }
        if (late) {
            forest_motion_absorb(&input->as.motion, &late->as.motion);
            late = NULL;
        }
        if (input->as.motion.time_us <= now_us) {
            late = input;
        } else {
            drive_move(d, input);
        }
    }
    if (late) {
        late->as.motion.time_us = now_us + AWT_STEP_US;
        drive_move(d, late);
    }
}

/* ---- steps ------------------------------------------------------------------------------------------------------- */

static void add_stats(awt_step_stats *sums, const awt_step_stats *step)
{
    const awt_step_stats before = *sums;
    *sums = *step; /* the state after the last */
    sums->steps += before.steps;
    sums->splits += before.splits;
    sums->merges += before.merges;
    sums->unreached_contacts += before.unreached_contacts;
    sums->clamped_speeds += before.clamped_speeds;
    sums->contacts += before.contacts;
    sums->contacts_left_out += before.contacts_left_out;
    sums->link_error = before.link_error > step->link_error ? before.link_error : step->link_error;
}

/* Whole steps, so that the forest stays on its grid. */
static int64_t time_to_drop_us(const free_task *task)
{
    const int64_t behind_us = sim_clock_at(&task->clock, task->clock_us()) - task->to_us;
    return behind_us > LIMIT_FREE_BEHIND_US ? behind_us / AWT_STEP_US * AWT_STEP_US : 0;
}

awt_status free_run(const free_forest *d, const free_task *task, forest_input *inputs, drawing *draws, free_result *out,
                    awt_error *error)
{
    *out = (free_result){.shown_us = task->to_us};
    awt_status status = awt_forest_advance(d->forest, awt_forest_time(d->forest), &out->stats, error); /* no step */
    take_inputs(d, inputs);
    if (status == AWT_OK) {
        out->dropped_us = time_to_drop_us(task);
        out->shown_us += out->dropped_us;
    }
    if (status == AWT_OK && out->dropped_us > 0) {
        status = drive_skip(d, awt_forest_time(d->forest) + out->dropped_us, error);
    }
    while (status == AWT_OK && awt_forest_time(d->forest) < out->shown_us) {
        const int64_t end_us = awt_forest_time(d->forest) + AWT_STEP_US;
        awt_step_stats step;
        if (draws && end_us > out->shown_us) {
            drawing_hold(draws, d->forest);
        }
        status = drive_advance(d, end_us, &step, error);
        if (status == AWT_OK) {
            add_stats(&out->stats, &step);
        }
    }
    return status;
}
