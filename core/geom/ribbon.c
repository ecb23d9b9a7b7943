/* ribbon.c: see ribbon.h. Only + - * / and sqrt, LANES strands side by side (lanes.h): the same points give the same
 * vertices everywhere, whatever strands are beside them. */
#include "geom/ribbon.h"

#include "awt.h"
#include "base/lanes.h"

/* LANES strands on their way; where there are fewer, the last one takes the places that are left. */
typedef struct band {
    const float *points[LANES]; /* [points_per_strand][3] of each */
    float *vertices[LANES];     /* [points_per_strand][2][3] of each */
    lanes_mask used;
} band;

static band take_band(const ribbon_shape *shape, const float *points, float *vertices, uint32_t strands)
{
    band b = {.used = {0}};
    for (uint32_t k = 0; k < LANES; k++) {
        const size_t strand = k < strands ? k : strands - 1;
        b.points[k] = points + strand * shape->points_per_strand * 3;
        b.vertices[k] = vertices + strand * shape->points_per_strand * 6;
        b.used[k] = k < strands ? -1 : 0;
    }
    return b;
}

static lanes clamp_to(lanes value, float least, float greatest)
{
    return lanes_most(lanes_least(value, lanes_of(greatest)), lanes_of(least));
}

/* Side by side, as they are. A strand has six floats or more: the last four are taken together, some of them again. */
static void turn_points(const band *b, uint32_t count, lanes3 *p)
{
    const uint32_t floats = 3 * count;
    lanes *out = (lanes *)(void *)p;
    for (uint32_t i = 0; i < floats; i += 4) {
        const uint32_t at = i + 4 <= floats ? i : floats - 4;
        const float *records[LANES];
        for (int k = 0; k < LANES; k++) {
            records[k] = b->points[k] + at;
        }
        lanes_turn4(records, out + at);
    }
}

/* Reads the strands into `p`, set onto the box. False: a point is not finite. */
static bool take_points(const ribbon_shape *shape, const band *b, lanes3 *p, uint32_t *clamped)
{
    const float *least = shape->point_min, *greatest = shape->point_max;
    lanes_mask finite = ~(lanes_mask){0}, outside = {0};
    turn_points(b, shape->points_per_strand, p);
    for (uint32_t i = 0; i < shape->points_per_strand; i++) {
        const lanes3 given = p[i];
        p[i] = (lanes3){clamp_to(given.x, least[0], greatest[0]), clamp_to(given.y, least[1], greatest[1]),
                        clamp_to(given.z, least[2], greatest[2])};
        finite &= (given.x - given.x == 0.0f) & (given.y - given.y == 0.0f) & (given.z - given.z == 0.0f);
        outside -= (p[i].x != given.x) | (p[i].y != given.y) | (p[i].z != given.z);
    }
    outside &= b->used;
    for (int k = 0; k < LANES; k++) {
        *clamped += (uint32_t)outside[k];
    }
    return lanes_bits(~finite) == 0;
}

/* Direction of the strands at point i: between its neighbours; `before` where they coincide. */
static lanes3 tangent_at(const lanes3 *p, uint32_t count, uint32_t i, lanes3 before)
{
    uint32_t previous = i > 0 ? i - 1 : 0;
    uint32_t next = i + 1 < count ? i + 1 : i;
    return lanes3_unit(lanes3_sub(p[next], p[previous]), before);
}

/* Width direction at the root: along the scalp and across the way the hair falls. The way is taken from the first half
 * of the strand rather than its first segment, which may stand straight out of the head; a small fixed part along the
 * scalp keeps the direction steady in time where even that half does. */
static lanes3 width_at_root(const lanes3 *p, uint32_t count, lanes3 out, lanes3 tangent)
{
    lanes3 way = lanes3_unit(lanes3_sub(p[(count + 1) / 2], p[0]), tangent);
    lanes3 across = lanes3_mad(lanes3_cross(out, way), lanes3_orthogonal(out), lanes_of(0.02f));
    lanes3 square = lanes3_mad(across, tangent, -lanes3_dot(across, tangent));
    return lanes3_unit(square, lanes3_orthogonal(tangent));
}

/* Carries a width direction from one tangent a to the next, b, by the smallest turn, and squares what rounding left.
 * The turn takes v to v - (a + b) (b v) / (1 + a b) where v is square to a; where a and b oppose it is half a turn
 * about some axis u, and takes v to 2 u (u v) - v. */
static lanes3 carry_width(lanes3 width, lanes3 from, lanes3 to)
{
    lanes one_and_cosine = lanes3_dot(from, to) + 1.0f;
    lanes3 sum = {from.x + to.x, from.y + to.y, from.z + to.z};
    lanes3 turned = lanes3_mad(width, sum, -lanes3_dot(to, width) / one_and_cosine);
    lanes_mask opposed = one_and_cosine < 1e-6f;
    if (lanes_bits(opposed) != 0) {
        lanes3 axis = lanes3_orthogonal(from), back = {-width.x, -width.y, -width.z};
        turned = lanes3_select(opposed, lanes3_mad(back, axis, lanes3_dot(axis, width) * 2.0f), turned);
    }
    lanes3 square = lanes3_mad(turned, to, -lanes3_dot(turned, to));
    lanes length = lanes_sqrt(lanes3_dot(square, square)), s = lanes_of(1.0f) / length;
    lanes3 carried = {square.x * s, square.y * s, square.z * s};
    lanes_mask lost = ~(length > 1e-12f);
    return lanes_bits(lost) == 0 ? carried : lanes3_select(lost, lanes3_orthogonal(to), carried);
}

/* The edges of a point: [2][3]. */
static void put_edges(lanes3 p, lanes3 width, float half_width, lanes edges[6])
{
    lanes3 left = lanes3_mad(p, width, lanes_of(-half_width)), right = lanes3_mad(p, width, lanes_of(half_width));
    edges[0] = left.x;
    edges[1] = left.y;
    edges[2] = left.z;
    edges[3] = right.x;
    edges[4] = right.y;
    edges[5] = right.z;
}

/* Four floats of each strand's vertices, from number `at` on. */
static void store_four(const band *b, const lanes edges[4], uint32_t at)
{
    float *records[LANES];
    for (int k = 0; k < LANES; k++) {
        records[k] = b->vertices[k] + at;
    }
    lanes_spread4(edges, records);
}

static void write_strands(const ribbon_shape *shape, const band *b, const lanes3 *p)
{
    const uint32_t count = shape->points_per_strand;
    const lanes3 up = {lanes_of(0), lanes_of(1), lanes_of(0)}, out = lanes3_unit(p[0], up);
    lanes3 tangent = tangent_at(p, count, 0, out);
    lanes3 width = width_at_root(p, count, out, tangent);
    lanes edges[12]; /* of two points, which are three times four floats */
    for (uint32_t i = 0; i < count; i++) {
        lanes3 next = tangent_at(p, count, i, tangent);
        width = carry_width(width, tangent, next);
        tangent = next;
        put_edges(p[i], width, shape->half_width[i], edges + 6 * (i % 2));
        for (uint32_t k = 0; k < 12 && i % 2 == 1; k += 4) {
            store_four(b, edges + k, 6 * (i - 1) + k);
        }
    }
    if (count % 2 == 1) {
        store_four(b, edges, 6 * (count - 1));
        store_four(b, edges + 2, 6 * (count - 1) + 2);
    }
}

bool ribbon_vertices(const ribbon_shape *shape, const float *points, uint32_t strands, float *vertices,
                     uint32_t *clamped)
{
    lanes3 p[AWT_MAX_POINTS_PER_STRAND];
    const size_t count = shape->points_per_strand;
    for (uint32_t s = 0; s < strands; s += LANES) {
        const uint32_t here = strands - s < LANES ? strands - s : LANES;
        const band b = take_band(shape, points + s * count * 3, vertices + s * count * 6, here);
        if (!take_points(shape, &b, p, clamped)) {
            return false;
        }
        write_strands(shape, &b, p);
    }
    return true;
}
