/* place.c: strands from a file's units and axes into the head frame.
 *
 * No file names its unit or its axes (DATA.md). What the caller gives is used as given; the rest is guessed, in this
 * order, each from what came before: the head from the roots (head.c); up from where on it hair grows and how it
 * falls; the face from where none grows; the unit from the head's size. Only + - * / and sqrt: the result feeds the
 * simulation. */
#include "awt.h"

#include "base/error.h"
#include "groom/head.h"

#include <inttypes.h>
#include <stdlib.h>

static const double place_min_scale = 1e-6, place_max_scale = 1e6;
static const double place_max_radius_m = 100;    /* of a head */
static const double place_max_distance_m = 1000; /* of a point from the head's centre */

static const double place_least_rise = -0.1; /* of the mean root direction on a head: hair grows on top */

/* File to head frame: the centre goes to 0, up to +Y, then quarter turns about +Y, then the scale. */
typedef struct placing {
    head_sphere head;
    awt_up_axis up;
    int quarter_turns; /* 0 .. 3, each takes +Z to +X */
    double scale;
} placing;

/* ---- what the caller gave ---------------------------------------------------------------------------------------- */

static awt_status placement_check(const awt_placement *given, awt_error *error)
{
    const double *c = given->head_centre;
    if (given->up != AWT_UP_GUESS && given->up != AWT_UP_Y && given->up != AWT_UP_Z) {
        return error_set(error, AWT_BAD_VALUE, "the up axis is Y, Z or to be guessed, not number %d", (int)given->up);
    }
    if (!(given->scale == 0 || (given->scale >= place_min_scale && given->scale <= place_max_scale))) {
        return error_set(error, AWT_BAD_VALUE, "a scale of %g m per unit is outside %g to %g", given->scale,
                         place_min_scale, place_max_scale);
    }
    if (!(given->head_radius >= 0) || !isfinite(given->head_radius)) {
        return error_set(error, AWT_BAD_VALUE, "a head's radius of %g is not a length", given->head_radius);
    }
    if (given->head_radius > 0 && !(isfinite(c[0]) && isfinite(c[1]) && isfinite(c[2]))) {
        return error_set(error, AWT_BAD_VALUE, "the head's centre %g, %g, %g is not finite", c[0], c[1], c[2]);
    }
    return AWT_OK;
}

/* ---- up and face ---------------------------------------------------------------------------------------------------
 */

static dvec3 turn_up(dvec3 v, awt_up_axis up)
{
    return up == AWT_UP_Z ? (dvec3){v.x, v.z, -v.y} : v;
}

/* Hair grows on the upper side of a head, and falls. Where the roots do not go around a head (a ponytail on a head
 * that the caller gave), only the fall tells. */
static awt_up_axis up_guess(const head_root *roots, uint32_t count, const head_view *view)
{
    dvec3 rise = view->covers_head ? dvec3_scale(view->mean, 2) : (dvec3){0, 0, 0};
    for (uint32_t i = 0; i < count; i++) {
        rise = dvec3_sub(rise, dvec3_scale(roots[i].fall, 1.0 / count));
    }
    return rise.z > rise.y ? AWT_UP_Z : AWT_UP_Y;
}

/* From the centre's height downwards hair grows behind and beside the face, not on it: the roots there lie, on the
 * mean, behind. No turn where they are few or lean no way clearly. */
static int face_guess(const head_root *roots, uint32_t count, const placing *p)
{
    const double highest = 0.35;    /* radii above the centre: about the brows */
    const double clear_lean = 0.15; /* of unit directions */
    double low = 0, carried = 0;
    dvec3 lean = {0, 0, 0};
    for (uint32_t i = 0; i < count; i++) {
        dvec3 arm = turn_up(dvec3_sub(roots[i].at, p->head.centre), p->up);
        double level = sqrt(arm.x * arm.x + arm.z * arm.z);
        bool on_head = head_carries(&p->head, &roots[i]);
        carried += on_head ? 1 : 0;
        if (on_head && level > 0 && arm.y < highest * p->head.radius) {
            lean = dvec3_add(lean, dvec3_scale(arm, 1.0 / level));
            low += 1;
        }
    }
    bool along_z = fabs(lean.z) > 2 * fabs(lean.x), along_x = fabs(lean.x) > 2 * fabs(lean.z);
    if (low < 20 || low < 0.05 * carried || sqrt(lean.x * lean.x + lean.z * lean.z) < clear_lean * low) {
        return 0;
    }
    /* The face is opposite: at -Z two quarter turns bring it to +Z, at -X one, at +X three. */
    return along_z ? (lean.z > 0 ? 2 : 0) : along_x ? (lean.x > 0 ? 1 : 3) : 0;
}

/* ---- the unit -------------------------------------------------------------------------------------------------------
 */

/* A head of human size in some unit in use is taken to be in it; any other is brought to the usual size. */
static double scale_guess(double radius)
{
    static const struct {
        double least, greatest, scale;
    } units[] = {
        {0.06, 0.14, 1.0},   /* metres */
        {2.4, 5.5, 0.0254},  /* inches */
        {6.0, 14.0, 0.01},   /* centimetres */
        {60.0, 140.0, 0.001} /* millimetres */
    };
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
        if (radius >= units[i].least && radius <= units[i].greatest) {
            return units[i].scale;
        }
    }
    return AWT_HEAD_RADIUS_M / radius;
}

static awt_status scale_take(const awt_placement *given, double radius, double *scale, awt_error *error)
{
    *scale = given->scale > 0 ? given->scale : scale_guess(radius);
    if (!(*scale >= place_min_scale && *scale <= place_max_scale)) {
        return error_set(error, AWT_BAD_VALUE, "the head's radius is %g file units: no unit of length makes it a head",
                         radius);
    }
    if (!(radius * *scale <= place_max_radius_m)) {
        return error_set(error, AWT_BAD_VALUE, "at a scale of %g the head's radius is %g m; the most is %g m", *scale,
                         radius * *scale, place_max_radius_m);
    }
    return AWT_OK;
}

/* ---- the strands
 * ------------------------------------------------------------------------------------------------------ */

static awt_status placing_find(const head_root *roots, uint32_t count, const awt_placement *given, placing *p,
                               awt_error *error)
{
    const double *c = given->head_centre;
    p->head = (head_sphere){{c[0], c[1], c[2]}, given->head_radius};
    if (given->head_radius == 0) {
        awt_status status = head_find(roots, count, given->up, &p->head, error);
        if (status) {
            return status;
        }
    }
    head_view view = head_look(roots, count, &p->head);
    p->up = given->up != AWT_UP_GUESS ? given->up : up_guess(roots, count, &view);
    if (given->head_radius == 0 && turn_up(view.mean, p->up).y < place_least_rise) {
        return error_set(
            error, AWT_NO_HEAD,
            "with %s up the hair grows on the underside of what looks like a head. Give the up axis, or the "
            "head as --head x,y,z,r in the file's units",
            p->up == AWT_UP_Z ? "Z" : "Y");
    }
    bool all_given = given->up != AWT_UP_GUESS && given->head_radius > 0;
    p->quarter_turns = view.covers_head && !all_given ? face_guess(roots, count, p) : 0;
    return scale_take(given, p->head.radius, &p->scale, error);
}

static dvec3 place_point(const placing *p, const float *position)
{
    dvec3 arm = dvec3_sub((dvec3){position[0], position[1], position[2]}, p->head.centre);
    dvec3 v = dvec3_scale(turn_up(arm, p->up), p->scale);
    for (int turn = 0; turn < p->quarter_turns; turn++) {
        v = (dvec3){v.z, v.y, -v.x};
    }
    return v;
}

/* Before anything is changed: does every point come out near the head? */
static awt_status strands_check(const awt_strands *strands, const placing *p, awt_error *error)
{
    for (uint32_t strand = 0; strand < strands->strand_count; strand++) {
        for (uint32_t i = strands->first_point[strand]; i < strands->first_point[strand + 1]; i++) {
            double distance = dvec3_length(place_point(p, strands->positions + 3 * (size_t)i));
            if (!(distance <= place_max_distance_m)) {
                return error_set(error, AWT_BAD_VALUE,
                                 "at a scale of %g strand %" PRIu32
                                 " (counted from 0) reaches %g m from the head's centre; the most is %g m",
                                 p->scale, strand, distance, place_max_distance_m);
            }
        }
    }
    return AWT_OK;
}

static void strands_place(awt_strands *strands, const placing *p)
{
    for (uint32_t i = 0; i < strands->point_count; i++) {
        float *position = strands->positions + 3 * (size_t)i;
        vec3 placed = vec3_of_dvec3(place_point(p, position));
        position[0] = placed.x, position[1] = placed.y, position[2] = placed.z;
    }
}

static awt_placement placement_taken(const awt_placement *given, const placing *p)
{
    static const double degrees[] = {0, 90, 180, -90};
    return (awt_placement){.scale = p->scale,
                           .up = p->up,
                           .head_centre = {p->head.centre.x, p->head.centre.y, p->head.centre.z},
                           .head_radius = p->head.radius,
                           .guessed_scale = given->scale == 0,
                           .guessed_up = given->up == AWT_UP_GUESS,
                           .guessed_head = given->head_radius == 0,
                           .head_radius_m = p->head.radius * p->scale,
                           .turned_degrees = degrees[p->quarter_turns]};
}

awt_status awt_strands_place(awt_strands *strands, awt_placement *placement, awt_error *error)
{
    placing p;
    awt_status status = placement_check(placement, error);
    if (status) {
        return status;
    }
    if (strands->strand_count == 0) {
        return error_set(error, AWT_NO_STRANDS, NULL);
    }
    head_root *roots = malloc(HEAD_MAX_ROOTS * sizeof *roots);
    if (!roots) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    status = placing_find(roots, head_roots(strands, roots), placement, &p, error);
    free(roots);
    if (!status) {
        status = strands_check(strands, &p, error);
    }
    if (!status) {
        strands_place(strands, &p);
        *placement = placement_taken(placement, &p);
    }
    return status;
}
