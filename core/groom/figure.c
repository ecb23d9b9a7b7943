/* figure.c: see figure.h. */
#include "groom/figure.h"

#define FEEL_M 0.03       /* distance at which hair begins to turn along what it nears */
#define CLEAR_MORE_M 1e-6 /* beyond the clearance, so that rounding does not call for another round */

enum { CLEAR_ROUNDS = 8 };

static figure_part part_make(dvec3 a, dvec3 b, double radius_a_m, double radius_b_m)
{
    figure_part part = {.a = a, .axis = dvec3_sub(b, a), .radius_a_m = radius_a_m, .radius_b_m = radius_b_m};
    part.axis_square = dvec3_dot(part.axis, part.axis);
    part.widest_m = radius_a_m > radius_b_m ? radius_a_m : radius_b_m;
    return part;
}

void figure_init(figure *f)
{
    awt_collider colliders[AWT_MAX_COLLIDERS];
    f->part_count = awt_colliders_default(AWT_HEAD_RADIUS_M, colliders);
    for (uint32_t i = 0; i < f->part_count; i++) {
        const awt_collider *c = &colliders[i];
        f->part[i] =
            part_make((dvec3){c->a[0], c->a[1], c->a[2]}, (dvec3){c->b[0], c->b[1], c->b[2]}, c->radius_a, c->radius_b);
    }
}

/* Is `point` less than `reach_m` from the part? Then also how far above its surface it is (negative: inside) and the
 * way out. */
static bool feels(const figure_part *part, dvec3 point, double reach_m, double *above_m, dvec3 *out)
{
    dvec3 from = dvec3_sub(point, part->a);
    double along = part->axis_square > 0.0 ? dvec3_dot(from, part->axis) / part->axis_square : 0.0;
    along = along < 0.0 ? 0.0 : along > 1.0 ? 1.0 : along;
    dvec3 away = dvec3_mad(from, part->axis, -along);
    double square = dvec3_dot(away, away), farthest = part->widest_m + reach_m;
    if (square >= farthest * farthest) {
        return false;
    }
    *above_m = sqrt(square) - (part->radius_a_m + (part->radius_b_m - part->radius_a_m) * along);
    *out = dvec3_unit(away, (dvec3){0, 1, 0});
    return *above_m < reach_m;
}

/* Where parts meet, the way out of one leads into the other: a few rounds find the way out of both. */
dvec3 figure_clear(const figure *f, dvec3 point, double clearance_m)
{
    bool moved = true;
    for (int round = 0; round < CLEAR_ROUNDS && moved; round++) {
        moved = false;
        for (uint32_t i = 0; i < f->part_count; i++) {
            dvec3 out;
            double above_m;
            if (feels(&f->part[i], point, clearance_m, &above_m, &out)) {
                point = dvec3_mad(point, out, clearance_m - above_m + CLEAR_MORE_M);
                moved = true;
            }
        }
    }
    return point;
}

dvec3 figure_turn(const figure *f, dvec3 point, dvec3 direction, double clearance_m)
{
    for (uint32_t i = 0; i < f->part_count; i++) {
        dvec3 out;
        double above_m;
        if (!feels(&f->part[i], point, clearance_m + FEEL_M, &above_m, &out)) {
            continue;
        }
        /* it may still go in by as much of its length as it is of FEEL_M away */
        double allowed = above_m > clearance_m ? (above_m - clearance_m) / FEEL_M : 0.0;
        double inward = -dvec3_dot(direction, out);
        if (inward > allowed) {
            direction = dvec3_unit(dvec3_mad(direction, out, inward - allowed), direction);
        }
    }
    return direction;
}
