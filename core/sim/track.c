/* track.c: see track.h. */
#include "sim/track.h"

#include "base/error.h"

#include <string.h>

static bool pose_read(const awt_pose *pose, track_pose *out)
{
    const double *p = pose->position, *o = pose->orientation;
    double length2 = o[0] * o[0] + o[1] * o[1] + o[2] * o[2] + o[3] * o[3];
    bool finite = isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]) && isfinite(length2);
    if (!finite || length2 < 0.998 || length2 > 1.002) {
        return false;
    }
    *out = (track_pose){.position = {p[0], p[1], p[2]}, .orientation = dquat_unit((dquat){o[0], o[1], o[2], o[3]})};
    return true;
}

/* All poses of a motion; own frames that it leaves out stay as in `before`. */
static awt_status instant_read(const track *t, const awt_motion *motion, const track_instant *before,
                               track_instant *out, awt_error *error)
{
    if (motion->time_us > AWT_MAX_TIME_US || motion->time_us < -AWT_MAX_TIME_US) {
        return error_set(error, AWT_BAD_TIME, "simulated time goes from -10^15 to 10^15 microseconds");
    }
    *out = *before;
    out->time_us = motion->time_us;
    out->teleport = motion->teleport;
    if (!pose_read(&motion->head, &out->pose[TRACK_HEAD]) || !pose_read(&motion->body, &out->pose[TRACK_BODY])) {
        return error_set(error, AWT_BAD_VALUE, "a pose is not finite, or its quaternion is not of unit length");
    }
    if (motion->collider_count > AWT_MAX_COLLIDERS) {
        return error_set(error, AWT_LIMIT, "%u obstacle poses; %d are the most", motion->collider_count,
                         AWT_MAX_COLLIDERS);
    }
    for (uint32_t c = 0; c < motion->collider_count; c++) {
        uint32_t k = 0;
        while (k < t->own_count && t->own_id[k] != motion->colliders[c].id) {
            k++;
        }
        if (k == t->own_count) {
            return error_set(error, AWT_BAD_VALUE, "obstacle %u has no frame of its own to pose",
                             motion->colliders[c].id);
        }
        if (!pose_read(&motion->colliders[c].pose, &out->pose[TRACK_OWN + k])) {
            return error_set(error, AWT_BAD_VALUE,
                             "the pose of obstacle %u is not finite, or its quaternion is not of unit length",
                             motion->colliders[c].id);
        }
    }
    return AWT_OK;
}

awt_status track_init(track *t, const awt_motion *start, const awt_collider *colliders, uint32_t collider_count,
                      awt_error *error)
{
    memset(t, 0, sizeof *t);
    for (uint32_t c = 0; c < collider_count; c++) {
        if (colliders[c].frame == AWT_FRAME_OWN) {
            t->own_id[t->own_count++] = colliders[c].id;
        }
    }
    track_instant before = {0};
    for (int k = 0; k < TRACK_COUNT; k++) {
        before.pose[k].orientation = dquat_identity();
    }
    return instant_read(t, start, &before, &t->last, error);
}

static track_instant *queue_at(track *t, uint32_t k)
{
    return &t->queue[track_queued(t, k)];
}

awt_status track_push(track *t, const awt_motion *motion, int64_t now_us, awt_error *error)
{
    const track_instant *before = t->queue_count > 0 ? queue_at(t, t->queue_count - 1) : &t->last;
    int64_t latest = before->time_us > now_us ? before->time_us : now_us;
    if (motion->time_us <= latest) {
        return error_set(error, AWT_BAD_TIME, "a pose for %.6f s came when %.6f s had been reached",
                         (double)motion->time_us * 1e-6, (double)latest * 1e-6);
    }
    if (t->queue_count == AWT_MAX_QUEUED_POSES) {
        return error_set(error, AWT_LIMIT, "%d poses wait already: advance the forest first", AWT_MAX_QUEUED_POSES);
    }
    track_instant instant;
    awt_status status = instant_read(t, motion, before, &instant, error);
    if (status == AWT_OK) {
        *queue_at(t, t->queue_count++) = instant;
    }
    return status;
}

static dquat dquat_scaled_difference(dquat to, dquat from, double s)
{
    return (dquat){(to.x - from.x) * s, (to.y - from.y) * s, (to.z - from.z) * s, (to.w - from.w) * s};
}

static dquat dquat_combine(const double w[4], dquat a, dquat b, dquat c, dquat d)
{
    return (dquat){w[0] * a.x + w[1] * b.x + w[2] * c.x + w[3] * d.x, w[0] * a.y + w[1] * b.y + w[2] * c.y + w[3] * d.y,
                   w[0] * a.z + w[1] * b.z + w[2] * c.z + w[3] * d.z,
                   w[0] * a.w + w[1] * b.w + w[2] * c.w + w[3] * d.w};
}

/* Gives `to` the one-sided rates of the interval of `seconds` that ends in it, and the quaternion's near sign. */
static void interval_finish(const track_pose *from, track_pose *to, double seconds)
{
    if (dquat_dot(from->orientation, to->orientation) < 0) {
        dquat q = to->orientation;
        to->orientation = (dquat){-q.x, -q.y, -q.z, -q.w};
    }
    to->velocity = dvec3_scale(dvec3_sub(to->position, from->position), 1.0 / seconds);
    to->rate = dquat_scaled_difference(to->orientation, from->orientation, 1.0 / seconds);
}

/* Cubic Hermite at share s of an interval of `seconds`. */
static track_pose interval_at(const track_pose *from, const track_pose *to, double seconds, double s)
{
    double s2 = s * s, s3 = s2 * s;
    double w[4] = {2 * s3 - 3 * s2 + 1, (s3 - 2 * s2 + s) * seconds, -2 * s3 + 3 * s2, (s3 - s2) * seconds};
    dvec3 p = dvec3_add(dvec3_add(dvec3_scale(from->position, w[0]), dvec3_scale(from->velocity, w[1])),
                        dvec3_add(dvec3_scale(to->position, w[2]), dvec3_scale(to->velocity, w[3])));
    dquat q = dquat_unit(dquat_combine(w, from->orientation, from->rate, to->orientation, to->rate));
    return (track_pose){.position = p, .orientation = q};
}

static void instant_halt(track_instant *instant)
{
    for (int k = 0; k < TRACK_COUNT; k++) {
        instant->pose[k].velocity = (dvec3){0, 0, 0};
        instant->pose[k].rate = (dquat){0, 0, 0, 0};
    }
}

/* Moves `last` on to the first instant of the queue, which takes the rates at which its interval ends. */
static void track_arrive(track *t)
{
    track_instant *next = queue_at(t, 0);
    double seconds = (double)(next->time_us - t->last.time_us) * 1e-6;
    if (next->teleport) {
        instant_halt(next);
    } else {
        for (int k = 0; k < TRACK_COUNT; k++) {
            interval_finish(&t->last.pose[k], &next->pose[k], seconds);
        }
    }
    t->last = *next;
    t->queue_first = track_queued(t, 1);
    t->queue_count--;
}

/* Holds the last pose until `time_us`, from which the next interval will start at rest. */
static void track_hold(track *t, double time_us)
{
    int64_t now = (int64_t)time_us;
    if (now > t->last.time_us) {
        t->last.time_us = now;
        instant_halt(&t->last);
    }
}

bool track_sample(track *t, double time_us, track_pose out[TRACK_COUNT])
{
    bool teleported = false;
    while (t->queue_count > 0 && (double)queue_at(t, 0)->time_us <= time_us) {
        teleported = teleported || queue_at(t, 0)->teleport;
        track_arrive(t);
    }
    if (t->queue_count == 0) {
        track_hold(t, time_us);
    }
    const track_instant *next = t->queue_count > 0 ? queue_at(t, 0) : NULL;
    if (!next || next->teleport || time_us <= (double)t->last.time_us) {
        for (int k = 0; k < TRACK_COUNT; k++) {
            out[k] = t->last.pose[k];
        }
        return teleported;
    }
    double seconds = (double)(next->time_us - t->last.time_us) * 1e-6;
    double share = (time_us - (double)t->last.time_us) / (double)(next->time_us - t->last.time_us);
    bool from_rest = next->time_us - t->last.time_us > TRACK_GAP_US;
    for (int k = 0; k < TRACK_COUNT; k++) {
        track_pose from = t->last.pose[k], to = next->pose[k];
        if (from_rest) {
            from.velocity = (dvec3){0, 0, 0};
            from.rate = (dquat){0, 0, 0, 0};
        }
        interval_finish(&from, &to, seconds);
        out[k] = interval_at(&from, &to, seconds, share);
    }
    return teleported;
}
