/* BVH files: the multiplication of channels, the choice of joints, scale and axes, and files that are wrong. */
#include "check.h"
#include "motion/motion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Five joints in a line; the head is the fifth. Rotations of the root and of the neck in orders of their own, a
 * translation at the neck, other end sites than the head's. Metres. */
#define SKELETON                                                                        \
    "HIERARCHY\nROOT Pelvis\n{\n OFFSET 0 1 0\n"                                        \
    " CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"         \
    " JOINT Leg { OFFSET 0.1 -0.9 0 End Site { OFFSET 0 -0.1 0 } }\n"                   \
    " JOINT Spine { OFFSET 0 0.2 0 CHANNELS 3 Yrotation Xrotation Zrotation\n"          \
    " JOINT Chest { OFFSET 0 0.2 0 CHANNELS 1 Xrotation\n"                              \
    " JOINT Neck { OFFSET 0 0.1 0 CHANNELS 4 yposition XROTATION Yrotation Zrotation\n" \
    " JOINT Head { OFFSET 0 0.1 0 CHANNELS 3 Zrotation Yrotation Xrotation\n"           \
    " End Site { OFFSET 0 0.2 0 } } } } } }\n"
#define TIMES(frames) "MOTION\nFrames: " frames "\nFrame Time: 0.01\n"
/*             root: x y z  rz rx ry  spine     chest neck           head */
#define ROW_REST "0 0 0  0 0 0   0 0 0   0   0 0 0 0   0 0 0\n"

static awt_status read_text(const char *text, const motion_options *options, motion *out, awt_error *error)
{
    return motion_read(text, strlen(text), options, out, error);
}

static void check_pose(const char *what, const awt_pose *got, double x, double y, double z, double qx, double qy,
                       double qz, double qw)
{
    const double expected[7] = {x, y, z, qx, qy, qz, qw};
    double sign =
        got->orientation[0] * qx + got->orientation[1] * qy + got->orientation[2] * qz + got->orientation[3] * qw < 0
            ? -1
            : 1;
    for (int i = 0; i < 7; i++) {
        double value = i < 3 ? got->position[i] : sign * got->orientation[i - 3];
        check_near(__FILE__, __LINE__, what, value, expected[i], 1e-9);
    }
}

#define HALF 0.70710678118654752

TEST(bvh_rest_puts_head_and_body_together)
{
    motion m = {0};
    awt_error error;
    CHECK_INT(read_text(SKELETON TIMES("1") ROW_REST, NULL, &m, &error), AWT_OK);
    CHECK_INT(m.sample_count, 1);
    /* the head joint stands at 1.6 m, its centre 8 cm above and 2 cm before it */
    check_pose("head", &m.samples[0].head, 0, 1.68, 0.02, 0, 0, 0, 1);
    check_pose("body", &m.samples[0].body, 0, 1.68, 0.02, 0, 0, 0, 1);
    CHECK(strstr(m.description, "head joint Head") && strstr(m.description, "body joint Spine"));
    CHECK(strstr(m.description, "1 m per unit (guessed)") != NULL);
    motion_fini(&m);
}

TEST(bvh_rotations_multiply_in_the_order_listed)
{
    motion m = {0};
    awt_error error;
    /* root: Z 90 then X 90: x -> y -> z, y -> -x -> -x, z -> z -> ... as Rz * Rx */
    CHECK_INT(read_text(SKELETON TIMES("1") "0 0 0  90 90 0   0 0 0   0   0 0 0 0   0 0 0\n", NULL, &m, &error),
              AWT_OK);
    /* Rz(90) Rx(90): y -> z -> z; z -> -y -> x. The chain of 0.6 m and the centre (0, .08, .02) above it:
     * 0.68 along y becomes 0.68 along z, 0.02 along z becomes 0.02 along x. */
    check_pose("head", &m.samples[0].head, 0.02, 1, 0.68, 0.5, 0.5, 0.5, 0.5);
    check_pose("body", &m.samples[0].body, 0.02, 1, 0.68, 0.5, 0.5, 0.5, 0.5);
    motion_fini(&m);
    /* spine: Y 90 then X 90 */
    CHECK_INT(read_text(SKELETON TIMES("1") "0 0 0  0 0 0   90 90 0   0   0 0 0 0   0 0 0\n", NULL, &m, &error),
              AWT_OK);
    /* Ry(90) Rx(90): y -> z -> x; z -> -y -> -y. Above the spine's joint: 0.48 along y, 0.02 along z. */
    check_pose("head", &m.samples[0].head, 0.48, 1.2 - 0.02, 0, 0.5, 0.5, -0.5, 0.5);
    motion_fini(&m);
}

TEST(bvh_translations_act_at_any_joint)
{
    motion m = {0};
    awt_error error;
    /* the neck goes up by 0.05, then its own X rotation of 90 tips what is above it forward */
    CHECK_INT(read_text(SKELETON TIMES("1") "0.5 0 0  0 0 0   0 0 0   0   0.05 90 0 0   0 0 0\n", NULL, &m, &error),
              AWT_OK);
    check_pose("head", &m.samples[0].head, 0.5, 1.55 - 0.02, 0.1 + 0.08, HALF, 0, 0, HALF);
    check_pose("body", &m.samples[0].body, 0.5, 1.68, 0.02, 0, 0, 0, 1);
    motion_fini(&m);
}

TEST(bvh_named_joints_scale_and_up_axis_are_taken)
{
    motion m = {0};
    awt_error error;
    const motion_options options = {.joint = "neck", .body_joint = "Pelvis", .scale = 0.5, .up = AWT_UP_Z};
    /* Z up: the file's y is -z; the neck turns 90 about the file's z, the world's y */
    CHECK_INT(read_text(SKELETON TIMES("1") "0 0 2  0 0 0   0 0 0   0   0 0 0 90   0 0 0\n", &options, &m, &error),
              AWT_OK);
    check_pose("neck", &m.samples[0].head, 0.02, 1 + 0.08, -0.75, 0, HALF, 0, HALF);
    check_pose("pelvis", &m.samples[0].body, 0, 1 + 0.08, -0.75 + 0.02, 0, 0, 0, 1);
    CHECK(strstr(m.description, "0.5 m per unit, Z up") != NULL);
    motion_fini(&m);
}

TEST(bvh_head_joint_is_guessed_by_name)
{
    motion m = {0};
    awt_error error;
    const char *contains = "HIERARCHY ROOT Hip { OFFSET 0 0 0 CHANNELS 1 Xrotation JOINT CC_Base_HEAD { OFFSET 0 1 0 "
                           "CHANNELS 1 Xrotation End Site { OFFSET 0 0.2 0 } } } " TIMES("1") "0 0\n";
    CHECK_INT(read_text(contains, NULL, &m, &error), AWT_OK);
    CHECK(strstr(m.description, "head joint CC_Base_HEAD, body joint Hip") != NULL);
    motion_fini(&m);
    const char *exact = "HIERARCHY ROOT Hip { OFFSET 0 0 0 CHANNELS 1 Xrotation JOINT forehead { OFFSET 0 1 0 } JOINT "
                        "Head { OFFSET 0 1 0 } } " TIMES("1") "0\n";
    CHECK_INT(read_text(exact, NULL, &m, &error), AWT_OK);
    CHECK(strstr(m.description, "head joint Head,") != NULL);
    motion_fini(&m);
}

TEST(bvh_missing_joint_is_refused_with_the_joints_there_are)
{
    motion m = {0};
    awt_error error = {0};
    const motion_options options = {.joint = "Skull"}, body = {.body_joint = "Hips"};
    CHECK_INT(read_text(SKELETON TIMES("1") ROW_REST, &options, &m, &error), AWT_BAD_VALUE);
    CHECK_TEXT(error.text, "the BVH file has no joint \"Skull\", the head may be Head; there are Pelvis, Leg, Spine, "
                           "Chest, Neck, Head");
    CHECK_INT(read_text(SKELETON TIMES("1") ROW_REST, &body, &m, &error), AWT_BAD_VALUE);
    CHECK_INT(read_text("HIERARCHY ROOT Hip { OFFSET 0 1 0 CHANNELS 1 Xrotation } " TIMES("1") "0\n", NULL, &m, &error),
              AWT_BAD_VALUE);
    CHECK(strstr(error.text, "Hip") != NULL);
}

TEST(bvh_scale_is_guessed_from_the_skeleton)
{
    static const struct {
        const char *height;
        double scale;
    } cases[] = {{"1.7", 1}, {"170", 0.01}, {"1700", 0.001}, {"5.6", 0.3048}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[300];
        motion m = {0};
        awt_error error = {0};
        snprintf(
            text, sizeof text,
            "HIERARCHY ROOT Hip { OFFSET 0 0 0 CHANNELS 1 Xrotation JOINT Head { OFFSET 0 %s 0 } } " TIMES("1") "0",
            cases[i].height);
        CHECK_INT(read_text(text, NULL, &m, &error), AWT_OK);
        CHECK_NEAR(m.samples[0].head.position[1], atof(cases[i].height) * cases[i].scale + 0.08, 1e-9);
        motion_fini(&m);
    }
    motion m = {0};
    awt_error error = {0};
    CHECK_INT(read_text("HIERARCHY ROOT Head { OFFSET 0 0 0 CHANNELS 1 Xrotation } " TIMES("1") "0", NULL, &m, &error),
              AWT_BAD_VALUE);
    CHECK(strstr(error.text, "scale") != NULL);
}

TEST(bvh_wrong_files_are_refused)
{
    static const struct {
        const char *text;
        awt_status status;
    } cases[] = {
        {SKELETON TIMES("2") ROW_REST, AWT_TRUNCATED},
        {SKELETON TIMES("1") ROW_REST ROW_REST, AWT_BAD_FORMAT},
        {SKELETON TIMES("0") ROW_REST, AWT_BAD_VALUE},
        {SKELETON TIMES("-1") ROW_REST, AWT_BAD_VALUE},
        {SKELETON TIMES("99999999999999999999") ROW_REST, AWT_BAD_VALUE},
        {SKELETON TIMES("400000") ROW_REST, AWT_TRUNCATED},
        {SKELETON TIMES("4000000000") ROW_REST, AWT_LIMIT},
        {SKELETON "MOTION\nFrames: 1\nFrame Time: 0\n" ROW_REST, AWT_BAD_VALUE},
        {SKELETON "MOTION\nFrames: 1\nFrame Time: nan\n" ROW_REST, AWT_BAD_VALUE},
        {SKELETON TIMES("1") "0 0 nan  0 0 0   0 0 0   0   0 0 0 0   0 0 0\n", AWT_BAD_VALUE},
        {SKELETON TIMES("1") "0 0 1e999  0 0 0   0 0 0   0   0 0 0 0   0 0 0\n", AWT_BAD_VALUE},
        {SKELETON TIMES("1") "0 0 1e300  0 0 0   0 0 0   0   0 0 0 0   0 0 0\n", AWT_BAD_VALUE},
        {SKELETON TIMES("1") "0 0 0x10  0 0 0   0 0 0   0   0 0 0 0   0 0 0\n", AWT_BAD_VALUE},
        {"HIERARCHY MOTION", AWT_BAD_FORMAT},
        {"HIERARCHY }", AWT_BAD_FORMAT},
        {"HIERARCHY ROOT Head { CHANNELS 7 X", AWT_BAD_VALUE},
        {"HIERARCHY ROOT Head { CHANNELS 1 Wrotation", AWT_BAD_FORMAT},
        {"HIERARCHY ROOT Head { JOINT x { OFFSET 0 0 0 } }", AWT_BAD_FORMAT},
        {"HIERARCHY ROOT Head { OFFSET 0 1 0 CHANNELS 0 } MOTION Frames: 400000 Frame Time: 1", AWT_BAD_VALUE},
        {"HIERARCHY ROOT Head { OFFSET 0 1 0 JOINT b { OFFSET 0 1 0 } } MOTION Frames: 9 Frame Time: 1",
         AWT_BAD_FORMAT},
        {"HIERARCHY ROOT Head { OFFSET 0 1 0 End Site { OFFSET 0 1 0 JOINT b { OFFSET 0 1 0 } } }", AWT_BAD_FORMAT},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        motion m = {0};
        awt_error error = {0};
        awt_status status = read_text(cases[i].text, NULL, &m, &error);
        CHECK_INT(status, cases[i].status);
        CHECK(status == AWT_OK || strlen(error.text) > 0);
        if (status == AWT_OK) {
            motion_fini(&m);
        }
    }
}

/* A file of `joints` joints, one inside the other. */
static char *deep_file(int joints)
{
    char *text = malloc((size_t)joints * 50 + 200), *at = text;
    at += sprintf(at, "HIERARCHY ROOT Head { OFFSET 0 1 0 CHANNELS 1 Xrotation\n");
    for (int i = 1; i < joints; i++) {
        at += sprintf(at, "JOINT j%d { OFFSET 0 0.001 0\n", i);
    }
    for (int i = 0; i < joints; i++) {
        at += sprintf(at, "} ");
    }
    sprintf(at, "\n" TIMES("1") "0\n");
    return text;
}

TEST(bvh_joints_are_limited)
{
    motion m = {0};
    awt_error error = {0};
    char *fits = deep_file(1024), *deeper = deep_file(1025);
    CHECK_INT(read_text(fits, NULL, &m, &error), AWT_OK);
    motion_fini(&m);
    CHECK_INT(read_text(deeper, NULL, &m, &error), AWT_LIMIT);
    free(fits);
    free(deeper);
}

/* Exactly as many bytes as are given, so that a sanitizer sees a read beyond them. */
static awt_status read_cut(const char *text, size_t size, motion *out)
{
    char *bytes = malloc(size + (size == 0));
    awt_error error = {0};
    memcpy(bytes, text, size);
    awt_status status = motion_read(bytes, size, NULL, out, &error);
    free(bytes);
    return status;
}

TEST(bvh_cut_at_every_length_is_refused)
{
    static const char text[] = SKELETON TIMES("2") ROW_REST ROW_REST;
    size_t whole = sizeof text - 2; /* up to the last digit */
    for (size_t size = 0; size < whole; size++) {
        motion m = {0};
        CHECK(read_cut(text, size, &m) != AWT_OK);
    }
    motion m = {0};
    CHECK_INT(read_cut(text, whole, &m), AWT_OK);
    motion_fini(&m);
}

/* Speed of a head in a real clip: greatest move (m/s) and turn (degrees/s) between frames. */
static void measure(const motion *m, double *move, double *turn)
{
    *move = *turn = 0;
    for (size_t i = 1; i < m->sample_count; i++) {
        const awt_pose *a = &m->samples[i - 1].head, *b = &m->samples[i].head;
        double dt = (double)(m->samples[i].time_us - m->samples[i - 1].time_us) * 1e-6, dot = 0, square = 0;
        for (int k = 0; k < 3; k++) {
            square += (b->position[k] - a->position[k]) * (b->position[k] - a->position[k]);
        }
        for (int k = 0; k < 4; k++) {
            dot += a->orientation[k] * b->orientation[k];
        }
        *move = fmax(*move, sqrt(square) / dt);
        *turn = fmax(*turn, 2 * acos(fmin(1, fabs(dot))) * 57.29577951 / dt);
    }
}

TEST(bvh_real_clips_move_a_head_as_people_do)
{
    static const struct {
        const char *file;
        size_t frames;
        double least_move, most_move, least_turn, most_turn, least_height, most_height;
    } clips[] = {
        {"motion/cmu_002_03_run.bvh", 86, 2, 6, 10, 400, 1.5, 1.9},
        {"motion/cmu_002_04_jump_balance.bvh", 241, 0.5, 5, 50, 600, 1.1, 2.4},
        {"motion/cmu_002_06_bend_over.bvh", 1118, 0.5, 4, 50, 600, 0.6, 1.9},
        {"motion/cmu_005_11_pirouette.bvh", 296, 0.5, 5, 600, 1300, 1.3, 2.2},
    };
    for (size_t i = 0; i < sizeof clips / sizeof clips[0]; i++) {
        const char *path = check_data(clips[i].file);
        if (!path) {
            check_skip("the real motion files are not there (AWT_DATA)");
            return;
        }
        size_t size;
        unsigned char *bytes = check_read_file(path, &size);
        motion m = {0};
        awt_error error = {0};
        CHECK_INT(motion_read(bytes, size, NULL, &m, &error), AWT_OK);
        CHECK_TEXT(error.text, "");
        free(bytes);
        double move, turn, lowest = 1e9, highest = -1e9;
        measure(&m, &move, &turn);
        for (size_t k = 0; k < m.sample_count; k++) {
            lowest = fmin(lowest, m.samples[k].head.position[1]);
            highest = fmax(highest, m.samples[k].head.position[1]);
        }
        printf("     %s: %s; up to %.2f m/s, %.0f degrees/s, height %.2f to %.2f m\n", clips[i].file, m.description,
               move, turn, lowest, highest);
        CHECK_INT(m.sample_count, clips[i].frames);
        CHECK(strstr(m.description, "head joint CC_Base_Head, body joint CC_Base_Spine02, 0.01 m per unit") != NULL);
        CHECK(move > clips[i].least_move && move < clips[i].most_move);
        CHECK(turn > clips[i].least_turn && turn < clips[i].most_turn);
        CHECK(lowest > clips[i].least_height && highest < clips[i].most_height);
        motion_fini(&m);
    }
}

TEST(motion_of_no_known_format_says_what_is_read)
{
    static const char *const files[] = {"", "TFX", "\x01\x02,timestamp,x"};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        motion m = {0};
        awt_error error = {0};
        CHECK_INT(read_text(files[i], NULL, &m, &error), AWT_BAD_FORMAT);
        CHECK(strstr(error.text, "not a motion file") != NULL);
    }
}
