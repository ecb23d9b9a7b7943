/* motion.c: which reader a file belongs to, and the curve through the samples.
 *
 * Between samples runs a cubic Hermite curve. Its tangents are central differences over uneven times (weighted as a
 * parabola through three samples), which smooths what a sensor's last digit would otherwise put into the velocity.
 * They are zero at both ends of the clip and at both ends of a gap, so that the curve is C1 everywhere and nobody's
 * head flies through a pause of the recording. */
#include "motion/motion.h"

#include "base/error.h"
#include "motion/formats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOTION_GAP_US INT64_C(250000) /* CONTRACT.md: zero velocity after a gap longer than this */

/* A log's first line is text; other files may have a comma somewhere too. */
static bool line_is_log(text_span line)
{
    for (size_t i = 0; i < line.length; i++) {
        unsigned char c = (unsigned char)line.text[i];
        if (c < ' ' && c != '\t' && c != '\r') {
            return false;
        }
    }
    return line.length > 0 && memchr(line.text, ',', line.length) != NULL;
}

awt_status motion_read(const void *bytes, size_t size, const motion_options *options, motion *out, awt_error *error)
{
    static const motion_options nothing_known = {0};
    const motion_options *known = options ? options : &nothing_known;
    if (!(known->scale >= 0) || !(known->time_unit_s >= 0) || isinf(known->scale) || isinf(known->time_unit_s)) {
        return error_set(error, AWT_BAD_VALUE, "a scale and a time unit are positive numbers, or 0 to guess");
    }
    text_cursor text = text_begin(bytes, size), look = text;
    text_span word, line;
    if (text_next_word(&look, &word) && text_is(word, "HIERARCHY")) {
        return bvh_read(text, known, out, error);
    }
    look = text;
    if (text_next_line(&look, &line) && line_is_log(line)) {
        return headpose_read(text, known, out, error);
    }
    return error_set(error, AWT_BAD_FORMAT,
                     "not a motion file that awt reads: a BVH begins with HIERARCHY, a head-pose log is a CSV with the "
                     "columns timestamp,x,y,z,qx,qy,qz,qw");
}

/* A sample's two poses as one vector: head position and quaternion, body position and quaternion. */
enum { MOTION_WIDTH = 14 };

static void sample_values(const motion_sample *sample, double values[MOTION_WIDTH])
{
    memcpy(values, sample->head.position, 3 * sizeof(double));
    memcpy(values + 3, sample->head.orientation, 4 * sizeof(double));
    memcpy(values + 7, sample->body.position, 3 * sizeof(double));
    memcpy(values + 10, sample->body.orientation, 4 * sizeof(double));
}

/* A quaternion and its negative are the same turn: takes the one nearer to the reference's. */
static void values_align(double *q, const double *reference)
{
    if (q[0] * reference[0] + q[1] * reference[1] + q[2] * reference[2] + q[3] * reference[3] < 0) {
        for (int i = 0; i < 4; i++) {
            q[i] = -q[i];
        }
    }
}

static void sample_values_near(const motion_sample *sample, const double *reference, double values[MOTION_WIDTH])
{
    sample_values(sample, values);
    values_align(values + 3, reference + 3);
    values_align(values + 10, reference + 10);
}

/* Change per microsecond at sample i, in the signs of `here`. */
static void sample_tangent(const motion *m, size_t i, const double here[MOTION_WIDTH], double tangent[MOTION_WIDTH])
{
    memset(tangent, 0, MOTION_WIDTH * sizeof(double));
    if (i == 0 || i + 1 == m->sample_count) {
        return;
    }
    const motion_sample *s = &m->samples[i];
    int64_t before_us = s[0].time_us - s[-1].time_us, after_us = s[1].time_us - s[0].time_us;
    if (before_us > MOTION_GAP_US || after_us > MOTION_GAP_US) {
        return;
    }
    double before[MOTION_WIDTH], after[MOTION_WIDTH];
    sample_values_near(&s[-1], here, before);
    sample_values_near(&s[1], here, after);
    double h0 = (double)before_us, h1 = (double)after_us;
    for (int k = 0; k < MOTION_WIDTH; k++) {
        double slope0 = (here[k] - before[k]) / h0, slope1 = (after[k] - here[k]) / h1;
        tangent[k] = (h1 * slope0 + h0 * slope1) / (h0 + h1);
    }
}

static awt_pose pose_of_values(const double values[7])
{
    dquat q = dquat_unit((dquat){values[3], values[4], values[5], values[6]});
    return (awt_pose){{values[0], values[1], values[2]}, {q.x, q.y, q.z, q.w}};
}

/* The last sample at or before the time; there is one. */
static size_t motion_find(const motion *m, int64_t time_us)
{
    size_t low = 0, high = m->sample_count;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (m->samples[middle].time_us <= time_us) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

/* The time within the samples at which a clip that repeats is at time_us. */
static int64_t motion_fold(const motion *m, int64_t time_us)
{
    int64_t end_us = m->samples[m->sample_count - 1].time_us;
    return m->repeat_us > 0 && time_us > end_us ? end_us - m->repeat_us + (time_us - end_us) % m->repeat_us : time_us;
}

motion_sample motion_at(const motion *m, int64_t at_us)
{
    int64_t time_us = motion_fold(m, at_us);
    size_t i = motion_find(m, time_us);
    const motion_sample *s = &m->samples[i];
    motion_sample result = *s;
    result.time_us = at_us;
    if (time_us <= s->time_us || i + 1 == m->sample_count) {
        return result;
    }
    double a[MOTION_WIDTH], b[MOTION_WIDTH], tangent_a[MOTION_WIDTH], tangent_b[MOTION_WIDTH], at[MOTION_WIDTH];
    sample_values(s, a);
    sample_values_near(s + 1, a, b);
    sample_tangent(m, i, a, tangent_a);
    sample_tangent(m, i + 1, b, tangent_b);
    double h = (double)(s[1].time_us - s[0].time_us);
    double t = (double)(time_us - s[0].time_us) / h, u = 1 - t;
    for (int k = 0; k < MOTION_WIDTH; k++) {
        at[k] =
            u * u * (1 + 2 * t) * a[k] + t * t * (1 + 2 * u) * b[k] + h * t * u * (u * tangent_a[k] - t * tangent_b[k]);
    }
    result.head = pose_of_values(at);
    result.body = pose_of_values(at + 7);
    return result;
}

void motion_fini(motion *m)
{
    free(m->samples);
    *m = (motion){0};
}
