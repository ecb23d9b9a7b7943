/* ribbon.c: see ribbon.h. Only + - * / and sqrt: the same points give the same vertices everywhere. */
#include "geom/ribbon.h"

#include "awt.h"
#include "base/vec.h"

static float clamp_to(float value, float least, float greatest)
{
    return value < least ? least : value > greatest ? greatest : value;
}

/* Reads one strand into `p`, set onto the box. False: a point is not finite. */
static bool take_points(const ribbon_shape *shape, const float *points, vec3 *p, uint32_t *clamped)
{
    for (uint32_t i = 0; i < shape->points_per_strand; i++) {
        vec3 given = vec3_make(points[3 * i], points[3 * i + 1], points[3 * i + 2]);
        if (!vec3_finite(given)) {
            return false;
        }
        p[i] = vec3_make(clamp_to(given.x, shape->point_min[0], shape->point_max[0]),
                         clamp_to(given.y, shape->point_min[1], shape->point_max[1]),
                         clamp_to(given.z, shape->point_min[2], shape->point_max[2]));
        *clamped += p[i].x != given.x || p[i].y != given.y || p[i].z != given.z;
    }
    return true;
}

/* Direction of the strand at point i: between its neighbours; `before` where they coincide. */
static vec3 tangent_at(const vec3 *p, uint32_t count, uint32_t i, vec3 before)
{
    uint32_t previous = i > 0 ? i - 1 : 0;
    uint32_t next = i + 1 < count ? i + 1 : i;
    return vec3_unit(vec3_sub(p[next], p[previous]), before);
}

/* Width direction at the root: along the scalp and across the way the hair falls. The way is taken from the first half
 * of the strand rather than its first segment, which may stand straight out of the head; a small fixed part along the
 * scalp keeps the direction steady in time where even that half does. */
static vec3 width_at_root(const vec3 *p, uint32_t count, vec3 tangent)
{
    vec3 out = vec3_unit(p[0], vec3_make(0, 1, 0));
    vec3 way = vec3_unit(vec3_sub(p[(count + 1) / 2], p[0]), tangent);
    vec3 across = vec3_mad(vec3_cross(out, way), vec3_orthogonal(out), 0.02f);
    vec3 square = vec3_mad(across, tangent, -vec3_dot(across, tangent));
    return vec3_unit(square, vec3_orthogonal(tangent));
}

/* Carries a width direction from one tangent to the next by the smallest turn, and squares what rounding left. */
static vec3 carry_width(vec3 width, vec3 from, vec3 to)
{
    vec3 turned = quat_rotate(quat_between(from, to), width);
    return vec3_unit(vec3_mad(turned, to, -vec3_dot(turned, to)), vec3_orthogonal(to));
}

static void write_strand(const ribbon_shape *shape, const vec3 *p, vec3 *vertices)
{
    const uint32_t count = shape->points_per_strand;
    vec3 tangent = tangent_at(p, count, 0, vec3_unit(p[0], vec3_make(0, 1, 0)));
    vec3 width = width_at_root(p, count, tangent);
    for (uint32_t i = 0; i < count; i++) {
        vec3 next = tangent_at(p, count, i, tangent);
        width = carry_width(width, tangent, next);
        tangent = next;
        vertices[2 * i] = vec3_mad(p[i], width, -shape->half_width[i]);
        vertices[2 * i + 1] = vec3_mad(p[i], width, shape->half_width[i]);
    }
}

bool ribbon_vertices(const ribbon_shape *shape, const float *points, uint32_t strands, float *vertices,
                     uint32_t *clamped)
{
    vec3 p[AWT_MAX_POINTS_PER_STRAND];
    vec3 *out = (vec3 *)(void *)vertices;
    const uint32_t count = shape->points_per_strand;
    for (uint32_t s = 0; s < strands; s++) {
        if (!take_points(shape, points + (size_t)s * count * 3, p, clamped)) {
            return false;
        }
        write_strand(shape, p, out + (size_t)s * count * 2);
    }
    return true;
}
