/* hanging.c: see hanging.h. */
#include "sim/hanging.h"

#include "base/lanes.h"
#include "sim/embed.h"

/* The turns of LANES neighbouring sections, and which of these are to move. */
typedef struct hanging_turn {
    uint32_t at; /* the first of the sections */
    lanes_mask moves;
    lanes3 x, y, z; /* columns */
    lanes q[4];
} hanging_turn;

bool hanging_is_even(const awt_forest *f, const tree *t)
{
    const uint32_t sections = f->groom->info.sections;
    return t->count == sections && sections >= LANES &&
           f->active_node[t->first] + sections - 1 == f->active_node[t->first + sections - 1];
}

static lanes lanes_absolute(lanes a)
{
    return (lanes)((lanes_mask)a & 0x7fffffff);
}

/* Sections at .. at + LANES - 1, of which those before `from` have been moved already. */
static hanging_turn turn_of(const quat *turn, uint32_t at, uint32_t from)
{
    hanging_turn h = {.at = at};
    const float *record[LANES];
    for (uint32_t k = 0; k < LANES; k++) {
        const mat3 m = mat3_of_quat(turn[at + k]);
        h.moves[k] = at + k >= from ? -1 : 0;
        h.x.x[k] = m.x.x, h.x.y[k] = m.x.y, h.x.z[k] = m.x.z;
        h.y.x[k] = m.y.x, h.y.y[k] = m.y.y, h.y.z[k] = m.y.z;
        h.z.x[k] = m.z.x, h.z.y[k] = m.z.y, h.z.z[k] = m.z.z;
        record[k] = &turn[at + k].x;
    }
    lanes_turn4(record, h.q);
    return h;
}

/* mat3_apply, lane by lane. */
static lanes3 turned(const hanging_turn *h, lanes3 v)
{
    lanes3 x = {h->x.x * v.x, h->x.y * v.x, h->x.z * v.x};
    return lanes3_mad(lanes3_mad(x, h->y, v.y), h->z, v.z);
}

/* Lanes whose offset is near. */
static lanes_mask offsets_relax(const hanging_turn *h, const vec3 *rest, const vec3 *rest_above, vec3 *offset,
                                lanes share)
{
    const lanes3 way_at_rest = lanes3_sub(lanes3_load(&rest->x), lanes3_load(&rest_above->x));
    const lanes3 now = lanes3_load(&offset->x), way = lanes3_sub(turned(h, way_at_rest), now);
    lanes3_store(&offset->x, lanes3_select(h->moves, lanes3_mad(now, way, share), now));
    return lanes3_dot(way, way) < EMBED_SETTLED_M * EMBED_SETTLED_M;
}

/* quat_near, quat_mul and quat_blend, lane by lane. */
static lanes_mask frames_relax(const hanging_turn *h, const quat *rest, quat *frame, lanes share)
{
    const float *from[LANES], *at_rest[LANES];
    float *to[LANES];
    lanes a[4], r[4];
    for (uint32_t k = 0; k < LANES; k++) {
        from[k] = to[k] = &frame[k].x;
        at_rest[k] = &rest[k].x;
    }
    lanes_turn4(from, a);
    lanes_turn4(at_rest, r);
    const lanes *t = h->q, zero = lanes_of(0.0f), one = lanes_of(1.0f), near = lanes_of(EMBED_SETTLED_TURN);
    const lanes b[4] = {
        t[3] * r[0] + t[0] * r[3] + t[1] * r[2] - t[2] * r[1], t[3] * r[1] - t[0] * r[2] + t[1] * r[3] + t[2] * r[0],
        t[3] * r[2] + t[0] * r[1] - t[1] * r[0] + t[2] * r[3], t[3] * r[3] - t[0] * r[0] - t[1] * r[1] - t[2] * r[2]};
    const lanes_mask other = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] < zero;
    const lanes sign = lanes_select(other, -one, one), by = lanes_select(other, -share, share), keep = one - share;
    lanes_mask is_near = h->moves | ~h->moves;
    lanes way[4];
    for (uint32_t c = 0; c < 4; c++) {
        is_near &= lanes_absolute(a[c] - sign * b[c]) < near;
        way[c] = a[c] * keep + b[c] * by;
    }
    const lanes length = lanes_sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2] + way[3] * way[3]);
    const lanes s = one / length;
    for (uint32_t c = 0; c < 4; c++) {
        lanes unit = lanes_select(length > 1e-12f, way[c] * s, c == 3 ? one : zero);
        a[c] = lanes_select(h->moves, unit, a[c]);
    }
    lanes_spread4(a, to);
    return is_near;
}

/* All that hangs on LANES sections of the tree. */
static bool sections_relax(awt_forest *f, uint32_t top, const hanging_turn *h, float share)
{
    const awt_groom *groom = f->groom;
    const uint32_t sections = groom->info.sections, finest = groom_finest_first(groom);
    const lanes by = lanes_of(share);
    lanes_mask near = h->moves | ~h->moves;
    uint32_t lo = top, hi = top + 1;
    while (groom_descend(groom, &lo, &hi)) {
        for (uint32_t s = lo; s < hi; s++) {
            const uint32_t n = s * sections + h->at, above = groom->gc_super[s] * sections + h->at;
            near &= offsets_relax(h, &groom->rest_position[n], &groom->rest_position[above], &f->offset[n], by);
        }
    }
    for (uint32_t s = lo; s < hi; s++) {
        const uint32_t n = (s - finest) * sections + h->at;
        near &= frames_relax(h, &groom->rest_frame[n], &f->frame[n], by);
    }
    return lanes_bits(~near & h->moves) == 0;
}

bool hanging_relax(awt_forest *f, const tree *t, const quat *turn, float share)
{
    const uint32_t sections = f->groom->info.sections, top = f->active_node[t->first] / sections;
    bool near = true;
    for (uint32_t from = 1; from < sections;) {
        const uint32_t at = from - 1 + LANES <= sections ? from - 1 : sections - LANES;
        const hanging_turn h = turn_of(turn, at, from);
        near = sections_relax(f, top, &h, share) && near;
        from = at + LANES;
    }
    return near;
}
