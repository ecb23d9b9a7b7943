/* touch.c: see touch.h. LANES pairs at once, and no branch on what chance decides: first the nearest points of all
 * pairs and which of them meet; of those that do, the velocities and which are in relative motion; what is left goes on
 * one by one.
 *
 * Segments are cylinders, without caps: where the nearest points are ends of both and each lies beyond the other's end,
 * the two are not in contact there. Hair's radii can be greater than its segments are long, and with caps a segment
 * would touch every second one of its own wisp and a handful of each neighbour's. */
#include "sim/touch.h"

#include "base/lanes.h"
#include "base/nearest.h"

#define TOUCH_ANGLE_RAMP 0.1f

/* One side of LANES pairs. */
typedef struct lane_segments {
    lanes3 from, along;
    lanes radius;
} lane_segments;

static inline lane_segments gather(const segment *segments, const uint32_t index[LANES])
{
    const float *record[LANES];
    lanes part[8];
    for (int k = 0; k < LANES; k++) {
        record[k] = &segments[index[k]].from.x;
    }
    lanes_turn8(record, part);
    return (lane_segments){{part[0], part[1], part[2]}, {part[4], part[5], part[6]}, part[3]};
}

static lanes lanes_clamp(lanes share)
{
    return lanes_least(lanes_most(share, lanes_of(0.0f)), lanes_of(1.0f));
}

/* nearest_shares of base/nearest.h. */
static void lanes_nearest(const lane_segments *a, const lane_segments *b, lanes *on_a, lanes *on_b)
{
    const lanes zero = lanes_of(0.0f), one = lanes_of(1.0f);
    lanes3 between = lanes3_sub(a->from, b->from);
    lanes aa = lanes3_dot(a->along, a->along), bb = lanes3_dot(b->along, b->along), ab = lanes3_dot(a->along, b->along);
    lanes a_between = lanes3_dot(a->along, between), b_between = lanes3_dot(b->along, between);
    lanes area2 = aa * bb - ab * ab;
    lanes_mask crossing = area2 > aa * bb * NEAREST_PARALLEL_SINE2, a_long = aa > zero, b_long = bb > zero;
    lanes a_square = lanes_select(a_long, aa, one), b_square = lanes_select(b_long, bb, one);
    lanes begin = -a_between / a_square;
    lanes s = lanes_clamp((ab * b_between - a_between * bb) / lanes_select(crossing, area2, one));
    lanes beside = (lanes_clamp(begin) + lanes_clamp(begin + ab / a_square)) * 0.5f;
    s = lanes_select(crossing, s, lanes_select(a_long, beside, zero));
    lanes t = lanes_select(b_long, (ab * s + b_between) / b_square, zero);
    lanes end = lanes_select(t > one, one, zero);
    lanes_mask off = (t < zero) | (t > one) | ~b_long;
    *on_a = lanes_select(off, lanes_select(a_long, lanes_clamp((ab * end - a_between) / a_square), zero), s);
    *on_b = lanes_select(off, end, t);
}

/* Does the other axis' nearest point lie beyond the end, at `share`, of this one? `back` is the way here from there
 * along it, times its length. */
static lanes_mask lanes_beyond(lanes3 along, lanes share, lanes back)
{
    lanes margin = lanes3_dot(along, along) * 1e-4f;
    return ((share >= lanes_of(1.0f)) & (back > margin)) | ((share <= lanes_of(0.0f)) & (back < -margin));
}

/* All pairs of one call, and what is found out about them. */
typedef struct touch_work {
    float on_a[GRID_PAIRS + LANES], on_b[GRID_PAIRS + LANES]; /* shares from the parents of the nearest points */
    uint8_t crossing[GRID_PAIRS / 4 + 1];                     /* of each LANES pairs, bit k: at more than the angle */
    uint16_t met[GRID_PAIRS + LANES];                         /* pairs whose cylinders meet */
    float velocity[3][GRID_PAIRS + LANES];                    /* of those; of the second's point against the first's */
    uint16_t rubbing[GRID_PAIRS + LANES];                     /* places in `met`: strangers in relative motion */
} touch_work;

/* Pairs first .. first + LANES - 1 of `count`; bit k: pair first + k meets. */
static inline uint32_t touch_meet(const awt_forest *f, const grid_pair *pairs, uint32_t first, uint32_t count,
                                  float cosine2, touch_work *w)
{
    uint32_t index_a[LANES], index_b[LANES];
    for (uint32_t k = 0; k < LANES; k++) { /* past the end, the last pair again */
        uint32_t at = first + k < count ? first + k : count - 1;
        index_a[k] = pairs[at].a;
        index_b[k] = pairs[at].b;
    }
    lane_segments a = gather(f->segments, index_a), b = gather(f->segments, index_b);
    lanes s, t, r = a.radius + b.radius;
    lanes_nearest(&a, &b, &s, &t);
    lanes3 apart = lanes3_sub(lanes3_mad(a.from, a.along, s), lanes3_mad(b.from, b.along, t));
    lanes_mask apart_at_ends =
        lanes_beyond(a.along, s, -lanes3_dot(apart, a.along)) & lanes_beyond(b.along, t, lanes3_dot(apart, b.along));
    lanes ab = lanes3_dot(a.along, b.along);
    lanes limit = lanes3_dot(a.along, a.along) * lanes3_dot(b.along, b.along) * cosine2;
    lanes_store(w->on_a + first, s);
    lanes_store(w->on_b + first, t);
    w->crossing[first / LANES] = (uint8_t)lanes_bits(ab * ab < limit);
    uint32_t bits = lanes_bits((lanes3_dot(apart, apart) < r * r) & ~apart_at_ends);
    return count - first < LANES ? bits & ((1u << (count - first)) - 1) : bits;
}

/* Velocities of LANES nodes. */
static inline lanes3 gather_velocity(const awt_forest *f, const uint32_t slot[LANES])
{
    const float *record[LANES];
    lanes part[4];
    for (int k = 0; k < LANES; k++) {
        record[k] = &f->contact_nodes[slot[k]].velocity.x;
    }
    lanes_turn4(record, part);
    return (lanes3){part[0], part[1], part[2]};
}

/* Places first .. first + LANES - 1 of the `count` in w->met; bit k: those two share no node and move against each
 * other. */
static inline uint32_t touch_rub(const awt_forest *f, const grid_pair *pairs, uint32_t first, uint32_t count,
                                 float least_speed2, touch_work *w)
{
    uint32_t child_a[LANES], parent_a[LANES], child_b[LANES], parent_b[LANES], strangers = 0;
    float on_a[LANES], on_b[LANES];
    for (uint32_t k = 0; k < LANES; k++) {
        uint32_t n = w->met[first + k < count ? first + k : count - 1];
        segment_ends a = f->ends[pairs[n].a], b = f->ends[pairs[n].b];
        child_a[k] = a.child, parent_a[k] = a.parent, child_b[k] = b.child, parent_b[k] = b.parent;
        on_a[k] = w->on_a[n], on_b[k] = w->on_b[n];
        strangers |= (uint32_t)((a.child != b.parent) & (a.parent != b.child) & (a.parent != b.parent)) << k;
    }
    lanes3 from = gather_velocity(f, parent_a), to = gather_velocity(f, child_a);
    lanes3 at_a = lanes3_mad(from, lanes3_sub(to, from), lanes_load(on_a));
    from = gather_velocity(f, parent_b), to = gather_velocity(f, child_b);
    lanes3 velocity = lanes3_sub(lanes3_mad(from, lanes3_sub(to, from), lanes_load(on_b)), at_a);
    lanes_store(w->velocity[0] + first, velocity.x);
    lanes_store(w->velocity[1] + first, velocity.y);
    lanes_store(w->velocity[2] + first, velocity.z);
    uint32_t bits = strangers & lanes_bits(lanes3_dot(velocity, velocity) >= lanes_of(least_speed2));
    return count - first < LANES ? bits & ((1u << (count - first)) - 1) : bits;
}

/* How far apart the axes of two segments are at rest. */
static float rest_distance(const awt_forest *f, segment_ends a, segment_ends b)
{
    const vec3 *rest = f->groom->rest_position;
    vec3 from_a = rest[f->active_node[a.parent]], from_b = rest[f->active_node[b.parent]];
    return nearest_distance(from_a, vec3_sub(rest[f->active_node[a.child]], from_a), from_b,
                            vec3_sub(rest[f->active_node[b.child]], from_b));
}

/* Eq. (2)'s (r - d) (P1 - P2) / |P1 - P2| of segments that cross. Hair rests overlapping: two wisps are pushed no
 * farther apart than they rest, or their style and this would fight for ever. */
static vec3 overlap_of(const awt_forest *f, const segment *a, const segment *b, const wisp_contact *c)
{
    const vec3 none = {0, 0, 0};
    vec3 apart = vec3_sub(vec3_mad(a->from, a->along, c->on[0]), vec3_mad(b->from, b->along, c->on[1]));
    float d = vec3_length(apart), wanted = rest_distance(f, c->of[0], c->of[1]);
    wanted = wanted < a->radius + b->radius ? wanted : a->radius + b->radius;
    if (!(d < wanted)) {
        return none;
    }
    /* Axes that meet part sideways of both. */
    vec3 away = vec3_unit(apart, vec3_unit(vec3_cross(a->along, b->along), none));
    return vec3_scale(away, wanted - d);
}

/* What decides sets in gradually, forces with the relative motion that makes it a contact and repulsion with the angle,
 * over TOUCH_ANGLE_RAMP of its cosine squared: if it came all at once, two wisps that their style holds in each other
 * would kick each other for ever, and rounding would decide over millimetres. */
static void contact_fill(const awt_forest *f, const grid_pair *pairs, uint32_t place, const touch_rule *rule,
                         const touch_work *w, wisp_contact *out)
{
    uint32_t n = w->met[place];
    const segment *a = &f->segments[pairs[n].a], *b = &f->segments[pairs[n].b];
    vec3 velocity = {w->velocity[0][place], w->velocity[1][place], w->velocity[2][place]};
    float onset = 1.0f - rule->least_speed2 / vec3_dot(velocity, velocity);
    out->of[0] = f->ends[pairs[n].a];
    out->of[1] = f->ends[pairs[n].b];
    out->on[0] = w->on_a[n];
    out->on[1] = w->on_b[n];
    out->mass = a->mass < b->mass ? a->mass : b->mass;
    out->velocity = vec3_scale(velocity, onset);
    out->overlap = (vec3){0, 0, 0};
    if (w->crossing[n / LANES] >> n % LANES & 1) {
        float ab = vec3_dot(a->along, b->along);
        float ramp = rule->cosine2 - ab * ab / (vec3_dot(a->along, a->along) * vec3_dot(b->along, b->along));
        onset *= ramp < TOUCH_ANGLE_RAMP ? ramp / TOUCH_ANGLE_RAMP : 1.0f;
        out->overlap = vec3_scale(overlap_of(f, a, b, out), onset);
    }
}

uint32_t touch_find(const awt_forest *f, const touch_rule *rule, const grid_pair *pairs, uint32_t count,
                    wisp_contact *out)
{
    touch_work w;
    uint32_t met = 0, rubbing = 0;
    for (uint32_t n = 0; n < count; n += LANES) {
        met += lanes_list(touch_meet(f, pairs, n, count, rule->cosine2, &w), n, w.met + met);
    }
    for (uint32_t n = 0; n < met; n += LANES) {
        rubbing += lanes_list(touch_rub(f, pairs, n, met, rule->least_speed2, &w), n, w.rubbing + rubbing);
    }
    for (uint32_t n = 0; n < rubbing; n++) {
        contact_fill(f, pairs, w.rubbing[n], rule, &w, &out[n]);
    }
    return rubbing;
}
