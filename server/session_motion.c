/* session_motion.c: MOTION and SET_PARAMS: what goes into a forest. Both wait in the forest's queue until a QUERY wants
 * them; what can be said about them at once is said at once. */
#include "handlers.h"
#include "convert.h"

/* True if it was there before: motions may be sent again without harm. */
static bool is_repeat(const resident *r, const struct proto_motion *motion)
{
    if (!r->moved || motion->epoch > r->motion_epoch) {
        return false;
    }
    return motion->epoch < r->motion_epoch || motion->sequence <= r->motion_sequence;
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
