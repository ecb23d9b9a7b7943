/* head.c: finds the head under the roots.
 *
 * A scalp is nearly a sphere: a least-squares sphere through the roots is the head, if they are enough, lie close to
 * it, cover a good part of it, and hair grows out of it and none inside it. What grows below the head (a mane, a
 * beard) bends the sphere, and heads stand on top: so the roots are tried from the top down, first all of them,
 * then ever fewer, and the first sphere that passes is taken. A strip or a patch of roots fits many spheres equally
 * well; that is what the coverage refuses. */
#include "groom/head.h"

#include "base/error.h"
#include "groom/sphere.h"

#include <inttypes.h>

enum { COVERAGE_BINS = 4 /* to an edge of each of the six faces of a cube around the head */ };

static const double head_max_residual = 0.10;  /* rms distance of the roots from the sphere, in radii */
static const double head_min_coverage = 0.25;  /* of the sphere's directions */
static const double head_max_inside = 0.02;    /* share of all roots deep inside */
static const double head_min_outward = 0.10;   /* mean cosine of growth and surface normal */
static const double head_surface_reach = 0.30; /* a root nearer to the surface than this, in radii, is on the head */

/* ---- the strands' roots ------------------------------------------------------------------------------------ */

static dvec3 point_at(const awt_strands *strands, size_t point)
{
    const float *p = strands->positions + 3 * point;
    return (dvec3){p[0], p[1], p[2]};
}

static dvec3 direction(dvec3 from, dvec3 to)
{
    dvec3 way = dvec3_sub(to, from);
    double length = dvec3_length(way);
    return length > 0 ? dvec3_scale(way, 1.0 / length) : (dvec3){0, 0, 0};
}

static head_root root_of_strand(const awt_strands *strands, uint32_t strand)
{
    uint32_t first = strands->first_point[strand], end = strands->first_point[strand + 1];
    head_root root = {.at = point_at(strands, first)};
    for (uint32_t point = first + 1; point < end && dvec3_length(root.growth) == 0; point++) {
        root.growth = direction(root.at, point_at(strands, point));
    }
    root.fall = direction(root.at, point_at(strands, end - 1));
    return root;
}

uint32_t head_roots(const awt_strands *strands, head_root *roots)
{
    uint32_t count = strands->strand_count < HEAD_MAX_ROOTS ? strands->strand_count : HEAD_MAX_ROOTS;
    for (uint32_t i = 0; i < count; i++) {
        roots[i] = root_of_strand(strands, (uint32_t)((uint64_t)i * strands->strand_count / count));
    }
    return count;
}

/* ---- is it a head? --------------------------------------------------------------------------------------------- */

/* Cells of equal angle along each edge: tan 22.5 degrees parts half a face. */
static int coverage_bin(double tangent)
{
    const double half = 0.41421356237309503;
    return tangent < -half ? 0 : tangent < 0 ? 1 : tangent < half ? 2 : 3;
}

static int coverage_cell(dvec3 d)
{
    double x = fabs(d.x), y = fabs(d.y), z = fabs(d.z);
    int face = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    double major = face == 0 ? d.x : face == 1 ? d.y : d.z;
    double u = face == 0 ? d.y : d.x, v = face == 2 ? d.y : d.z;
    if (major == 0) {
        return 0; /* a root at the very centre */
    }
    int cell = (2 * face + (major > 0)) * COVERAGE_BINS + coverage_bin(u / fabs(major));
    return cell * COVERAGE_BINS + coverage_bin(v / fabs(major));
}

bool head_carries(const head_sphere *head, const head_root *root)
{
    return sphere_off_surface(head, root->at) <= head_surface_reach * head->radius;
}

/* What the window's roots say of the sphere. */
static head_view window_view(const head_root *roots, uint32_t count, const sphere_window *window,
                             const head_sphere *head)
{
    bool covered[6 * COVERAGE_BINS * COVERAGE_BINS] = {false};
    const uint32_t cells = sizeof covered / sizeof covered[0];
    head_view view = {0};
    uint32_t seen = 0, hit = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (sphere_window_holds(window, &roots[i])) {
            dvec3 d = direction(head->centre, roots[i].at);
            hit += covered[coverage_cell(d)] ? 0 : 1;
            covered[coverage_cell(d)] = true;
            view.mean = dvec3_add(view.mean, d);
            seen++;
        }
    }
    view.mean = seen ? dvec3_scale(view.mean, 1.0 / seen) : view.mean;
    view.coverage = (double)hit / cells;
    view.covers_head = seen >= SPHERE_MIN_ROOTS && view.coverage >= head_min_coverage;
    return view;
}

head_view head_look(const head_root *roots, uint32_t count, const head_sphere *head)
{
    sphere_window surface = {AWT_UP_Y, -INFINITY, *head, head_surface_reach * head->radius};
    return window_view(roots, count, &surface, head);
}

/* Hair grows out of a head, and not inside it. */
static bool head_grows_hair(const head_root *roots, uint32_t count, const head_sphere *head)
{
    uint32_t carried = 0, inside = 0;
    double outward = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (head_carries(head, &roots[i])) {
            outward += dvec3_dot(direction(head->centre, roots[i].at), roots[i].growth);
            carried++;
        } else if (dvec3_length(dvec3_sub(roots[i].at, head->centre)) < head->radius) {
            inside++;
        }
    }
    return outward >= head_min_outward * carried && inside <= head_max_inside * count;
}

static bool fit_is_head(const head_root *roots, uint32_t count, const sphere_fit *fit)
{
    return fit->sphere.radius > 0 && fit->residual <= head_max_residual &&
           window_view(roots, count, &fit->window, &fit->sphere).covers_head &&
           head_grows_hair(roots, count, &fit->sphere);
}

/* The largest top part of the roots that makes a head; `whole` is the sphere through all of them, head or not. */
static sphere_fit head_find_along(const head_root *roots, uint32_t count, awt_up_axis up, sphere_fit *whole)
{
    double top = sphere_height(roots[0].at, up), bottom = top;
    for (uint32_t i = 1; i < count; i++) {
        double h = sphere_height(roots[i].at, up);
        top = h > top ? h : top;
        bottom = h < bottom ? h : bottom;
    }
    for (double share = 1.0; share > 0.1; share *= 0.9) {
        double lowest = share < 1.0 ? top - share * (top - bottom) : bottom;
        sphere_fit fit = sphere_through(roots, count, up, lowest);
        if (share == 1.0) {
            *whole = fit;
        }
        if (fit_is_head(roots, count, &fit)) {
            return fit;
        }
    }
    return (sphere_fit){0};
}

static awt_status head_refuse(const head_root *roots, uint32_t count, const sphere_fit *whole, awt_error *error)
{
    static const char give[] = "Give the head as --head x,y,z,r in the file's units";
    if (count < SPHERE_MIN_ROOTS) {
        return error_set(error, AWT_NO_HEAD, "%" PRIu32 " strands are too few to show a head (%d are needed). %s",
                         count, SPHERE_MIN_ROOTS, give);
    }
    if (whole->sphere.radius == 0) {
        return error_set(
            error, AWT_NO_HEAD,
            "the roots do not show a head: the sphere nearest to them is off by %.0f %% of its radius (a head: at "
            "most %.0f %%) and they cover %.0f %% of it (at least %.0f %%). %s",
            100 * whole->residual, 100 * head_max_residual,
            100 * window_view(roots, count, &whole->window, &whole->sphere).coverage, 100 * head_min_coverage, give);
    }
    return error_set(
        error, AWT_NO_HEAD,
        "the roots do not show a head: the sphere nearest to them is off by %.0f %% of its radius and they "
        "cover %.0f %% of it (%.0f %% at most and %.0f %% at least make a head). %s",
        100 * whole->residual, 100 * window_view(roots, count, &whole->window, &whole->sphere).coverage,
        100 * head_max_residual, 100 * head_min_coverage, give);
}

awt_status head_find(const head_root *roots, uint32_t count, awt_up_axis up, head_sphere *out, awt_error *error)
{
    sphere_fit best = {0}, whole = {0};
    for (int axis = AWT_UP_Y; axis <= AWT_UP_Z && count >= SPHERE_MIN_ROOTS; axis++) {
        if (up == AWT_UP_GUESS || up == (awt_up_axis)axis) {
            sphere_fit fit = head_find_along(roots, count, (awt_up_axis)axis, &whole);
            best = fit.used > best.used ? fit : best;
        }
    }
    if (best.used == 0) {
        return head_refuse(roots, count, &whole, error);
    }
    *out = best.sphere;
    return AWT_OK;
}
