/* nearest.h: where two segments of space come nearest to each other. */
#ifndef BASE_NEAREST_H
#define BASE_NEAREST_H

#include "base/vec.h"

/* Below this sine squared of their angle two segments count as parallel. */
#define NEAREST_PARALLEL_SINE2 1e-6f

static inline float nearest_clamp(float share)
{
    return share < 0.0f ? 0.0f : share > 1.0f ? 1.0f : share;
}

/* Shares along the segments a + [0, 1] along_a and b + [0, 1] along_b of the points nearest to each other; of parallel
 * ones the middle of where they lie side by side. */
static inline void nearest_shares(vec3 a, vec3 along_a, vec3 b, vec3 along_b, float *on_a, float *on_b)
{
    vec3 between = vec3_sub(a, b);
    float aa = vec3_dot(along_a, along_a), bb = vec3_dot(along_b, along_b), ab = vec3_dot(along_a, along_b);
    float a_between = vec3_dot(along_a, between), b_between = vec3_dot(along_b, between);
    float area2 = aa * bb - ab * ab, s = 0.0f, t = 0.0f;
    if (area2 > NEAREST_PARALLEL_SINE2 * aa * bb) {
        s = nearest_clamp((ab * b_between - a_between * bb) / area2);
    } else if (aa > 0.0f) {
        float begin = -a_between / aa;
        s = 0.5f * (nearest_clamp(begin) + nearest_clamp(begin + ab / aa));
    }
    if (bb > 0.0f) {
        t = (ab * s + b_between) / bb;
    }
    if (t < 0.0f || t > 1.0f || bb <= 0.0f) {
        t = t > 1.0f ? 1.0f : 0.0f;
        s = aa > 0.0f ? nearest_clamp((ab * t - a_between) / aa) : 0.0f;
    }
    *on_a = s;
    *on_b = t;
}

static inline float nearest_distance(vec3 a, vec3 along_a, vec3 b, vec3 along_b)
{
    float s, t;
    nearest_shares(a, along_a, b, along_b, &s, &t);
    return vec3_distance(vec3_mad(a, along_a, s), vec3_mad(b, along_b, t));
}

#endif
