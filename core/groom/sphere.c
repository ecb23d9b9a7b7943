/* sphere.c: see sphere.h. */
#include "groom/sphere.h"

enum { FIT_ROUNDS = 4 /* of trimming stray roots */ };

double sphere_height(dvec3 at, awt_up_axis up)
{
    return up == AWT_UP_Z ? at.z : at.y;
}

double sphere_off_surface(const head_sphere *sphere, dvec3 at)
{
    return fabs(dvec3_length(dvec3_sub(at, sphere->centre)) - sphere->radius);
}

bool sphere_window_holds(const sphere_window *window, const head_root *root)
{
    return sphere_height(root->at, window->up) >= window->lowest &&
           (window->around.radius == 0 || sphere_off_surface(&window->around, root->at) <= window->reach);
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
static uint32_t window_measure(const head_root *roots, uint32_t count, const sphere_window *window, dvec3 *mean,
                               double *spread)
{
    uint32_t used = 0;
    dvec3 sum = {0, 0, 0};
    double squares = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (sphere_window_holds(window, &roots[i])) {
            sum = dvec3_add(sum, roots[i].at);
            used++;
        }
    }
    *mean = used ? dvec3_scale(sum, 1.0 / used) : sum;
    for (uint32_t i = 0; i < count; i++) {
        if (sphere_window_holds(window, &roots[i])) {
            dvec3 arm = dvec3_sub(roots[i].at, *mean);
            squares += dvec3_dot(arm, arm);
        }
    }
    *spread = used ? sqrt(squares / used) : 0;
    return used;
}

/* Least squares of 2 c.p + k = |p|^2, with r^2 = k + |c|^2, over the window's roots brought to mean 0, spread 1. */
static bool sphere_solve(const head_root *roots, uint32_t count, const sphere_window *window, dvec3 mean, double spread,
                         head_sphere *out)
{
    double m[4][5] = {{0}}, x[4];
    for (uint32_t i = 0; i < count; i++) {
        if (!sphere_window_holds(window, &roots[i])) {
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

static double window_residual(const head_root *roots, uint32_t count, const sphere_window *window,
                              const head_sphere *sphere, uint32_t used)
{
    double squares = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (sphere_window_holds(window, &roots[i])) {
            double off = sphere_off_surface(sphere, roots[i].at) / sphere->radius;
            squares += off * off;
        }
    }
    return sqrt(squares / used);
}

sphere_fit sphere_through(const head_root *roots, uint32_t count, awt_up_axis up, double lowest)
{
    sphere_window window = {.up = up, .lowest = lowest};
    sphere_fit fit = {0};
    for (int round = 0; round < FIT_ROUNDS; round++) {
        dvec3 mean;
        double spread;
        head_sphere sphere;
        uint32_t used = window_measure(roots, count, &window, &mean, &spread);
        if (used < SPHERE_MIN_ROOTS || !(spread > 0) || !sphere_solve(roots, count, &window, mean, spread, &sphere)) {
            return (sphere_fit){0};
        }
        fit = (sphere_fit){sphere, window, window_residual(roots, count, &window, &sphere, used), used};
        window.around = sphere;
        window.reach = 3 * fit.residual * sphere.radius;
    }
    return fit;
}
