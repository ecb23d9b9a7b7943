/* engine_head.c: see engine_head.h. */
#include "engine_head.h"

#include <math.h>

#define TICK_US 16667 /* over which the velocity is taken */

proto_pose engine_true_head(int64_t time_us)
{
    const double t = 1e-6 * (double)time_us, nod = 0.3 * sin(2.1 * t);
    proto_pose pose = {.position = {0.15 * sin(1.7 * t), 0.03 * sin(3.1 * t), 0.05 * sin(1.1 * t)}};
    pose.orientation[0] = sin(nod / 2);
    pose.orientation[3] = cos(nod / 2);
    return pose;
}

proto_pose engine_predicted_head(int64_t time_us, int64_t at_us)
{
    const double share = (double)(at_us - time_us) / TICK_US;
    const proto_pose now = engine_true_head(time_us), before = engine_true_head(time_us - TICK_US);
    proto_pose out = now;
    double square = 0;
    for (int i = 0; i < 3; i++) {
        out.position[i] += share * (now.position[i] - before.position[i]);
    }
    for (int i = 0; i < 4; i++) {
        out.orientation[i] += share * (now.orientation[i] - before.orientation[i]);
        square += out.orientation[i] * out.orientation[i];
    }
    for (int i = 0; i < 4; i++) {
        out.orientation[i] /= sqrt(square);
    }
    return out;
}
