/* Head-pose logs: columns, times, eyes, axes, and files that are wrong. */
#include "check.h"
#include "motion/motion.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PLAIN "timestamp,x,y,z,qx,qy,qz,qw\n"

static awt_status read_text(const char *text, const motion_options *options, motion *out, awt_error *error)
{
    return motion_read(text, strlen(text), options, out, error);
}

TEST(log_translation_is_relative_and_orientation_absolute)
{
    motion m = {0};
    awt_error error = {0};
    /* looking along -Z of the log is looking along +Z of the result: half a turn about Y for everything */
    CHECK_INT(read_text(PLAIN "100,1,2,3,0.6,0,0,0.8\n116,1.25,2.5,2,0,0,0.6,0.8\n", NULL, &m, &error), AWT_OK);
    CHECK_INT(m.sample_count, 2);
    const awt_pose *a = &m.samples[0].head, *b = &m.samples[1].head;
    CHECK_NEAR(a->position[0] + a->position[1] + a->position[2], 0, 0);
    CHECK_NEAR(b->position[0], -0.25, 1e-12);
    CHECK_NEAR(b->position[1], 0.5, 1e-12);
    CHECK_NEAR(b->position[2], 1, 1e-12);
    CHECK_NEAR(a->orientation[0], -0.6, 1e-12);
    CHECK_NEAR(a->orientation[3], 0.8, 1e-12);
    CHECK_NEAR(b->orientation[2], -0.6, 1e-12);
    CHECK_INT(m.samples[0].time_us, 0);
    CHECK_INT(m.samples[1].time_us, 16000);
    motion_fini(&m);
}

TEST(log_with_z_up_is_turned_to_y_up)
{
    motion m = {0};
    awt_error error = {0};
    const motion_options options = {.up = AWT_UP_Z, .scale = 2};
    CHECK_INT(read_text(PLAIN "0,0,0,0,0,0,0,1\n16,0,0,1,0,0,0.6,0.8\n", &options, &m, &error), AWT_OK);
    CHECK_NEAR(m.samples[1].head.position[1], 2, 1e-12);
    CHECK_NEAR(m.samples[1].head.orientation[1], 0.6, 1e-12);
    motion_fini(&m);
}

TEST(log_timestamps_keep_every_tick)
{
    motion m = {0};
    awt_error error = {0};
    /* 100-ns ticks since the year 1: a double would round them to multiples of 128 */
    CHECK_INT(read_text(PLAIN "636912345678901234,0,0,0,0,0,0,1\n636912345678901244,0,0,0,0,0,0,1\n"
                              "636912345679067901,0,0,0,0,0,0,1\n636912345679234567,0,0,0,0,0,0,1\n",
                        NULL, &m, &error),
              AWT_OK);
    CHECK_INT(m.sample_count, 4);
    CHECK_INT(m.samples[1].time_us, 1);
    CHECK_INT(m.samples[2].time_us, 16667);
    CHECK_INT(m.samples[3].time_us, 33333);
    CHECK(strstr(m.description, "timestamps in 100ns (guessed)") != NULL);
    motion_fini(&m);
}

TEST(log_time_unit_is_inferred_or_given)
{
    static const struct {
        const char *first, *second, *unit;
        double given_s;
        int64_t time_us;
    } cases[] = {
        {"0", "16", "ms (guessed)", 0, 16000},
        {"5000", "21667", "us (guessed)", 0, 16667},
        {"0", "166667", "100ns (guessed)", 0, 16667},
        {"0", "16666667", "ns (guessed)", 0, 16667},
        {"0.5", "0.516667", "s (guessed)", 0, 16667},
        {"-0.01", "0.01", "s (guessed)", 0, 20000},
        {"1700000000000", "1700000000100", "ms (guessed)", 0, 100000},
        {"1700000000000000", "1700000000001000", "us (guessed)", 0, 1000},
        {"133000000000000000", "133000000000010000", "100ns (guessed)", 0, 1000},
        {"1700000000000000000", "1700000000000500000", "ns (guessed)", 0, 500},
        {"640000000000000000", "640000000000010000", "100ns (guessed)", 0, 1000},
        {"0", "16", "s,", 1, 16000000},
        {"-9223372036854775808", "9223372036854775807", "the caller's unit", 1e-15, 18446744074},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[300];
        motion m = {0};
        awt_error error = {0};
        const motion_options options = {.time_unit_s = cases[i].given_s};
        snprintf(text, sizeof text, PLAIN "%s,0,0,0,0,0,0,1\n%s,0,0,0,0,0,0,1\n", cases[i].first, cases[i].second);
        CHECK_INT(read_text(text, &options, &m, &error), AWT_OK);
        CHECK_TEXT(error.text, "");
        CHECK_INT(m.sample_count, 2);
        CHECK_INT(m.samples[1].time_us, cases[i].time_us);
        CHECK(strstr(m.description, cases[i].unit) != NULL);
        motion_fini(&m);
    }
}

TEST(log_times_that_do_not_rise_are_dropped_and_counted)
{
    motion m = {0};
    awt_error error = {0};
    CHECK_INT(read_text(PLAIN "0,0,0,0,0,0,0,1\n16,1,0,0,0,0,0,1\n16,2,0,0,0,0,0,1\n10,3,0,0,0,0,0,1\n\n"
                              "32,4,0,0,0,0,0,1\r\n2032,5,0,0,0,0,0,1\n",
                        NULL, &m, &error),
              AWT_OK);
    CHECK_INT(m.sample_count, 4);
    CHECK_NEAR(m.samples[2].head.position[0], -4, 1e-12);
    CHECK(strstr(m.description, "left out: 2 rows not later") != NULL);
    /* a gap stays one: the head holds still at both of its ends */
    CHECK_INT(m.samples[3].time_us, 2032000);
    motion_sample early = motion_at(&m, 32000 + 2000);
    CHECK_NEAR(early.head.position[0], -4, 1e-5);
    motion_fini(&m);
    /* nor do they mislead the guess of the unit */
    CHECK_INT(read_text(PLAIN
                        "0,0,0,0,0,0,0,1\n16,1,0,0,0,0,0,1\n8,0,0,0,0,0,0,1\n24,0,0,0,0,0,0,1\n12,0,0,0,0,0,0,1\n",
                        NULL, &m, &error),
              AWT_OK);
    CHECK(m.sample_count == 3 && m.samples[2].time_us == 24000);
    motion_fini(&m);
}

TEST(log_quaternions_are_normalised_down_to_a_limit)
{
    motion m = {0};
    awt_error error = {0};
    CHECK_INT(read_text(PLAIN "0,0,0,0,0,0,0,0.9\n16,0,0,0,0,0,0,-1.1\n", NULL, &m, &error), AWT_OK);
    CHECK_NEAR(m.samples[0].head.orientation[3], 1, 1e-12);
    CHECK_NEAR(fabs(m.samples[1].head.orientation[3]), 1, 1e-12);
    /* q and -q are one turn: no spin between them */
    CHECK_NEAR(fabs(motion_at(&m, 8000).head.orientation[3]), 1, 1e-12);
    motion_fini(&m);
    CHECK_INT(read_text(PLAIN "0,0,0,0,0,0,0,1\n16,0,0,0,0,0.01,0,0\n", NULL, &m, &error), AWT_BAD_VALUE);
    CHECK(strstr(error.text, "line 3") != NULL);
}

#define EYES                                                                                                    \
    "\xef\xbb\xbfViewIndex,FOV1,PositionX,PositionY,PositionZ,QuaternionX,QuaternionY,QuaternionZ,QuaternionW," \
    "Timestamp\r\n"

TEST(log_of_two_eyes_is_the_mean_of_each_pair)
{
    motion m = {0};
    awt_error error = {0};
    /* a right eye without its left one, a left one without its right one */
    CHECK_INT(read_text(EYES "1,0,9,9,9,0,0,0,1,0\r\n0,0,0,0,0,0,0,0,1,10\r\n1,0,0.128,0,0,0,0,0,-1,12\r\n"
                             "0,0,5,5,5,0,0,0,1,20\r\n0,0,1,0,0,0,0,0.6,0.8,30\r\n1,0,1.128,0,0,0,0,-0.6,-0.8,32\r\n",
                        NULL, &m, &error),
              AWT_OK);
    CHECK_INT(m.sample_count, 2);
    /* 0.128 units between the eyes are 64 mm: half a metre a unit */
    CHECK_NEAR(m.samples[1].head.position[0], -0.5, 1e-9);
    CHECK_NEAR(m.samples[0].head.orientation[3], 1, 1e-12);
    CHECK_NEAR(m.samples[1].head.orientation[2], -0.6, 1e-12);
    CHECK_INT(m.samples[1].time_us, 20000);
    CHECK(strstr(m.description, "guessed from the eyes' distance") != NULL);
    CHECK(strstr(m.description, "2 without the other eye") != NULL);
    motion_fini(&m);
    const motion_options options = {.scale = 1};
    CHECK_INT(read_text(EYES "0,0,0,0,0,0,0,0,1,0\n1,0,0,0,0,0,0,0,1,0\n0,0,1,0,0,0,0,0,1,16\n1,0,1,0,0,0,0,0,1,16\n",
                        &options, &m, &error),
              AWT_OK);
    CHECK_NEAR(m.samples[1].head.position[0], -1, 1e-12);
    motion_fini(&m);
}

TEST(log_body_follows_the_heading_late_and_no_nod)
{
    char text[16384], *at = text;
    motion m = {0};
    awt_error error = {0};
    at += sprintf(at, PLAIN);
    for (int i = 0; i < 300; i++) {
        /* 3 s ahead and nodding, then 3 s turned by 90 degrees */
        double s = i < 150 ? 0 : sin(0.7853981634), c = i < 150 ? 1 : cos(0.7853981634);
        double nod = i < 150 ? 0.2 * sin(i * 0.3) : 0;
        at += sprintf(at, "%d,0,0,0,%.9f,%.9f,0,%.9f\n", i * 20, nod, s, c * sqrt(1 - nod * nod));
    }
    CHECK_INT(read_text(text, NULL, &m, &error), AWT_OK);
    CHECK_NEAR(m.samples[20].body.orientation[0], 0, 1e-12);
    CHECK_NEAR(m.samples[20].body.orientation[1], 0, 0.01);
    CHECK_NEAR(fabs(m.samples[299].body.orientation[1]), sin(0.7853981634), 0.02);
    double step = fabs(m.samples[150].body.orientation[1] - m.samples[149].body.orientation[1]);
    CHECK(step < 0.05);
    motion_fini(&m);
}

TEST(log_without_heading_is_a_plain_one)
{
    motion m = {0};
    awt_error error = {0};
    CHECK_INT(read_text("0,0,0,0,0,0,0,1\n16,1,0,0,0,0,0,1\n", NULL, &m, &error), AWT_OK);
    CHECK_INT(m.sample_count, 2);
    motion_fini(&m);
}

TEST(log_wrong_files_are_refused)
{
    static const struct {
        const char *text;
        awt_status status;
    } cases[] = {
        {PLAIN, AWT_TRUNCATED},
        {"a,b,c\n1,2,3\n", AWT_BAD_FORMAT},
        {PLAIN "0,0,0,0,0,0,0\n", AWT_BAD_FORMAT},
        {PLAIN "0,0,0,0,0,0,0,1,2\n", AWT_BAD_FORMAT},
        {PLAIN "0,nan,0,0,0,0,0,1\n", AWT_BAD_VALUE},
        {PLAIN "0,inf,0,0,0,0,0,1\n", AWT_BAD_VALUE},
        {PLAIN "0,1e200,0,0,0,0,0,1\n", AWT_BAD_VALUE},
        {PLAIN "0,,0,0,0,0,0,1\n", AWT_BAD_VALUE},
        {PLAIN "99999999999999999999,0,0,0,0,0,0,1\n", AWT_BAD_VALUE},
        {PLAIN "noon,0,0,0,0,0,0,1\n", AWT_BAD_VALUE},
        {PLAIN "1,0,0,0,0,0,0,1\n1.5,0,0,0,0,0,0,1\n", AWT_BAD_VALUE},
        {EYES "0,0,0,0,0,0,0,0,1,0\n0,0,0,0,0,0,0,0,1,5\n", AWT_TRUNCATED},
        {PLAIN "0,0,0,0,0,0,0,1\n16,1e8,0,0,0,0,0,1\n", AWT_BAD_VALUE},
        {PLAIN "0,0,0,0,0,0,0,1\n9223372036854775807,1,0,0,0,0,0,1\n", AWT_LIMIT},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        motion m = {0};
        awt_error error = {0};
        awt_status status = read_text(cases[i].text, NULL, &m, &error);
        CHECK_INT(status, cases[i].status);
        CHECK(strlen(error.text) > 0);
        if (status == AWT_OK) {
            motion_fini(&m);
        }
    }
}

TEST(log_cut_at_every_length_does_no_harm)
{
    static const char text[] = EYES "0,0,0,0,0,0,0,0,1,10\r\n1,0,0.1,0,0,0,0,0,-1,12\r\n0,0,1,0,0,0,0,0.6,0.8,30\r\n"
                                    "1,0,1.1,0,0,0,0,0.6,0.8,32\r\n";
    size_t accepted = 0;
    for (size_t size = 0; size < sizeof text; size++) {
        motion m = {0};
        awt_error error = {0};
        char *bytes = malloc(size + (size == 0));
        memcpy(bytes, text, size);
        if (motion_read(bytes, size, NULL, &m, &error) == AWT_OK) {
            accepted++;
            motion_fini(&m);
        }
        free(bytes);
    }
    CHECK(accepted > 0 && accepted < 40); /* only where a row is whole, or its last number is cut */
}

TEST(log_real_ones_show_the_speed_of_real_heads)
{
    static const struct {
        const char *file;
        double scale; /* metres per unit: 1 / the scene's scale (hmd_eyenavgs_scene_setting.csv) */
        double seconds;
        size_t poses;
    } logs[] = {{"motion/hmd_eyenavgs_user108_nyc.csv", 1 / 0.64, 75, 3164},
                {"motion/hmd_eyenavgs_user111_london.csv", 1 / 0.53, 58, 2088}};
    for (size_t i = 0; i < sizeof logs / sizeof logs[0]; i++) {
        const char *path = check_data(logs[i].file);
        if (!path) {
            check_skip("the real head-pose logs are not there (AWT_DATA)");
            return;
        }
        size_t size;
        unsigned char *bytes = check_read_file(path, &size);
        motion m = {0};
        awt_error error = {0};
        CHECK_INT(motion_read(bytes, size, NULL, &m, &error), AWT_OK);
        free(bytes);
        double fastest = 0, upright = 0, taken = 0;
        for (size_t k = 1; k < m.sample_count; k++) {
            const double *a = m.samples[k - 1].head.orientation, *b = m.samples[k].head.orientation;
            double dot = fabs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]);
            double dt = (double)(m.samples[k].time_us - m.samples[k - 1].time_us) * 1e-6;
            fastest = fmax(fastest, 2 * acos(fmin(1, dot)) * 57.29577951 / dt);
            upright += 1 - 2 * (b[0] * b[0] + b[2] * b[2]);
        }
        CHECK(sscanf(strstr(m.description, "timestamps in ms (guessed), "), "timestamps in ms (guessed), %lf",
                     &taken) == 1);
        printf("     %s: %s; up to %.0f degrees/s\n", logs[i].file, m.description, fastest);
        CHECK_INT(m.sample_count, logs[i].poses);
        CHECK_NEAR((double)m.samples[m.sample_count - 1].time_us * 1e-6, logs[i].seconds, 1);
        CHECK_NEAR(taken / logs[i].scale, 1, 0.1); /* the eyes' distance tells the scene's scale */
        CHECK(fastest > 100 && fastest < 700);
        CHECK(upright / (double)m.sample_count > 0.85);
        motion_fini(&m);
    }
}
