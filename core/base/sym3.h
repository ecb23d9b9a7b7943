/* sym3.h: symmetric 3 x 3 matrices: the masses that links and springs make of sub-trees. */
#ifndef BASE_SYM3_H
#define BASE_SYM3_H

#include "base/vec.h"

typedef struct sym3 {
    float xx, yy, zz, xy, xz, yz;
} sym3;

static inline sym3 sym3_of_scalar(float s)
{
    return (sym3){s, s, s, 0, 0, 0};
}

static inline sym3 sym3_sum(sym3 a, sym3 b)
{
    return (sym3){a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.xz + b.xz, a.yz + b.yz};
}

/* a + s v v^T */
static inline sym3 sym3_add_outer(sym3 a, vec3 v, float s)
{
    vec3 w = vec3_scale(v, s);
    return (sym3){a.xx + w.x * v.x, a.yy + w.y * v.y, a.zz + w.z * v.z,
                  a.xy + w.x * v.y, a.xz + w.x * v.z, a.yz + w.y * v.z};
}

/* a + s A^T B, whose product is symmetric. */
static inline sym3 sym3_add_product(sym3 a, mat3 A, mat3 B, float s)
{
    return (sym3){a.xx + s * vec3_dot(A.x, B.x), a.yy + s * vec3_dot(A.y, B.y), a.zz + s * vec3_dot(A.z, B.z),
                  a.xy + s * vec3_dot(A.x, B.y), a.xz + s * vec3_dot(A.x, B.z), a.yz + s * vec3_dot(A.y, B.z)};
}

static inline sym3 sym3_inverse(sym3 a)
{
    float cxx = a.yy * a.zz - a.yz * a.yz, cxy = a.xz * a.yz - a.xy * a.zz, cxz = a.xy * a.yz - a.xz * a.yy;
    float s = 1.0f / (a.xx * cxx + a.xy * cxy + a.xz * cxz);
    return (sym3){cxx * s, (a.xx * a.zz - a.xz * a.xz) * s, (a.xx * a.yy - a.xy * a.xy) * s, cxy * s,
                  cxz * s, (a.xy * a.xz - a.xx * a.yz) * s};
}

static inline vec3 sym3_apply(sym3 a, vec3 v)
{
    return (vec3){a.xx * v.x + a.xy * v.y + a.xz * v.z, a.xy * v.x + a.yy * v.y + a.yz * v.z,
                  a.xz * v.x + a.yz * v.y + a.zz * v.z};
}

static inline mat3 sym3_mul(sym3 a, mat3 b)
{
    return (mat3){sym3_apply(a, b.x), sym3_apply(a, b.y), sym3_apply(a, b.z)};
}

#endif
