/* head.c: finds the head under the roots.
 *
 * A scalp is nearly a sphere: a least-squares sphere through the roots is the head, if they are enough, lie close to
 * it, cover a good part of it, and hair grows out of it and none inside it. What grows below the head (a mane, a
 * beard) bends the sphere, and heads stand on top: so the roots are tried from the top down, first all of them,
 * then ever fewer, and the first sphere that passes is taken. A strip or a patch of roots fits many spheres equally
 * well; that is what the coverage refuses. */
#include "groom/head.h"

#include "base/error.h"

#include <inttypes.h>

enum {
    HEAD_MIN_ROOTS = 50,
    FIT_ROUNDS = 4,   /* of trimming stray roots */
    COVERAGE_BINS = 4 /* to an edge of each of the six faces of a cube around the head */
};

static const double head_max_residual = 0.10;  /* rms distance of the roots from the sphere, in radii */
static const double head_min_coverage = 0.25;  /* of the sphere's directions */
static const double head_max_inside = 0.02;    /* share of all roots deep inside */
static const double head_min_outward = 0.10;   /* mean cosine of growth and surface normal */
static const double head_surface_reach = 0.30; /* a root nearer to the surface than this, in radii, is on the head */

/* The roots that are looked at: above a height, and, once there is a sphere, not far from it. */
typedef struct fit_window {
    awt_up_axis up;
    double lowest;
    head_sphere around; /* radius 0: anywhere */
    double reach;
} fit_window;

typedef struct sphere_fit {
    head_sphere sphere; /* radius 0: none fits */
    fit_window window;  /* the roots it was fitted to */
    double residual;    /* rms, in radii */
    uint32_t used;      /* how many they are */
} sphere_fit;

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

/* ---- a sphere through some of the roots ---------------------------------------------------------------------- */

static double height(dvec3 at, awt_up_axis up)
{
    return up == AWT_UP_Z ? at.z : at.y;
}

static double off_surface(const head_sphere *sphere, dvec3 at)
{
    return fabs(dvec3_length(dvec3_sub(at, sphere->centre)) - sphere->radius);
}

static bool window_holds(const fit_window *window, const head_root *root)
{
    return height(root->at, window->up) >= window->lowest &&
           (window->around.radius == 0 || off_surface(&window->around, root->at) <= window->reach);
}

/* Gaussian elimination with pivots, in place: m is [4][4 | right side]. False: singular, as for roots in a plane. */
static bool solve4(double m[4][5], double x[4])
{
    for (int column = 0; column < 4; column++) {
        int pivot = column;
        for (int row = column + 1; row < 4; row++) {
            pivot = fabs(m[row][column]) > fabs(m[pivot][column]) ? row : pivot;
        }
        if (!(fabs(m[pivot][column]) > 1e-9)) {
            return false;
        }
        for (int k = 0; k < 5; k++) {
            double held = m[column][k];
            m[column][k] = m[pivot][k];
            m[pivot][k] = held;
        }
        for (int row = column + 1; row < 4; row++) {
            double factor = m[row][column] / m[column][column];
            for (int k = column; k < 5; k++) {
                m[row][k] -= factor * m[column][k];
            }
        }
    }
    for (int row = 3; row >= 0; row--) {
        x[row] = m[row][4];
        for (int k = row + 1; k < 4; k++) {
            x[row] -= m[row][k] * x[k];
        }
        x[row] /= m[row][row];
    }
    return true;
}

/* Mean of the window's roots and their rms distance from it; how many they are. */
static uint32_t window_measure(const head_root *roots, uint32_t count, const fit_window *window, dvec3 *mean,
                               double *spread)
{
    uint32_t used = 0;
    dvec3 sum = {0, 0, 0};
    double squares = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (window_holds(window, &roots[i])) {
            sum = dvec3_add(sum, roots[i].at);
            used++;
        }
    }
    *mean = used ? dvec3_scale(sum, 1.0 / used) : sum;
    for (uint32_t i = 0; i < count; i++) {
        if (window_holds(window, &roots[i])) {
            dvec3 arm = dvec3_sub(roots[i].at, *mean);
            squares += dvec3_dot(arm, arm);
        }
    }
    *spread = used ? sqrt(squares / used) : 0;
    return used;
}

/* Least squares of 2 c.p + k = |p|^2, with r^2 = k + |c|^2, over the window's roots brought to mean 0, spread 1. */
static bool sphere_solve(const head_root *roots, uint32_t count, const fit_window *window, dvec3 mean, double spread,
                         head_sphere *out)
{
    double m[4][5] = {{0}}, x[4];
    for (uint32_t i = 0; i < count; i++) {
        if (!window_holds(window, &roots[i])) {
            continue;
        }
        dvec3 p = dvec3_scale(dvec3_sub(roots[i].at, mean), 1.0 / spread);
        double row[5] = {2 * p.x, 2 * p.y, 2 * p.z, 1, dvec3_dot(p, p)};
        for (int a = 0; a < 4; a++) {
            for (int b = 0; b < 5; b++) {
                m[a][b] += row[a] * row[b] / count;
            }
        }
    }
    if (!solve4(m, x)) {
        return false;
    }
    dvec3 centre = {x[0], x[1], x[2]};
    double square = x[3] + dvec3_dot(centre, centre);
    if (!(square > 0)) {
        return false;
    }
    *out = (head_sphere){dvec3_add(mean, dvec3_scale(centre, spread)), sqrt(square) * spread};
    return true;
}

static double window_residual(const head_root *roots, uint32_t count, const fit_window *window,
                              const head_sphere *sphere, uint32_t used)
{
    double squares = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (window_holds(window, &roots[i])) {
            double off = off_surface(sphere, roots[i].at) / sphere->radius;
            squares += off * off;
        }
    }
    return sqrt(squares / used);
}

/* Fits, leaves out what is further than three standard deviations from the sphere, and fits again. */
static sphere_fit sphere_fit_above(const head_root *roots, uint32_t count, awt_up_axis up, double lowest)
{
    fit_window window = {.up = up, .lowest = lowest};
    sphere_fit fit = {0};
    for (int round = 0; round < FIT_ROUNDS; round++) {
        dvec3 mean;
        double spread;
        head_sphere sphere;
        uint32_t used = window_measure(roots, count, &window, &mean, &spread);
        if (used < HEAD_MIN_ROOTS || !(spread > 0) || !sphere_solve(roots, count, &window, mean, spread, &sphere)) {
            return (sphere_fit){0};
        }
        fit = (sphere_fit){sphere, window, window_residual(roots, count, &window, &sphere, used), used};
        window.around = sphere;
        window.reach = 3 * fit.residual * sphere.radius;
    }
    return fit;
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
    return off_surface(head, root->at) <= head_surface_reach * head->radius;
}

/* What the window's roots say of the sphere. */
static head_view window_view(const head_root *roots, uint32_t count, const fit_window *window, const head_sphere *head)
{
    bool covered[6 * COVERAGE_BINS * COVERAGE_BINS] = {false};
    const uint32_t cells = sizeof covered / sizeof covered[0];
    head_view view = {0};
    uint32_t seen = 0, hit = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (window_holds(window, &roots[i])) {
            dvec3 d = direction(head->centre, roots[i].at);
            hit += covered[coverage_cell(d)] ? 0 : 1;
            covered[coverage_cell(d)] = true;
            view.mean = dvec3_add(view.mean, d);
            seen++;
        }
    }
    view.mean = seen ? dvec3_scale(view.mean, 1.0 / seen) : view.mean;
    view.coverage = (double)hit / cells;
    view.covers_head = seen >= HEAD_MIN_ROOTS && view.coverage >= head_min_coverage;
    return view;
}

head_view head_look(const head_root *roots, uint32_t count, const head_sphere *head)
{
    fit_window surface = {AWT_UP_Y, -INFINITY, *head, head_surface_reach * head->radius};
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
    double top = height(roots[0].at, up), bottom = top;
    for (uint32_t i = 1; i < count; i++) {
        double h = height(roots[i].at, up);
        top = h > top ? h : top;
        bottom = h < bottom ? h : bottom;
    }
    for (double share = 1.0; share > 0.1; share *= 0.9) {
        double lowest = share < 1.0 ? top - share * (top - bottom) : bottom;
        sphere_fit fit = sphere_fit_above(roots, count, up, lowest);
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
    if (count < HEAD_MIN_ROOTS) {
        return error_set(error, AWT_NO_HEAD, "%" PRIu32 " strands are too few to show a head (%d are needed). %s",
                         count, HEAD_MIN_ROOTS, give);
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
    for (int axis = AWT_UP_Y; axis <= AWT_UP_Z && count >= HEAD_MIN_ROOTS; axis++) {
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
