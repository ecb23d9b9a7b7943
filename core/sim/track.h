/* track.h: poses between updates (CONTRACT.md, "Poses between updates").
 *
 * A causal Hermite curve: each interval starts with the velocity at which the last one ended and ends with a
 * one-sided estimate from its own two poses, so that no pose has to wait for the one after it. After the last pose
 * everything holds still; after a gap of more than TRACK_GAP_US an interval starts from rest. */
#ifndef SIM_TRACK_H
#define SIM_TRACK_H

#include "awt.h"
#include "base/vec.h"

#define TRACK_GAP_US INT64_C(250000)

/* A pose with its rates of change. */
typedef struct track_pose {
    dvec3 position;
    dquat orientation;
    dvec3 velocity;
    dquat rate; /* of the orientation's components */
} track_pose;

/* What moves: the head, the body and the obstacles with frames of their own. */
enum { TRACK_HEAD, TRACK_BODY, TRACK_OWN, TRACK_COUNT = TRACK_OWN + AWT_MAX_COLLIDERS };

typedef struct track_instant {
    int64_t time_us;
    bool teleport; /* jump here instead of moving here */
    track_pose pose[TRACK_COUNT];
} track_instant;

typedef struct track {
    uint32_t own_count;                 /* obstacles with frames of their own */
    uint32_t own_id[AWT_MAX_COLLIDERS]; /* the id of pose TRACK_OWN + k */
    track_instant last;                 /* the latest instant reached; rates: at its end */
    track_instant queue[AWT_MAX_QUEUED_POSES];
    uint32_t queue_first, queue_count;
} track;

/* Index in the queue of the k-th instant that waits. */
static inline uint32_t track_queued(const track *t, uint32_t k)
{
    return (t->queue_first + k) % AWT_MAX_QUEUED_POSES;
}

/* Starts at rest at the given poses; `colliders` names those with frames of their own. AWT_BAD_VALUE. */
awt_status track_init(track *t, const awt_motion *start, const awt_collider *colliders, uint32_t collider_count,
                      awt_error *error);
/* awt_forest_move's checks and storing. */
awt_status track_push(track *t, const awt_motion *motion, int64_t now_us, awt_error *error);
/* Where everything is at `time_us`, a real number of microseconds not before any asked before. True if an
 * instant with the teleport flag was passed on the way. */
bool track_sample(track *t, double time_us, track_pose out[TRACK_COUNT]);

/* Spin, rad/s in world axes, that turns orientation q0 into q1 in dt, for turns that are small in one sub-step. */
static inline vec3 track_spin(dquat q0, dquat q1, double dt_s)
{
    dquat d = dquat_mul(q1, dquat_conjugate(q0));
    double s = (d.w < 0 ? -2.0 : 2.0) / dt_s;
    return (vec3){(float)(d.x * s), (float)(d.y * s), (float)(d.z * s)};
}

#endif
