/* path.c: see path.h. A path is a point that walks: at each step its direction gives way to where it is combed, lifted
 * and pulled, is turned along the body where that is near, and the point is kept out of it. */
#include "groom/path.h"

/* Hair from the front half leans forward and falls before the shoulder, the rest behind it. */
#define DRAPE 0.06

/* a without its part along the unit vector n */
static dvec3 without(dvec3 a, dvec3 n)
{
    return dvec3_mad(a, n, -dvec3_dot(a, n));
}

static double clamp_unit(double value)
{
    return value < 0.0 ? 0.0 : value > 1.0 ? 1.0 : value;
}

/* In front to the side of the parting and back; behind, where the parting has ended, down. */
static dvec3 comb_parted(const path_start *start)
{
    double front = clamp_unit((start->place.z + 0.45) / 0.5);
    return (dvec3){front * start->side + (1.0 - front) * 0.5 * start->place.x, -0.3 - 0.3 * (1.0 - front),
                   -0.5 * front};
}

/* Around and away from the crown; the front swept to one side. */
static dvec3 comb_whorl(dvec3 normal)
{
    static const dvec3 crown = {0.10, 0.86, -0.50};
    dvec3 away = dvec3_sub(normal, crown);
    double distance = dvec3_length(away);
    double swirl = 0.9 / (1.0 + 6.0 * distance * distance);
    double front = clamp_unit(normal.z);
    dvec3 way = dvec3_mad(dvec3_unit(away, (dvec3){0, 0, 1}), dvec3_cross(crown, normal), swirl / (0.2 + distance));
    return dvec3_add(way, (dvec3){1.2 * front, 0.0, 0.0});
}

/* The combing direction in the plane of the scalp, turned by the lock's own whim. */
static dvec3 comb_at(const style_look *look, const path_start *start, dvec3 normal)
{
    dvec3 way = look->parted ? comb_parted(start) : comb_whorl(normal);
    dvec3 flat = dvec3_unit(without(way, normal), (dvec3){0, 0, -1});
    dvec3 beside = dvec3_cross(normal, flat);
    return dvec3_unit(dvec3_mad(flat, beside, start->turn_sin), flat);
}

static double fade(double way_m, double reach_m)
{
    double share = way_m / reach_m;
    return 1.0 / (1.0 + share * share * share * share);
}

/* Where the hair would go at this place if nothing were in its way: a direction. */
static dvec3 aim_at(const style_look *look, const path_start *start, dvec3 point, double arc_m)
{
    dvec3 normal = dvec3_unit(point, (dvec3){0, 1, 0});
    dvec3 aim = {0, -look->fall, start->place.z > 0.15 ? DRAPE : -DRAPE};
    aim = dvec3_mad(aim, comb_at(look, start, normal), look->comb * fade(arc_m, look->comb_reach_m));
    aim = dvec3_mad(aim, normal, look->lift * fade(arc_m, look->lift_reach_m));
    return dvec3_unit(aim, normal);
}

void path_grow(const style_look *look, const figure *body, const path_start *start, path *out)
{
    const double step_m = start->length_m / PATH_STEPS;
    const double give = clamp_unit(step_m / look->bend_m);
    dvec3 point = dvec3_scale(start->place, AWT_HEAD_RADIUS_M);
    dvec3 direction = aim_at(look, start, point, 0.0);
    out->length_m = start->length_m;
    out->point[0] = point;
    for (int i = 1; i <= PATH_STEPS; i++) {
        double arc_m = i * step_m;
        double clearance_m = look->layer_m * start->layer * clamp_unit(arc_m / (4.0 * look->layer_m));
        dvec3 aim = figure_turn(body, point, aim_at(look, start, point, arc_m), clearance_m);
        direction = dvec3_unit(dvec3_mad(direction, dvec3_sub(aim, direction), give), direction);
        direction = figure_turn(body, point, direction, clearance_m);
        dvec3 pushed = figure_clear(body, dvec3_mad(point, direction, step_m), clearance_m);
        /* whatever pushed it, a step is a step long */
        direction = dvec3_unit(dvec3_sub(pushed, point), direction);
        point = dvec3_mad(point, direction, step_m);
        out->point[i] = point;
    }
}

/* Cross directions carried along the path: each is the one before, made square to the present direction. */
void path_carry_sides(path *way)
{
    dvec3 side = {0, 0, 0};
    for (int i = 0; i <= PATH_STEPS; i++) {
        int ahead = i < PATH_STEPS ? i + 1 : i, back = i > 0 ? i - 1 : 0;
        dvec3 along = dvec3_unit(dvec3_sub(way->point[ahead], way->point[back]), (dvec3){0, -1, 0});
        dvec3 fresh = fabs(along.x) < 0.6 ? (dvec3){1, 0, 0} : (dvec3){0, 0, 1};
        dvec3 other = dvec3_unit(without(fresh, along), (dvec3){0, 1, 0});
        side = dvec3_unit(without(side, along), other);
        way->side[i] = side;
    }
}

/* The piece that `arc_m` is on, and the share of it that is behind. */
static int piece_at(const path *way, double arc_m, double *share)
{
    double place = clamp_unit(arc_m / way->length_m) * PATH_STEPS;
    int i = (int)place < PATH_STEPS ? (int)place : PATH_STEPS - 1;
    *share = place - i;
    return i;
}

dvec3 path_place(const path *way, double arc_m)
{
    double share;
    int i = piece_at(way, arc_m, &share);
    return dvec3_mad(way->point[i], dvec3_sub(way->point[i + 1], way->point[i]), share);
}

dvec3 path_at(const path *way, double arc_m, dvec3 *across_u, dvec3 *across_v)
{
    double share;
    int i = piece_at(way, arc_m, &share);
    dvec3 piece = dvec3_sub(way->point[i + 1], way->point[i]);
    dvec3 side = dvec3_mad(dvec3_scale(way->side[i], 1.0 - share), way->side[i + 1], share);
    dvec3 along = dvec3_unit(piece, (dvec3){0, -1, 0});
    *across_u = dvec3_unit(without(side, along), way->side[i]);
    *across_v = dvec3_cross(along, *across_u);
    return dvec3_mad(way->point[i], piece, share);
}
