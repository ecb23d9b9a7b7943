/* record_ops.c: see record_ops.h. */
#include "sim/record_ops.h"

#include "base/error.h"
#include "sim/snapshot.h"

const unsigned char RECORDING_MAGIC[4] = {'A', 'W', 'T', 'R'};

static void walk_pose(codec *c, awt_pose *pose)
{
    for (int k = 0; k < 3; k++) {
        codec_f64(c, &pose->position[k]);
    }
    for (int k = 0; k < 4; k++) {
        codec_f64(c, &pose->orientation[k]);
    }
}

awt_status record_walk_move(codec *c, awt_motion *motion, awt_error *error)
{
    codec_i64(c, &motion->time_us);
    codec_bool(c, &motion->teleport);
    walk_pose(c, &motion->head);
    walk_pose(c, &motion->body);
    codec_u32(c, &motion->collider_count);
    if (motion->collider_count > AWT_MAX_COLLIDERS) {
        return error_set(error, AWT_LIMIT, "a record has %lu obstacle poses; %d are the most",
                         (unsigned long)motion->collider_count, AWT_MAX_COLLIDERS);
    }
    for (uint32_t k = 0; k < motion->collider_count; k++) {
        codec_u32(c, &motion->colliders[k].id);
        walk_pose(c, &motion->colliders[k].pose);
    }
    return AWT_OK;
}

awt_status record_walk_params(codec *c, awt_params *params, awt_error *error)
{
    if (c->in) {
        return snapshot_read_params(c, false, params, error);
    }
    snapshot_write_params(c, params);
    return AWT_OK;
}

awt_status record_walk_advance(codec *c, record_advance *advance, awt_error *error)
{
    (void)error;
    codec_i64(c, &advance->time_us);
    codec_u64(c, &advance->hash);
    return AWT_OK;
}

awt_status record_walk_skip(codec *c, record_skip *skip, awt_error *error)
{
    (void)error;
    codec_i64(c, &skip->time_us);
    return AWT_OK;
}
