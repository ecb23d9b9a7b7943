/* builtin.c: the clips that need no file. Each is still for its first second and rests at its end (or begins there
 * anew), and moves smoothly (C1) between, so that a clip tests what it is meant to test and not a jerk of its own.
 *
 * A clip says at each time how far the whole person is displaced, how the upper body turns about the hips, and how the
 * head turns about the top of the neck; the poses follow from these. */
#include "motion/motion.h"

#include "base/trig.h"
#include "motion/formats.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BUILTIN_RATE = 240, BUILTIN_LENGTH_S = 10, BUILTIN_SAMPLES = BUILTIN_RATE * BUILTIN_LENGTH_S + 1 };

static const dvec3 BUILTIN_REST_M = {0, 1.6, 0};           /* centre of the head of somebody who stands at the origin */
static const dvec3 BUILTIN_HIPS_M = {0, -0.55, 0};         /* from there */
static const dvec3 BUILTIN_NECK_TOP_M = {0, -0.09, -0.02}; /* from there */

/* Turns in radians: pitch (forward), yaw (to the left), roll (to the left). */
typedef struct turns {
    double pitch, yaw, roll;
} turns;

typedef struct posture {
    dvec3 move_m; /* of the whole person */
    turns body;   /* about the hips */
    turns head;   /* about the top of the neck, on top of the body's */
} posture;

static double radians(double degrees)
{
    return degrees * (TRIG_PI / 180);
}

/* 0 before `from`, 1 after `to`, with no velocity and no acceleration at either. */
static double ramp(double t, double from, double to)
{
    double u = (t - from) / (to - from);
    u = u < 0 ? 0 : u > 1 ? 1 : u;
    return u * u * u * (u * (u * 6 - 15) + 10);
}

/* 1 between, with ramps of `edge` inside both ends. */
static double window(double t, double from, double to, double edge)
{
    return ramp(t, from, from + edge) * (1 - ramp(t, to - edge, to));
}

#define BOW_FROM_S 1.0
#define BOW_S 1.5

/* So many bows from the hips after a second, 55 degrees deep, the head nodding along. */
static posture posture_bows(double t, int bows)
{
    double u = t < BOW_FROM_S || t > BOW_FROM_S + bows * BOW_S ? 0 : sin((t - BOW_FROM_S) * TRIG_PI / BOW_S);
    double bow = u * u;
    return (posture){.body = {.pitch = radians(55) * bow}, .head = {.pitch = radians(20) * bow * bow}};
}

/* PHYSICS.md's lean: 1 s still, 3 s of two bows, 6 s rest. */
static posture posture_lean(double t)
{
    return posture_bows(t, 2);
}

/* The bows alone, as many as the clip has room for; the last ends with the clip, and then they begin again. */
static posture posture_lean_forever(double t)
{
    return posture_bows(t, 6);
}

/* A height and the velocity there; cubic Hermite pieces between. A flight from v up to v down is one such piece, and
 * exactly a parabola under gravity when it lasts 2 v / g. */
typedef struct hop_key {
    double duration_s; /* of the piece that ends here */
    double height_m, velocity;
} hop_key;

#define HOP_SPEED 2.2 /* m/s at take-off: 25 cm high */
#define HOP_CROUCH_M -0.22

enum { HOPS = 5, HOP_PARTS = 3, HOP_KEYS = 2 + HOPS * HOP_PARTS + 1 };

/* A second of standing, a crouch, hops each landing in the crouch from which the next begins, and up again. */
static hop_key hop_key_at(int index)
{
    static const hop_key before[2] = {{1.0, 0, 0}, {0.4, HOP_CROUCH_M, 0}};
    static const hop_key hop[HOP_PARTS] = {
        {0.24, 0, HOP_SPEED}, {2 * HOP_SPEED / 9.81, 0, -HOP_SPEED}, {0.22, HOP_CROUCH_M, 0}};
    static const hop_key after = {0.5, 0, 0};
    return index < 2 ? before[index] : index < HOP_KEYS - 1 ? hop[(index - 2) % HOP_PARTS] : after;
}

static double hop_height(double t)
{
    hop_key from = {0, 0, 0};
    for (int i = 0; i < HOP_KEYS; i++) {
        hop_key to = hop_key_at(i);
        double h = to.duration_s, s = t / h, r = 1 - s;
        if (t < h) {
            return r * r * (1 + 2 * s) * from.height_m + s * s * (1 + 2 * r) * to.height_m +
                   h * s * r * (r * from.velocity - s * to.velocity);
        }
        t -= h;
        from = to;
    }
    return 0;
}

/* The upper body leans forward with the square of the crouch, so that it passes zero without a kink. */
static posture posture_jump(double t)
{
    double height = hop_height(t), crouch = height < 0 ? height / HOP_CROUCH_M : 0;
    return (posture){.move_m = {0, height, 0},
                     .body = {.pitch = radians(18) * crouch * crouch},
                     .head = {.pitch = radians(-8) * crouch * crouch}};
}

/* On a treadmill: 2.8 steps a second, each a bounce; the body sways and turns over two steps. Starts and stops within
 * a second each. */
static posture posture_run(double t)
{
    double on = window(t, 1, 8.5, 1), step = 2 * TRIG_PI * 2.8 * (t - 1), stride = step / 2;
    return (posture){.move_m = {0.03 * on * sin(stride), -0.035 * on * (1 - cos(step)), 0.012 * on * sin(step)},
                     .body = {radians(8) * on, radians(6) * on * sin(stride), radians(2) * on * sin(stride)},
                     .head = {radians(-5) * on + radians(3) * on * sin(step), radians(-4) * on * sin(stride), 0}};
}

/* "No" at 2 Hz, 50 degrees to each side, then nods at 1.5 Hz, 25 degrees. The body stands still. */
static posture posture_shake(double t)
{
    double no = window(t, 1, 4.5, 0.5), nod = window(t, 4.75, 7.75, 0.5);
    return (posture){.head = {.pitch = radians(25) * nod * sin(2 * TRIG_PI * 1.5 * (t - 4.75)),
                              .yaw = radians(50) * no * sin(2 * TRIG_PI * 2 * (t - 1))}};
}

static const struct {
    const char *name, *description;
    posture (*at)(double t);
    int64_t repeat_us;
} BUILTINS[] = {
    {"lean", "built-in lean: 1 s still, 3 s of two bows forward from the hips, 6 s rest", posture_lean, 0},
    {"jump", "built-in jump: a crouch and five hops of 25 cm, then rest", posture_jump, 0},
    {"run", "built-in run: 2.8 steps a second on a treadmill, then rest", posture_run, 0},
    {"shake", "built-in shake: \"no\" at 2 Hz, 50 degrees to each side, then nods, then rest", posture_shake, 0},
    {"lean-forever", "built-in lean without end: 1 s still, then bows forward from the hips every 1.5 s",
     posture_lean_forever, 9000000},
};

/* Yaw, then pitch, then roll. */
static dquat quat_of_turns(turns t)
{
    dquat yaw = {0, sin(t.yaw / 2), 0, cos(t.yaw / 2)}, pitch = {sin(t.pitch / 2), 0, 0, cos(t.pitch / 2)};
    dquat roll = {0, 0, -sin(t.roll / 2), cos(t.roll / 2)};
    return dquat_mul(yaw, dquat_mul(pitch, roll));
}

/* A turn about a point other than the frame's origin. */
static rigid rigid_about(dvec3 pivot, turns t)
{
    dquat q = quat_of_turns(t);
    return (rigid){q, dvec3_sub(pivot, dquat_rotate(q, pivot))};
}

static motion_sample sample_of_posture(posture p, int64_t time_us)
{
    rigid stand = {dquat_identity(), dvec3_add(BUILTIN_REST_M, p.move_m)};
    rigid body = rigid_mul(stand, rigid_about(BUILTIN_HIPS_M, p.body));
    rigid head = rigid_mul(body, rigid_about(BUILTIN_NECK_TOP_M, p.head));
    return (motion_sample){.time_us = time_us, .head = motion_pose(head), .body = motion_pose(body)};
}

bool motion_builtin(const char *name, motion *out)
{
    for (size_t b = 0; name && b < sizeof BUILTINS / sizeof BUILTINS[0]; b++) {
        if (strcmp(BUILTINS[b].name, name) != 0) {
            continue;
        }
        motion_sample *samples = malloc(BUILTIN_SAMPLES * sizeof *samples);
        if (!samples) {
            return false;
        }
        for (int i = 0; i < BUILTIN_SAMPLES; i++) {
            posture p = BUILTINS[b].at((double)i / BUILTIN_RATE);
            samples[i] = sample_of_posture(p, (int64_t)i * 1000000 / BUILTIN_RATE);
        }
        *out = (motion){.sample_count = BUILTIN_SAMPLES, .samples = samples, .repeat_us = BUILTINS[b].repeat_us};
        snprintf(out->description, sizeof out->description, "%s", BUILTINS[b].description);
        return true;
    }
    return false;
}
