/* invariant_fixture.c: see invariant_fixture.h. */
#include "invariant_fixture.h"

#include "base/assert.h"
#include "base/rng.h"
#include "base/trig.h"

#include <stdlib.h>

enum { SMALL_STRANDS = 480, SMALL_FINEST = 120, SMALL_TOP = 15 };

awt_groom *small_groom(const char *style_name, uint64_t seed)
{
    const awt_style *style = awt_style_find(style_name);
    ASSERT(style);
    awt_groom_def def = awt_groom_def_of_style(style);
    def.finest_wisps = SMALL_FINEST;
    def.top_wisps = SMALL_TOP;
    awt_strands grown;
    awt_groom *groom;
    ASSERT(awt_style_grow(style, SMALL_STRANDS, seed, &grown, NULL) == AWT_OK);
    ASSERT(awt_groom_build(&grown, &def, NULL, NULL, &groom, NULL) == AWT_OK);
    awt_strands_fini(&grown);
    return groom;
}

awt_forest *small_forest(const awt_groom *groom, const awt_params *params)
{
    awt_forest_def def = awt_forest_def_default(groom);
    def.params = *params;
    awt_forest *f;
    ASSERT(awt_forest_create(groom, &def, &f, NULL) == AWT_OK);
    return f;
}

awt_forest *small_restored(const awt_forest *f, awt_groom **groom)
{
    awt_forest *restored = NULL;
    size_t size = 0;
    ASSERT(awt_forest_snapshot(f, NULL, 0, &size, NULL) == AWT_OK);
    void *bytes = malloc(size);
    ASSERT(bytes && awt_forest_snapshot(f, bytes, size, &size, NULL) == AWT_OK);
    ASSERT(awt_snapshot_restore(bytes, size, groom, &restored, NULL) == AWT_OK);
    free(bytes);
    return restored;
}

awt_params small_params(const char *style)
{
    awt_params params = awt_style_find(style)->params;
    params.contact = 0;
    params.split_threshold = 0.3f;
    return params;
}

/* ---- motion ---- */

static double either_sign(rng *r, double least, double greatest)
{
    double size = rng_between(r, least, greatest);
    return rng_unit(r) < 0.5 ? -size : size;
}

wild wild_make(uint64_t seed, double vigour)
{
    rng r = rng_seed(seed);
    wild w;
    for (int axis = 0; axis < 3; axis++) {
        w.sway_m[axis] = vigour * either_sign(&r, 0.05, 0.10);
        w.turn_rad[axis] = vigour * either_sign(&r, 0.2, 0.4);
        w.sway_rate[axis] = rng_between(&r, 6.0, 9.0);
        w.turn_rate[axis] = rng_between(&r, 6.0, 9.0);
    }
    return w;
}

/* amplitude (1 - cos(rate t)) / 2: leaves rest with no velocity. */
static double swing(double amplitude, double rate, double t)
{
    double sine, cosine;
    trig_sin_cos(rate * t, &sine, &cosine);
    return 0.5 * amplitude * (1.0 - cosine);
}

static void turn_about(const double turn[3], double share, double orientation[4])
{
    double angle = share * sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]), sine, cosine;
    trig_sin_cos(0.5 * angle, &sine, &cosine);
    for (int axis = 0; axis < 3; axis++) {
        orientation[axis] = angle > 1e-12 ? sine * share * turn[axis] / angle : 0.0;
    }
    orientation[3] = cosine;
}

awt_motion wild_at(const wild *w, int64_t time_us)
{
    awt_motion m = {.time_us = time_us};
    double t = (double)time_us * 1e-6, turn[3];
    for (int axis = 0; axis < 3; axis++) {
        m.head.position[axis] = m.body.position[axis] = swing(w->sway_m[axis], w->sway_rate[axis], t);
        turn[axis] = swing(w->turn_rad[axis], w->turn_rate[axis], t);
    }
    turn_about(turn, 1.0, m.head.orientation);
    turn_about(turn, 0.5, m.body.orientation);
    return m;
}

void wild_advance(awt_forest *f, const wild *w, int64_t time_us, awt_step_stats *stats)
{
    awt_motion m = wild_at(w, time_us);
    ASSERT(awt_forest_move(f, &m, NULL) == AWT_OK);
    ASSERT(awt_forest_advance(f, time_us, stats, NULL) == AWT_OK);
}

void orientation_mul(const double a[4], const double b[4], double out[4])
{
    dquat q = dquat_mul((dquat){a[0], a[1], a[2], a[3]}, (dquat){b[0], b[1], b[2], b[3]});
    out[0] = q.x, out[1] = q.y, out[2] = q.z, out[3] = q.w;
}

/* ---- strands ---- */

strand_points strand_points_of(const awt_forest *f)
{
    awt_groom_info info;
    awt_groom_get_info(awt_forest_groom(f), &info);
    strand_points p = {.count = (size_t)info.strand_count * info.points_per_strand};
    p.centres = malloc((size_t)info.finest_nodes * 3 * sizeof(float));
    p.frames = malloc((size_t)info.finest_nodes * 4 * sizeof(float));
    p.scratch = malloc(awt_groom_strand_scratch(awt_forest_groom(f)) * sizeof(float));
    p.points = malloc(p.count * 3 * sizeof(float));
    ASSERT(p.centres && p.frames && p.scratch && p.points);
    strand_points_read(&p, f);
    return p;
}

void strand_points_read(strand_points *p, const awt_forest *f)
{
    awt_forest_guides(f, p->centres, p->frames);
    awt_groom_strands(awt_forest_groom(f), p->centres, p->frames, p->scratch, p->points);
}

void strand_points_fini(strand_points *p)
{
    free(p->centres), free(p->frames), free(p->scratch), free(p->points);
    *p = (strand_points){0};
}

static double point_distance(const strand_points *a, const strand_points *b, size_t point)
{
    double sum = 0;
    for (size_t axis = 0; axis < 3; axis++) {
        double d = (double)a->points[3 * point + axis] - (double)b->points[3 * point + axis];
        sum += d * d;
    }
    return isfinite(sum) ? sqrt(sum) : (double)INFINITY;
}

double strand_points_greatest(const strand_points *a, const strand_points *b)
{
    double worst = 0;
    for (size_t i = 0; i < a->count; i++) {
        double d = point_distance(a, b, i);
        worst = d > worst ? d : worst;
    }
    return worst;
}

double strand_points_mean(const strand_points *a, const strand_points *b)
{
    double sum = 0;
    for (size_t i = 0; i < a->count; i++) {
        sum += point_distance(a, b, i);
    }
    return sum / (double)a->count;
}
