/* test_track.c: poses between updates. */
#include "check.h"

#include "sim/track.h"

#include <math.h>

static awt_motion pose_at(int64_t time_us, double x)
{
    awt_motion m = {.time_us = time_us};
    m.head.position[0] = m.body.position[0] = x;
    m.head.orientation[3] = m.body.orientation[3] = 1.0;
    return m;
}

static void start(track *t)
{
    awt_motion rest = pose_at(0, 0);
    CHECK_INT(track_init(t, &rest, NULL, 0, NULL), AWT_OK);
}

static double head_x(track *t, double time_us)
{
    track_pose out[TRACK_COUNT];
    track_sample(t, time_us, out);
    return out[TRACK_HEAD].position.x;
}

TEST(track_goes_through_the_poses_it_is_given)
{
    track t;
    start(&t);
    for (int n = 1; n <= 6; n++) {
        awt_motion m = pose_at(n * 16667, sin(n * 0.3));
        CHECK_INT(track_push(&t, &m, 0, NULL), AWT_OK);
    }
    for (int n = 1; n <= 6; n++) {
        CHECK_NEAR(head_x(&t, n * 16667.0), sin(n * 0.3), 1e-12);
    }
}

TEST(track_keeps_its_velocity_from_one_interval_to_the_next)
{
    track t;
    start(&t);
    const double xs[] = {0.01, 0.05, 0.02, 0.02};
    for (int n = 0; n < 4; n++) {
        awt_motion m = pose_at((n + 1) * 20000, xs[n]);
        track_push(&t, &m, 0, NULL);
    }
    const double h = 10.0;
    for (int n = 1; n <= 3; n++) {
        double before = head_x(&t, n * 20000.0 - h), at = head_x(&t, n * 20000.0), after = head_x(&t, n * 20000.0 + h);
        CHECK_NEAR((after - at) / h, (at - before) / h, 1e-8);
    }
}

TEST(track_holds_still_after_its_last_pose)
{
    track t;
    start(&t);
    awt_motion m = pose_at(10000, 1.0);
    track_push(&t, &m, 0, NULL);
    CHECK_NEAR(head_x(&t, 10000), 1.0, 0);
    CHECK_NEAR(head_x(&t, 900000), 1.0, 0);
}

TEST(track_starts_from_rest_after_a_long_gap)
{
    for (int long_gap = 0; long_gap < 2; long_gap++) {
        track t;
        start(&t);
        awt_motion a = pose_at(10000, 0.1), b = pose_at(10000 + (long_gap ? 300000 : 200000), 0.2);
        track_push(&t, &a, 0, NULL);
        track_push(&t, &b, 0, NULL);
        double x0 = head_x(&t, 10000), x1 = head_x(&t, 10100);
        double speed = (x1 - x0) / 100e-6;
        if (long_gap) {
            CHECK(fabs(speed) < 0.1);
        } else {
            CHECK_NEAR(speed, 10.0, 0.2); /* goes on at the 10 m/s it came with */
        }
    }
}

TEST(track_jumps_only_when_a_teleport_is_due)
{
    track t;
    start(&t);
    awt_motion m = pose_at(20000, 5.0);
    m.teleport = true;
    track_push(&t, &m, 0, NULL);
    track_pose out[TRACK_COUNT];
    CHECK(!track_sample(&t, 19999, out));
    CHECK_NEAR(out[TRACK_HEAD].position.x, 0.0, 0);
    CHECK(track_sample(&t, 20000, out));
    CHECK_NEAR(out[TRACK_HEAD].position.x, 5.0, 0);
    CHECK(!track_sample(&t, 20001, out));
}

TEST(track_refuses_what_is_no_pose)
{
    track t;
    start(&t);
    awt_motion m = pose_at(10, 0);
    m.head.orientation[3] = 1.1;
    CHECK_INT(track_push(&t, &m, 0, NULL), AWT_BAD_VALUE);
    m = pose_at(10, NAN);
    CHECK_INT(track_push(&t, &m, 0, NULL), AWT_BAD_VALUE);
    m = pose_at(10, 0);
    m.body.position[2] = INFINITY;
    CHECK_INT(track_push(&t, &m, 0, NULL), AWT_BAD_VALUE);
    m = pose_at(0, 0);
    CHECK_INT(track_push(&t, &m, 0, NULL), AWT_BAD_TIME);
    m = pose_at(AWT_MAX_TIME_US + 1, 0);
    CHECK_INT(track_push(&t, &m, 0, NULL), AWT_BAD_TIME);
    m = pose_at(10, 0);
    m.collider_count = 1;
    CHECK_INT(track_push(&t, &m, 0, NULL), AWT_BAD_VALUE); /* no obstacle has a frame of its own */
    CHECK_INT(t.queue_count, 0);
}

TEST(track_refuses_more_poses_than_may_wait)
{
    track t;
    start(&t);
    for (int n = 1; n <= AWT_MAX_QUEUED_POSES; n++) {
        awt_motion m = pose_at(n, 0);
        CHECK_INT(track_push(&t, &m, 0, NULL), AWT_OK);
    }
    awt_motion m = pose_at(AWT_MAX_QUEUED_POSES + 1, 0);
    CHECK_INT(track_push(&t, &m, 0, NULL), AWT_LIMIT);
}

TEST(track_turns_along_the_shorter_way_whatever_sign_a_quaternion_has)
{
    track t;
    start(&t);
    awt_motion m = pose_at(20000, 0);
    m.head.orientation[1] = -sin(0.1);
    m.head.orientation[3] = -cos(0.1); /* the same turn as (0, sin, 0, cos) */
    track_push(&t, &m, 0, NULL);
    track_pose out[TRACK_COUNT];
    track_sample(&t, 10000, out);
    CHECK(fabs(out[TRACK_HEAD].orientation.w) > cos(0.1));
}
