/* formats.h: what the readers of motion files share. Private to motion. */
#ifndef MOTION_FORMATS_H
#define MOTION_FORMATS_H

#include "base/vec.h"
#include "motion/motion.h"
#include "motion/text.h"

enum {
    MOTION_MAX_SAMPLES = 500000 /* of a clip: 2.3 hours at 60 a second, 60 MB */
};
/* Longest clip: a day. Greatest distance from the origin: beyond it a file's unit is wrong. */
#define MOTION_MAX_TIME_US INT64_C(86400000000)
#define MOTION_MAX_DISTANCE_M 1e6

/* A rigid motion: turn first, then move. */
typedef struct rigid {
    dquat turn;
    dvec3 move;
} rigid;

/* First b, then a. */
static inline rigid rigid_mul(rigid a, rigid b)
{
    return (rigid){dquat_mul(a.turn, b.turn), dvec3_add(a.move, dquat_rotate(a.turn, b.move))};
}

static inline dvec3 rigid_apply(rigid r, dvec3 point)
{
    return dvec3_add(r.move, dquat_rotate(r.turn, point));
}

/* A vector of a Z-up file in Y-up axes: a quarter turn about X. Quaternions' vector parts go the same way. */
static inline dvec3 motion_from_z_up(dvec3 v)
{
    return (dvec3){v.x, v.z, -v.y};
}

/* A rigid motion of the file in the contract's axes and metres. */
static inline rigid motion_to_metres(rigid r, double scale, awt_up_axis up)
{
    dvec3 axis = {r.turn.x, r.turn.y, r.turn.z};
    dvec3 move = dvec3_scale(r.move, scale);
    if (up == AWT_UP_Z) {
        axis = motion_from_z_up(axis);
        move = motion_from_z_up(move);
    }
    return (rigid){{axis.x, axis.y, axis.z, r.turn.w}, move};
}

/* The rigid motion as a pose of the frame whose origin it has moved to. */
static inline awt_pose motion_pose(rigid r)
{
    dquat q = dquat_unit(r.turn);
    return (awt_pose){{r.move.x, r.move.y, r.move.z}, {q.x, q.y, q.z, q.w}};
}

/* The readers; `out` and errors as for motion_read. */
awt_status bvh_read(text_cursor text, const motion_options *options, motion *out, awt_error *error);
awt_status headpose_read(text_cursor text, const motion_options *options, motion *out, awt_error *error);

#endif
