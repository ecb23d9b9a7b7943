/* between.c: see between.h. */
#include "between.h"

#include <math.h>
#include <string.h>

enum { QUATERNION = 4 };

static void mix_quaternion(const float *a, const float *b, float share, float *out)
{
    const float dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3], sign = dot < 0 ? -1.0f : 1.0f;
    float squares = 0;
    for (int k = 0; k < QUATERNION; k++) {
        out[k] = a[k] + share * (sign * b[k] - a[k]);
        squares += out[k] * out[k];
    }
    const float scale = 1.0f / sqrtf(squares); /* at most a quarter turn apart: never 0 */
    for (int k = 0; k < QUATERNION; k++) {
        out[k] *= scale;
    }
}

void between_mix(const float *from, const float *to, double share, uint32_t width, uint32_t count, float *out)
{
    const float s = (float)share;
    for (size_t i = 0; i < (size_t)count * width; i += width) {
        if (memcmp(from + i, to + i, width * sizeof *to) == 0) {
            memcpy(out + i, to + i, width * sizeof *to);
        } else if (width == QUATERNION) {
            mix_quaternion(from + i, to + i, s, out + i);
        } else {
            for (uint32_t k = 0; k < width; k++) {
                out[i + k] = from[i + k] + s * (to[i + k] - from[i + k]);
            }
        }
    }
}

awt_pose between_pose(const awt_pose *from, const awt_pose *to, double share)
{
    awt_pose out;
    double dot = 0, squares = 0;
    for (int k = 0; k < 3; k++) {
        out.position[k] = from->position[k] + share * (to->position[k] - from->position[k]);
    }
    for (int k = 0; k < QUATERNION; k++) {
        dot += from->orientation[k] * to->orientation[k];
    }
    for (int k = 0; k < QUATERNION; k++) {
        const double a = from->orientation[k], b = dot < 0 ? -to->orientation[k] : to->orientation[k];
        out.orientation[k] = a + share * (b - a);
        squares += out.orientation[k] * out.orientation[k];
    }
    for (int k = 0; k < QUATERNION; k++) {
        out.orientation[k] /= sqrt(squares);
    }
    return out;
}
