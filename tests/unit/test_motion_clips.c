/* The built-in clips, and the curve through samples. */
#include "check.h"
#include "motion/motion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const CLIPS[] = {"lean", "jump", "run", "shake"};

enum { CLIP_COUNT = sizeof CLIPS / sizeof CLIPS[0], WIDTH = 14 };

static void values_of(const motion_sample *s, double values[WIDTH])
{
    memcpy(values, s->head.position, 3 * sizeof(double));
    memcpy(values + 3, s->head.orientation, 4 * sizeof(double));
    memcpy(values + 7, s->body.position, 3 * sizeof(double));
    memcpy(values + 10, s->body.orientation, 4 * sizeof(double));
}

static double distance(const double *a, const double *b, int count)
{
    double square = 0;
    for (int k = 0; k < count; k++) {
        square += (b[k] - a[k]) * (b[k] - a[k]);
    }
    return sqrt(square);
}

TEST(clips_last_ten_seconds_and_begin_and_end_at_rest)
{
    for (int c = 0; c < CLIP_COUNT; c++) {
        motion m = {0};
        CHECK(motion_builtin(CLIPS[c], &m));
        CHECK_INT(m.sample_count, 2401);
        CHECK_INT(m.samples[2400].time_us, 10000000);
        double first[WIDTH], values[WIDTH], moved = 0;
        values_of(&m.samples[0], first);
        CHECK_BYTES(&m.samples[0].head, &m.samples[0].body, sizeof(awt_pose));
        for (size_t i = 0; i < m.sample_count; i++) {
            values_of(&m.samples[i], values);
            double off = distance(first, values, WIDTH);
            if (i <= 240 || i >= 2100) {
                CHECK_NEAR(off, 0, 1e-12);
            }
            CHECK_NEAR(distance((const double[4]){0}, values + 3, 4), 1, 1e-12);
            CHECK(i == 0 || m.samples[i].time_us > m.samples[i - 1].time_us);
            moved = fmax(moved, off);
        }
        CHECK(moved > 0.05);
        motion_fini(&m);
    }
    motion m = {0};
    CHECK(!motion_builtin("fly", &m));
    CHECK(!motion_builtin(NULL, &m));
}

/* The change of velocity from sample to sample stays as small as accelerations of people make it: no kink. */
TEST(clips_have_no_jump_in_velocity)
{
    for (int c = 0; c < CLIP_COUNT; c++) {
        motion m = {0};
        CHECK(motion_builtin(CLIPS[c], &m));
        double greatest = 0;
        for (size_t i = 1; i + 1 < m.sample_count; i++) {
            double a[WIDTH], b[WIDTH], d[WIDTH];
            values_of(&m.samples[i - 1], a);
            values_of(&m.samples[i], b);
            values_of(&m.samples[i + 1], d);
            for (int k = 0; k < WIDTH; k++) {
                greatest = fmax(greatest, fabs((d[k] - b[k]) - (b[k] - a[k])) * 240 * 240);
            }
        }
        printf("     %s: greatest acceleration %.1f /s2\n", CLIPS[c], greatest);
        CHECK(greatest < 100);
        motion_fini(&m);
    }
}

TEST(clips_lean_as_the_measurements_want_it)
{
    motion m = {0};
    CHECK(motion_builtin("lean", &m));
    /* two bows of 55 degrees between 1 s and 4 s; the hips, 0.55 m below the head's centre, stay */
    const motion_sample *deepest = &m.samples[(size_t)(1.75 * 240)];
    CHECK_NEAR(2 * asin(deepest->body.orientation[0]) * 57.29577951, 55, 1e-6);
    CHECK_NEAR(deepest->body.position[1] - (1.6 - 0.55), 0.55 * cos(55 / 57.29577951), 1e-6);
    CHECK_NEAR(deepest->body.position[2], 0.55 * sin(55 / 57.29577951), 1e-6);
    CHECK(deepest->head.orientation[0] > deepest->body.orientation[0]);
    CHECK_NEAR(m.samples[4 * 240].body.orientation[0], 0, 1e-9);
    motion_fini(&m);
}

TEST(clips_lean_forever_bows_without_a_rest)
{
    motion lean = {0}, m = {0};
    double expected[WIDTH], values[WIDTH], greatest = 0;
    CHECK(motion_builtin("lean", &lean) && motion_builtin("lean-forever", &m));
    for (int64_t t = 0; t < 3600000000; t = t < 12000000 ? t + 5000 : t * 3) { /* every bow is the lean's first */
        int64_t in_bow = t < 1000000 ? t : 1000000 + (t - 1000000) % 1500000;
        motion_sample at = motion_at(&m, t), first = motion_at(&lean, in_bow);
        values_of(&at, values);
        values_of(&first, expected);
        CHECK_INT(at.time_us, t);
        CHECK_NEAR(distance(values, expected, WIDTH), 0, 1e-5);
    }
    /* no kink where it begins again */
    for (int64_t t = 9900000; t < 10100000; t += 4000) {
        double a[WIDTH], b[WIDTH], c[WIDTH];
        motion_sample samples[3] = {motion_at(&m, t - 4000), motion_at(&m, t), motion_at(&m, t + 4000)};
        values_of(&samples[0], a);
        values_of(&samples[1], b);
        values_of(&samples[2], c);
        for (int k = 0; k < WIDTH; k++) {
            greatest = fmax(greatest, fabs(c[k] - 2 * b[k] + a[k]) * 250 * 250);
        }
    }
    CHECK(greatest > 1 && greatest < 20);
    motion_fini(&lean);
    motion_fini(&m);
}

TEST(clips_jump_flies_under_gravity)
{
    motion m = {0};
    CHECK(motion_builtin("jump", &m));
    double highest = 0;
    size_t flying = 0;
    for (size_t i = 1; i + 1 < m.sample_count; i++) {
        double height = m.samples[i].body.position[1] - 1.6;
        double lower = fmin(m.samples[i - 1].body.position[1], m.samples[i + 1].body.position[1]) - 1.6;
        highest = fmax(highest, height);
        if (lower > 0.02) {
            double acceleration = (m.samples[i + 1].head.position[1] - 2 * m.samples[i].head.position[1] +
                                   m.samples[i - 1].head.position[1]) *
                                  240 * 240;
            CHECK_NEAR(acceleration, -9.81, 0.02);
            flying++;
        }
    }
    CHECK_NEAR(highest, 2.2 * 2.2 / (2 * 9.81), 1e-3);
    CHECK(flying > 400);
    motion_fini(&m);
}

static motion_sample sample_at(int64_t time_us, double x, double degrees)
{
    double half = degrees / 57.29577951308232 / 2;
    awt_pose pose = {{x, 0, 0}, {0, sin(half), 0, cos(half)}};
    return (motion_sample){time_us, pose, pose};
}

TEST(curve_goes_through_samples_and_holds_at_its_ends)
{
    motion_sample samples[] = {sample_at(0, 0, 0), sample_at(10000, 1, 10), sample_at(30000, 2, -30),
                               sample_at(40000, 0, 350)};
    motion m = {.sample_count = 4, .samples = samples};
    for (int i = 0; i < 4; i++) {
        motion_sample at = motion_at(&m, samples[i].time_us);
        CHECK_NEAR(at.head.position[0], samples[i].head.position[0], 1e-12);
        CHECK_NEAR(fabs(at.body.orientation[1]), fabs(samples[i].body.orientation[1]), 1e-12);
    }
    CHECK_NEAR(motion_at(&m, -5).head.position[0], 0, 0);
    CHECK_NEAR(motion_at(&m, INT64_MAX).head.position[0], 0, 0);
    CHECK_INT(motion_at(&m, 12345).time_us, 12345);
    /* 350 degrees have the quaternion of -10 with the other sign: the way from -30 is 20 degrees long */
    double *q = motion_at(&m, 35000).head.orientation;
    double degrees = 2 * atan2(q[1], q[3]) * 57.29577951;
    CHECK(degrees > -35 && degrees < -5);
}

TEST(curve_has_one_velocity_at_each_sample)
{
    motion_sample samples[] = {sample_at(0, 0, 0), sample_at(10000, 1, 20), sample_at(34000, 1.5, 25),
                               sample_at(50000, 0, 5), sample_at(66000, 0, 5)};
    motion m = {.sample_count = 5, .samples = samples};
    for (int i = 0; i < 5; i++) {
        int64_t t = samples[i].time_us, h = 20;
        motion_sample before = motion_at(&m, t - h), here = motion_at(&m, t), after = motion_at(&m, t + h);
        double in = (here.head.position[0] - before.head.position[0]) / (double)h;
        double out = (after.head.position[0] - here.head.position[0]) / (double)h;
        CHECK_NEAR(out, in, 2e-6);
        double turn_in = (here.head.orientation[1] - before.head.orientation[1]) / (double)h;
        double turn_out = (after.head.orientation[1] - here.head.orientation[1]) / (double)h;
        CHECK_NEAR(turn_out, turn_in, 2e-6);
    }
    /* a parabola's samples give back its velocity: x = t^2 at 0, 1, 3 */
    motion_sample parabola[] = {sample_at(0, 0, 0), sample_at(10000, 1, 0), sample_at(30000, 9, 0),
                                sample_at(40000, 16, 0)};
    motion p = {.sample_count = 4, .samples = parabola};
    CHECK_NEAR(motion_at(&p, 20000).head.position[0], 4, 1e-9);
}
