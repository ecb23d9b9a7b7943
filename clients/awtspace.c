/* awtspace.c: see awtspace.h. Each frame is a signed permutation of our axes and a unit; all else follows from them. */
#include "awtspace.h"

typedef struct space_axes {
    int from[3];    /* our axis that becomes this one */
    double sign[3]; /* and its direction */
    double hand;    /* -1: the hand changes */
    double units;   /* in a metre */
} space_axes;

static const space_axes *axes_of(awtspace space)
{
    static const space_axes all[] = {
        [AWTSPACE_OURS] = {{0, 1, 2}, {1, 1, 1}, 1, 1},
        [AWTSPACE_UNREAL] = {{2, 0, 1}, {1, -1, 1}, -1, 100},
        [AWTSPACE_UNITY] = {{0, 1, 2}, {-1, 1, 1}, -1, 1},
        [AWTSPACE_GODOT] = {{0, 1, 2}, {1, 1, 1}, 1, 1},
    };
    return &all[space];
}

static void turn_to(const space_axes *axes, const double from[3], double to[3])
{
    const double old[3] = {from[0], from[1], from[2]};
    for (int i = 0; i < 3; i++) {
        to[i] = axes->sign[i] * old[axes->from[i]];
    }
}

static void turn_from(const space_axes *axes, const double from[3], double to[3])
{
    const double old[3] = {from[0], from[1], from[2]};
    for (int i = 0; i < 3; i++) {
        to[axes->from[i]] = axes->sign[i] * old[i];
    }
}

void awtspace_points_to(awtspace space, const float *from, float *to, size_t count)
{
    const space_axes *axes = axes_of(space);
    for (size_t p = 0; p < count; p++) {
        const float old[3] = {from[3 * p], from[3 * p + 1], from[3 * p + 2]};
        for (int i = 0; i < 3; i++) {
            to[3 * p + (size_t)i] = (float)(axes->sign[i] * axes->units) * old[axes->from[i]];
        }
    }
}

void awtspace_points_from(awtspace space, const float *from, float *to, size_t count)
{
    const space_axes *axes = axes_of(space);
    for (size_t p = 0; p < count; p++) {
        const float old[3] = {from[3 * p], from[3 * p + 1], from[3 * p + 2]};
        for (int i = 0; i < 3; i++) {
            to[3 * p + (size_t)axes->from[i]] = (float)axes->sign[i] * old[i] / (float)axes->units;
        }
    }
}

void awtspace_pose_to(awtspace space, double position[3], double orientation[4])
{
    const space_axes *axes = axes_of(space);
    turn_to(axes, position, position);
    turn_to(axes, orientation, orientation);
    for (int i = 0; i < 3; i++) {
        position[i] *= axes->units;
        orientation[i] *= axes->hand;
    }
}

void awtspace_pose_from(awtspace space, double position[3], double orientation[4])
{
    const space_axes *axes = axes_of(space);
    turn_from(axes, position, position);
    turn_from(axes, orientation, orientation);
    for (int i = 0; i < 3; i++) {
        position[i] /= axes->units;
        orientation[i] *= axes->hand;
    }
}

float awtspace_units(awtspace space)
{
    return (float)axes_of(space)->units;
}
