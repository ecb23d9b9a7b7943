/* session_motion.c: MOTION, SET_PARAMS, SET_CLOCK: what goes into a forest. The first two wait in the forest's queue
 * until a step wants them; what can be said about them at once is said at once. */
#include "handlers.h"
#include "convert.h"
#include "turns.h"

/* True if it was there before: motions may be sent again without harm. */
static bool is_repeat(const resident *r, const struct proto_motion *motion)
{
    if (!r->moved || motion->epoch > r->motion_epoch) {
        return false;
    }
    return motion->epoch < r->motion_epoch || motion->sequence <= r->motion_sequence;
}

/* By the daemon's clock poses are taken when they can be taken evenly. Times out of range are for the forest to refuse.
 */
static void delay(resident *r, awt_motion *motion, int64_t arrived_us)
{
    if (r->clock.mode == CLOCK_FREE && motion->time_us <= AWT_MAX_TIME_US && motion->time_us >= -AWT_MAX_TIME_US) {
        motion->time_us = pose_delay_map(&r->delay, motion->time_us, sim_clock_at(&r->clock, arrived_us));
        r->moves_until_us = motion->time_us;
    }
}

void session_motion(session *s, const proto_message *message)
{
    const struct proto_motion *motion = &message->as.motion;
    resident *r = session_resident(s, message, motion->forest, true);
    if (!r || is_repeat(r, motion)) {
        return;
    }
    if (motion->time_us <= r->motion_us) {
        session_error(s, message->type, message->request, PROTO_ERROR_BAD_TIME,
                      "the motion is of %.6f s, and the last one was of %.6f s", (double)motion->time_us * 1e-6,
                      (double)r->motion_us * 1e-6);
        return;
    }
    forest_input *input = session_input(s, message, FOREST_MOTION);
    if (input) {
        input->as.motion = convert_motion(motion);
        delay(r, &input->as.motion, input->arrived_us);
    }
    if (!session_push(s, message, r, input)) {
        return;
    }
    r->moved = true;
    r->motion_epoch = motion->epoch;
    r->motion_sequence = motion->sequence;
    r->motion_us = motion->time_us;
}

void session_set_params(session *s, const proto_message *message)
{
    const struct proto_set_params *set = &message->as.set_params;
    resident *r = session_resident(s, message, set->forest, true);
    if (!r) {
        return;
    }
    awt_error error = {0};
    awt_params changed = r->params;
    if (convert_params(set->params.items, set->params.count, &changed, &error) != AWT_OK) {
        session_error_awt(s, message->type, message->request, &error);
        return;
    }
    forest_input *input = session_input(s, message, FOREST_PARAMS);
    if (input) {
        input->as.params = changed;
    }
    if (session_push(s, message, r, input)) {
        r->params = changed;
        session_send(s, &(proto_message){.type = PROTO_SET_PARAMS_REPLY, .request = message->request});
    }
}

/* What is wrong with it; NULL: nothing. */
static const char *find_fault(const struct proto_set_clock *set)
{
    if (set->mode > CLOCK_PAUSED) {
        return "mode is 0 (lock-step), 1 (free-running) or 2 (paused)";
    }
    if (set->mode == CLOCK_FREE && !(set->rate >= (float)CLOCK_RATE_LEAST && set->rate <= (float)CLOCK_RATE_GREATEST)) {
        return "the rate of a free-running forest is 0.01 to 10";
    }
    if (set->importance != 0 && !(set->importance >= IMPORTANCE_LEAST && set->importance <= IMPORTANCE_GREATEST)) {
        return "importance is 0.001 to 1000, or 0 for what it is";
    }
    return NULL;
}

void session_set_clock(session *s, const proto_message *message)
{
    const struct proto_set_clock *set = &message->as.set_clock;
    resident *r = session_resident(s, message, set->forest, true);
    const char *fault = r ? find_fault(set) : NULL;
    if (!r) {
        return;
    }
    if (fault) {
        session_error(s, message->type, message->request, PROTO_ERROR_BAD_VALUE, "%s", fault);
        return;
    }
    r->importance = set->importance != 0 ? set->importance : r->importance;
    r->keep_lost = true; /* what is on the disk says otherwise, though no step may come */
    turns_set_clock(&s->shared->forests, r, (clock_mode)set->mode, (double)set->rate);
    proto_message reply = {.type = PROTO_SET_CLOCK_REPLY, .request = message->request};
    reply.as.set_clock_reply.clock_us = s->shared->options.clock_us();
    reply.as.set_clock_reply.time_us = sim_clock_at(&r->clock, reply.as.set_clock_reply.clock_us);
    session_send(s, &reply);
}
