/* vec.h: vectors and quaternions, in float for hair and in double for poses.
 *
 * Only + - * / and sqrt, which IEEE 754 rounds alike everywhere: with -ffp-contract=off the same inputs give
 * the same bits on every compiler. Quaternions are x y z w and turn vectors by q v q*. */
#ifndef BASE_VEC_H
#define BASE_VEC_H

#include <math.h>
#include <stdbool.h>

typedef struct vec3 {
    float x, y, z;
} vec3;

typedef struct quat {
    float x, y, z, w;
} quat;

typedef struct mat3 {
    vec3 x, y, z; /* columns: the images of the axes */
} mat3;

typedef struct dvec3 {
    double x, y, z;
} dvec3;

typedef struct dquat {
    double x, y, z, w;
} dquat;

static inline vec3 vec3_make(float x, float y, float z)
{
    return (vec3){x, y, z};
}

static inline vec3 vec3_add(vec3 a, vec3 b)
{
    return (vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline vec3 vec3_sub(vec3 a, vec3 b)
{
    return (vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline vec3 vec3_scale(vec3 a, float s)
{
    return (vec3){a.x * s, a.y * s, a.z * s};
}

/* a + b s */
static inline vec3 vec3_mad(vec3 a, vec3 b, float s)
{
    return (vec3){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}

static inline vec3 vec3_lerp(vec3 a, vec3 b, float t)
{
    return vec3_mad(a, vec3_sub(b, a), t);
}

static inline float vec3_dot(vec3 a, vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline vec3 vec3_cross(vec3 a, vec3 b)
{
    return (vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline float vec3_length(vec3 a)
{
    return sqrtf(vec3_dot(a, a));
}

static inline float vec3_distance(vec3 a, vec3 b)
{
    return vec3_length(vec3_sub(a, b));
}

/* a / |a|, or `otherwise` where a is too short to have a direction. */
static inline vec3 vec3_unit(vec3 a, vec3 otherwise)
{
    float length = vec3_length(a);
    return length > 1e-12f ? vec3_scale(a, 1.0f / length) : otherwise;
}

/* Some unit vector at right angles to the unit vector a. */
static inline vec3 vec3_orthogonal(vec3 a)
{
    vec3 other = fabsf(a.x) < 0.6f ? vec3_make(1, 0, 0) : vec3_make(0, 1, 0);
    return vec3_unit(vec3_cross(a, other), vec3_make(0, 0, 1));
}

static inline bool vec3_finite(vec3 a)
{
    return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}

static inline quat quat_identity(void)
{
    return (quat){0, 0, 0, 1};
}

static inline quat quat_conjugate(quat q)
{
    return (quat){-q.x, -q.y, -q.z, q.w};
}

/* First b, then a. */
static inline quat quat_mul(quat a, quat b)
{
    return (quat){a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
                  a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

static inline quat quat_unit(quat q)
{
    float length = sqrtf(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    if (!(length > 1e-12f)) {
        return quat_identity();
    }
    float s = 1.0f / length;
    return (quat){q.x * s, q.y * s, q.z * s, q.w * s};
}

static inline vec3 quat_rotate(quat q, vec3 v)
{
    vec3 u = {q.x, q.y, q.z};
    vec3 t = vec3_scale(vec3_cross(u, v), 2.0f);
    return vec3_add(vec3_mad(v, t, q.w), vec3_cross(u, t));
}

/* The shortest turn that takes unit vector a to unit vector b; half a turn about some axis where they oppose. */
static inline quat quat_between(vec3 a, vec3 b)
{
    float w = 1.0f + vec3_dot(a, b);
    if (w < 1e-6f) {
        vec3 axis = vec3_orthogonal(a);
        return (quat){axis.x, axis.y, axis.z, 0};
    }
    vec3 axis = vec3_cross(a, b);
    return quat_unit((quat){axis.x, axis.y, axis.z, w});
}

/* Normalised linear blend, along the shorter way. */
static inline quat quat_blend(quat a, quat b, float t)
{
    float s = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w < 0 ? -t : t;
    float r = 1.0f - t;
    return quat_unit((quat){a.x * r + b.x * s, a.y * r + b.y * s, a.z * r + b.z * s, a.w * r + b.w * s});
}

static inline mat3 mat3_of_quat(quat q)
{
    float xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
    float xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z;
    float wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
    return (mat3){{1 - 2 * (yy + zz), 2 * (xy + wz), 2 * (xz - wy)},
                  {2 * (xy - wz), 1 - 2 * (xx + zz), 2 * (yz + wx)},
                  {2 * (xz + wy), 2 * (yz - wx), 1 - 2 * (xx + yy)}};
}

static inline vec3 mat3_apply(mat3 m, vec3 v)
{
    return vec3_mad(vec3_mad(vec3_scale(m.x, v.x), m.y, v.y), m.z, v.z);
}

/* The transpose, which for a rotation is the way back. */
static inline vec3 mat3_apply_transposed(mat3 m, vec3 v)
{
    return (vec3){vec3_dot(m.x, v), vec3_dot(m.y, v), vec3_dot(m.z, v)};
}

static inline dvec3 dvec3_add(dvec3 a, dvec3 b)
{
    return (dvec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline dvec3 dvec3_sub(dvec3 a, dvec3 b)
{
    return (dvec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline dvec3 dvec3_scale(dvec3 a, double s)
{
    return (dvec3){a.x * s, a.y * s, a.z * s};
}

/* a + b s */
static inline dvec3 dvec3_mad(dvec3 a, dvec3 b, double s)
{
    return (dvec3){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}

static inline double dvec3_dot(dvec3 a, dvec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline dvec3 dvec3_cross(dvec3 a, dvec3 b)
{
    return (dvec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline double dvec3_length(dvec3 a)
{
    return sqrt(dvec3_dot(a, a));
}

/* a / |a|, or `otherwise` where a is too short to have a direction. */
static inline dvec3 dvec3_unit(dvec3 a, dvec3 otherwise)
{
    double length = dvec3_length(a);
    return length > 1e-12 ? dvec3_scale(a, 1.0 / length) : otherwise;
}

static inline dquat dquat_identity(void)
{
    return (dquat){0, 0, 0, 1};
}

static inline dquat dquat_conjugate(dquat q)
{
    return (dquat){-q.x, -q.y, -q.z, q.w};
}

static inline double dquat_dot(dquat a, dquat b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}

/* First b, then a. */
static inline dquat dquat_mul(dquat a, dquat b)
{
    return (dquat){a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
                   a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

static inline dquat dquat_unit(dquat q)
{
    double length = sqrt(dquat_dot(q, q));
    if (!(length > 1e-12)) {
        return dquat_identity();
    }
    double s = 1.0 / length;
    return (dquat){q.x * s, q.y * s, q.z * s, q.w * s};
}

static inline dvec3 dquat_rotate(dquat q, dvec3 v)
{
    dvec3 u = {q.x, q.y, q.z};
    dvec3 t = dvec3_scale(dvec3_cross(u, v), 2.0);
    return dvec3_add(dvec3_add(v, dvec3_scale(t, q.w)), dvec3_cross(u, t));
}

static inline vec3 vec3_of_dvec3(dvec3 a)
{
    return (vec3){(float)a.x, (float)a.y, (float)a.z};
}

static inline dvec3 dvec3_of_vec3(vec3 a)
{
    return (dvec3){a.x, a.y, a.z};
}

static inline quat quat_of_dquat(dquat q)
{
    return (quat){(float)q.x, (float)q.y, (float)q.z, (float)q.w};
}

#endif
