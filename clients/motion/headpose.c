/* headpose.c: CSV logs of a head's pose (DATA.md) to head and body poses.
 *
 * Logs of head-mounted displays hold a row for each eye: the head is the mean of a pair.
 *
 * Frame. Such logs are right-handed, Y up, and the wearer looks along -Z (OpenXR, OpenGL cameras): in the real ones
 * the right eye stands at +X of the left one in the head's own axes. The contract's face looks along +Z, so space is
 * turned half a turn about Y, positions and orientations alike: who looks straight ahead has no turn, and the face
 * looks where the wearer looked. Orientation is absolute, translation relative to the first sample.
 *
 * Body. Nothing tracks it. It goes where the head goes and turns with the head's heading, smoothed forwards and
 * backwards: shoulders follow a turn of the head late, and a nod not at all. */
#include "motion/formats.h"

#include "base/error.h"
#include "motion/poselog.h"
#include "motion/timeunit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define HEADPOSE_BODY_TAU_S 0.4 /* time constant of each pass of the body's heading */
#define HEADPOSE_EYES_M 0.064   /* mean distance of an adult's pupils: the unit of a log with two eyes */

/* A log on its way to samples. */
typedef struct headpose {
    poselog log;
    size_t unpaired, not_rising; /* left out */
    double eye_distance;         /* mean, file units; 0: a plain log */
    double unit_s, scale;        /* as taken */
    bool guessed_unit, guessed_scale;
} headpose;

/* Of a left and a right eye the head between them, at the left one's time. */
static poselog_reading reading_mean(const poselog_reading *left, const poselog_reading *right)
{
    poselog_reading mean = *left;
    dquat a = left->orientation, b = right->orientation;
    double sign = dquat_dot(a, b) < 0 ? -1 : 1;
    mean.position = dvec3_scale(dvec3_add(left->position, right->position), 0.5);
    mean.orientation = dquat_unit((dquat){a.x + sign * b.x, a.y + sign * b.y, a.z + sign * b.z, a.w + sign * b.w});
    return mean;
}

/* Rows of one eye without the other are left out: half a head's width would look like a jump. */
static void readings_pair(headpose *h)
{
    size_t kept = 0;
    double distance = 0;
    for (size_t i = 0; i < h->log.count; i++) {
        const poselog_reading *r = &h->log.readings[i];
        if (i + 1 == h->log.count || r[0].view != 0 || r[1].view != 1) {
            h->unpaired++;
            continue;
        }
        distance += dvec3_length(dvec3_sub(r[1].position, r[0].position));
        h->log.readings[kept++] = reading_mean(&r[0], &r[1]);
        i++;
    }
    h->log.count = kept;
    h->eye_distance = kept > 0 ? distance / (double)kept : 0;
}

static void readings_drop_not_rising(headpose *h)
{
    size_t kept = 0;
    for (size_t i = 0; i < h->log.count; i++) {
        if (kept > 0 && h->log.readings[i].ticks <= h->log.readings[kept - 1].ticks) {
            h->not_rising++;
        } else {
            h->log.readings[kept++] = h->log.readings[i];
        }
    }
    h->log.count = kept;
}

static int spacing_order(const void *left, const void *right)
{
    double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

/* From one tick to a later one, without overflow. */
static double ticks_between(int64_t from, int64_t to)
{
    return (double)((uint64_t)to - (uint64_t)from);
}

static awt_status headpose_choose_unit(headpose *h, double given_s, awt_error *error)
{
    double fraction = h->log.has_fractions ? POSELOG_FRACTION : 1;
    h->unit_s = given_s;
    if (given_s == 0 && h->log.count > 1) {
        double *spacing = malloc((h->log.count - 1) * sizeof *spacing);
        if (!spacing) {
            return error_set(error, AWT_NO_MEMORY, NULL);
        }
        for (size_t i = 0; i + 1 < h->log.count; i++) {
            spacing[i] = ticks_between(h->log.readings[i].ticks, h->log.readings[i + 1].ticks) / fraction;
        }
        qsort(spacing, h->log.count - 1, sizeof *spacing, spacing_order);
        h->unit_s = timeunit_guess((double)h->log.readings[0].ticks / fraction, spacing[(h->log.count - 1) / 2]);
        h->guessed_unit = true;
        free(spacing);
    }
    if (h->log.count == 0) {
        return error_set(error, AWT_TRUNCATED, "the log holds no pose%s",
                         h->unpaired > 0 ? ": its rows do not come in pairs of ViewIndex 0 and 1" : "");
    }
    double length =
        ticks_between(h->log.readings[0].ticks, h->log.readings[h->log.count - 1].ticks) / fraction * h->unit_s;
    if (length * 1e6 > (double)MOTION_MAX_TIME_US) {
        return error_set(error, AWT_LIMIT,
                         "the log would last %.3g hours, a day at most is taken: is the time unit (%s) right?",
                         length / 3600, timeunit_name(h->unit_s));
    }
    return AWT_OK;
}

static void headpose_choose_scale(headpose *h, double given)
{
    h->scale = given;
    if (given == 0) {
        bool by_eyes = h->eye_distance > 1e-9;
        h->scale = by_eyes ? HEADPOSE_EYES_M / h->eye_distance : 1;
        h->guessed_scale = true;
    }
}

/* The contract's axes: half a turn about Y (see the file's head). */
static awt_pose headpose_head(const headpose *h, const poselog_reading *r, awt_up_axis up)
{
    rigid moved = {r->orientation, dvec3_sub(r->position, h->log.readings[0].position)};
    rigid metres = motion_to_metres(moved, h->scale, up);
    dquat q = metres.turn;
    dvec3 p = metres.move;
    return motion_pose((rigid){{-q.x, q.y, -q.z, q.w}, {-p.x, p.y, -p.z}});
}

/* The part of a head's turn that is about the vertical; `otherwise` where it hangs head down. */
static dquat heading_of(const awt_pose *head, dquat otherwise)
{
    dquat q = {0, head->orientation[1], 0, head->orientation[3]};
    if (dquat_dot(q, q) < 1e-4) {
        return otherwise;
    }
    double sign = dquat_dot(q, otherwise) < 0 ? -1 : 1;
    return dquat_unit((dquat){0, sign * q.y, 0, sign * q.w});
}

static dquat heading_follow(dquat state, dquat target, int64_t elapsed_us)
{
    double share = 1 - exp(-(double)elapsed_us * 1e-6 / HEADPOSE_BODY_TAU_S);
    double sign = dquat_dot(state, target) < 0 ? -1 : 1;
    return dquat_unit(
        (dquat){0, state.y + (sign * target.y - state.y) * share, 0, state.w + (sign * target.w - state.w) * share});
}

static void samples_add_bodies(motion_sample *samples, size_t count)
{
    dquat state = heading_of(&samples[0].head, dquat_identity());
    for (size_t i = 0; i < count; i++) {
        int64_t elapsed = i > 0 ? samples[i].time_us - samples[i - 1].time_us : 0;
        state = heading_follow(state, heading_of(&samples[i].head, state), elapsed);
        const double *p = samples[i].head.position;
        samples[i].body = (awt_pose){{p[0], p[1], p[2]}, {0, state.y, 0, state.w}};
    }
    for (size_t i = count; i-- > 0;) {
        double *q = samples[i].body.orientation;
        int64_t elapsed = i + 1 < count ? samples[i + 1].time_us - samples[i].time_us : 0;
        state = heading_follow(state, (dquat){0, q[1], 0, q[3]}, elapsed);
        q[1] = state.y;
        q[3] = state.w;
    }
}

/* Two times of the log that fall on one microsecond are one. */
static awt_status samples_make(headpose *h, awt_up_axis up, motion *out, awt_error *error)
{
    motion_sample *samples = malloc(h->log.count * sizeof *samples);
    if (!samples) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    size_t count = 0;
    double us_per_tick = h->unit_s * 1e6 / (h->log.has_fractions ? POSELOG_FRACTION : 1);
    for (size_t i = 0; i < h->log.count; i++) {
        const poselog_reading *r = &h->log.readings[i];
        int64_t time_us = llround(ticks_between(h->log.readings[0].ticks, r->ticks) * us_per_tick);
        if (count > 0 && time_us <= samples[count - 1].time_us) {
            h->not_rising++;
            continue;
        }
        awt_pose head = headpose_head(h, r, up);
        samples[count++] = (motion_sample){.time_us = time_us, .head = head, .body = head};
        if (!(fabs(head.position[0]) + fabs(head.position[1]) + fabs(head.position[2]) <= MOTION_MAX_DISTANCE_M)) {
            free(samples);
            return error_set(error, AWT_BAD_VALUE, "the log puts the head more than %g km away: is the scale right?",
                             MOTION_MAX_DISTANCE_M / 1000);
        }
    }
    samples_add_bodies(samples, count);
    *out = (motion){.sample_count = count, .samples = samples};
    return AWT_OK;
}

static void headpose_describe(const headpose *h, motion *out)
{
    snprintf(out->description, sizeof out->description,
             "head-pose log%s, %zu poses in %.1f s, timestamps in %s%s, %.4g m per unit%s, wearer looks along -Z; left "
             "out: %zu rows not later than the one before, %zu without the other eye",
             h->log.has_views ? " of two eyes" : "", out->sample_count,
             (double)out->samples[out->sample_count - 1].time_us * 1e-6, timeunit_name(h->unit_s),
             h->guessed_unit ? " (guessed)" : "", h->scale,
             !h->guessed_scale        ? ""
             : h->eye_distance > 1e-9 ? " (guessed from the eyes' distance)"
                                      : " (guessed)",
             h->not_rising, h->unpaired);
}

awt_status headpose_read(text_cursor text, const motion_options *options, motion *out, awt_error *error)
{
    headpose h = {0};
    awt_status status = poselog_read(text, &h.log, error);
    if (status != AWT_OK) {
        goto fail;
    }
    if (h.log.has_views) {
        readings_pair(&h);
    }
    readings_drop_not_rising(&h);
    if ((status = headpose_choose_unit(&h, options->time_unit_s, error)) != AWT_OK) {
        goto fail;
    }
    headpose_choose_scale(&h, options->scale);
    if ((status = samples_make(&h, options->up, out, error)) != AWT_OK) {
        goto fail;
    }
    headpose_describe(&h, out);
fail:
    poselog_fini(&h.log);
    return status;
}
