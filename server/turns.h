/* turns.h: what waits for a forest becomes the work of a worker.
 *
 * In lock-step everything up to and including the first QUERY is one job, as soon as the forest is idle. A forest that
 * runs by the daemon's clock always has a job ahead of it, for the time of its next frame; what comes in before that
 * has begun still goes into it. Whoever only wants to see the forest is answered by the next job, whatever that does.
 */
#ifndef TURNS_H
#define TURNS_H

#include "registry.h"

/* Has a worker do the resident's `work`, whose task is filled in. */
void turns_submit(registry *reg, resident *r);

/* What waits becomes a job, if no worker has the forest already. */
void turns_next(registry *reg, resident *r);

/* Takes back the job of a free-running forest, if it has not begun; its inputs wait again. */
void turns_recall(registry *reg, resident *r);

/* Queues an input (taken) behind those that wait. False: too many wait; the input is the caller's again. */
bool turns_push(registry *reg, resident *r, forest_input *input);

/* Has the present state drawn again, for a subscription that lacks its view. */
void turns_redraw(registry *reg, resident *r, int64_t now_us);

/* Has the forest's state brought to the disk, unless nothing has changed since that was done last. Nothing without a
 * keeper. */
void turns_keep(registry *reg, resident *r);

/* Who looks at the forest has changed: a free-running one may have its next turn at another time. */
void turns_attend(registry *reg, resident *r);

/* Whether its step should have been done by now: what there is to be seen of it is stale. */
bool turns_is_late(const resident *r, int64_t now_us);

/* From now on its time goes so. A clock that starts takes over where the forest is, or will be when its queries are
 * answered. */
void turns_set_clock(registry *reg, resident *r, clock_mode mode, double rate);

#endif
