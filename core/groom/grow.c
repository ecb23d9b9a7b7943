/* grow.c: the strands of a built-in style. Roots are spread over the scalp and gathered into locks, locks into larger
 * locks. Every lock and every strand takes its own path from its root; a lock leans towards its larger lock, a strand
 * towards its lock, the more the nearer to the tip. Waves and curls are added in the lock's cross directions, in one
 * phase for the strands of a lock. Every strand has its own random numbers, drawn from the seed and its number. */
#include "groom/look.h"

#include <stdlib.h>
#include "base/error.h"
#include "base/rng.h"
#include "base/trig.h"
#include "groom/figure.h"
#include "groom/path.h"
#include "groom/scalp.h"

enum { GROW_MAX_LOCKS = 2000 };

#define ROOT_FRAY 0.03      /* of the hairline, in sines of elevation */
#define LEAN_TO_LARGER 0.25 /* share by which locks of a larger lock come together at the tip */
#define LEAST_CLEARANCE_M 0.0008

/* Streams of random numbers: one seed, told apart. */
enum { STREAM_ROOTS = 1, STREAM_LOCKS, STREAM_LARGER, STREAM_LOCK, STREAM_STRAND };

typedef struct lock {
    path way;
    double wave_phase, wave_m, wave_length_m;
    double curl_phase, curl_m, curl_turn_m; /* signed length of a turn: handedness */
} lock;

typedef struct growth {
    const style_look *look;
    figure body;
    uint64_t seed;
    uint32_t strand_count, lock_count, larger_count;
    dvec3 *roots, *locks, *larger; /* directions from the head's centre */
    uint32_t *lock_of;             /* [strand_count] */
    uint32_t *by_lock;             /* [strand_count] root numbers, lock by lock */
    uint32_t *lock_first;          /* [lock_count + 1] */
} growth;

static rng stream(uint64_t seed, uint64_t kind, uint64_t number)
{
    return rng_seed(seed * UINT64_C(0x9e3779b97f4a7c15) + (kind << 32) + number);
}

static double blend(double a, double b, double share)
{
    return a + (b - a) * share;
}

/* Of the parting; hair without one is all of one side. */
static double side_of(const style_look *look, dvec3 place)
{
    return look->parted && place.x < look->parting_x ? -1.0 : 1.0;
}

/* The place nearest to `place`, on its side of the parting unless all there are a head's radius farther. */
static uint32_t nearest_place(const style_look *look, dvec3 place, const dvec3 *places, uint32_t count)
{
    uint32_t best = 0;
    double least = 1e30;
    for (uint32_t i = 0; i < count; i++) {
        dvec3 away = dvec3_sub(place, places[i]);
        double far = dvec3_dot(away, away);
        far += far < least && side_of(look, place) != side_of(look, places[i]) ? 1.0 : 0.0;
        if (far < least) {
            least = far;
            best = i;
        }
    }
    return best;
}

/* Longest on top, shorter towards nape and temples, where hair also lies closest to the scalp. */
static path_start start_at(const style_look *look, dvec3 place, rng *r)
{
    double height = (place.y + 0.55) / 1.3;
    height = height < 0.0 ? 0.0 : height > 1.0 ? 1.0 : height;
    path_start start = {.place = place, .side = side_of(look, place)};
    start.length_m = blend(look->edge_length_m, look->length_m, height * height * (3.0 - 2.0 * height));
    start.layer = blend(0.15, 0.85, height) + rng_between(r, -0.15, 0.15);
    return start;
}

static void lean(path *way, const path *towards, double share)
{
    for (int i = 1; i <= PATH_STEPS; i++) {
        double t = (double)i / PATH_STEPS;
        dvec3 gap = dvec3_sub(towards->point[i], way->point[i]);
        way->point[i] = dvec3_mad(way->point[i], gap, share * t * t);
    }
}

static void grow_larger(const growth *g, uint32_t number, double length_m, path *out)
{
    rng r = stream(g->seed, STREAM_LARGER, number);
    path_start start = start_at(g->look, g->larger[number], &r);
    start.turn_sin = rng_between(&r, -0.15, 0.15);
    start.length_m = length_m;
    path_grow(g->look, &g->body, &start, out);
}

static void grow_lock(const growth *g, uint32_t number, lock *out)
{
    const style_look *look = g->look;
    rng r = stream(g->seed, STREAM_LOCK, number);
    path_start start = start_at(look, g->locks[number], &r);
    start.turn_sin = rng_between(&r, -0.2, 0.2);
    start.length_m *= rng_between(&r, 0.9, 1.05);
    path larger;
    path_grow(look, &g->body, &start, &out->way);
    path_carry_sides(&out->way);
    grow_larger(g, nearest_place(look, start.place, g->larger, g->larger_count), start.length_m, &larger);
    lean(&out->way, &larger, LEAN_TO_LARGER);
    out->wave_phase = rng_between(&r, 0.0, 2.0 * TRIG_PI);
    out->wave_m = look->wave_m * rng_between(&r, 0.5, 1.2);
    out->wave_length_m = look->wave_length_m * rng_between(&r, 0.8, 1.25);
    out->curl_phase = rng_between(&r, 0.0, 2.0 * TRIG_PI);
    out->curl_m = look->curl_m * rng_between(&r, 0.85, 1.15);
    out->curl_turn_m = look->curl_pitch_m * rng_between(&r, 0.85, 1.15) * (rng_unit(&r) < 0.5 ? -1.0 : 1.0);
}

typedef struct strand_traits {
    double length_m, clump, phase, width;
} strand_traits;

/* Sway and curl of the lock at `arc_m`, in its cross directions. */
static dvec3 ornament(const lock *l, const strand_traits *traits, double arc_m, dvec3 u, dvec3 v)
{
    double t = arc_m / l->way.length_m, sine, cosine;
    trig_sin_cos(l->wave_phase + 0.4 * traits->phase + 2.0 * TRIG_PI * arc_m / l->wave_length_m, &sine, &cosine);
    double sway_m = l->wave_m * t * traits->width;
    double a = sway_m * sine, b = 0.5 * sway_m * cosine;
    if (l->curl_m > 0.0) {
        double turn_m = fabs(l->curl_turn_m), grown = arc_m / (1.2 * turn_m);
        double radius_m = l->curl_m * traits->width * (grown < 1.0 ? grown * grown * (3.0 - 2.0 * grown) : 1.0);
        trig_sin_cos(l->curl_phase + traits->phase + 2.0 * TRIG_PI * arc_m / l->curl_turn_m, &sine, &cosine);
        a += radius_m * cosine, b += radius_m * sine;
    }
    return dvec3_mad(dvec3_scale(u, a), v, b);
}

static void grow_strand(const growth *g, const lock *l, uint32_t number, uint32_t points, float *out)
{
    const style_look *look = g->look;
    rng r = stream(g->seed, STREAM_STRAND, number);
    path_start start = start_at(look, g->roots[number], &r);
    bool flyaway = rng_unit(&r) < look->flyaway;
    start.turn_sin = flyaway ? rng_between(&r, -0.15, 0.15) : rng_between(&r, -0.1, 0.1);
    start.layer += flyaway ? rng_between(&r, 0.0, 0.5) : 0.0;
    start.length_m = l->way.length_m;
    strand_traits traits = {.length_m = l->way.length_m * (1.0 - look->length_spread * rng_unit(&r)),
                            .clump = look->clump * (flyaway ? 0.2 : rng_between(&r, 0.8, 1.2)),
                            .phase = rng_between(&r, -0.3, 0.3) * (flyaway ? 4.0 : 1.0),
                            .width = rng_between(&r, 0.85, 1.15)};
    path own;
    path_grow(look, &g->body, &start, &own);
    for (uint32_t i = 0; i < points; i++) {
        double arc_m = traits.length_m * (double)i / (double)(points - 1);
        double t = arc_m / l->way.length_m, together = traits.clump * t * (3.0 - t * (3.0 - t));
        dvec3 u, v;
        dvec3 alone = path_place(&own, arc_m), axis = path_at(&l->way, arc_m, &u, &v);
        dvec3 point = dvec3_mad(alone, dvec3_sub(axis, alone), together);
        point = dvec3_add(point, ornament(l, &traits, arc_m, u, v));
        point = i > 0 ? figure_clear(&g->body, point, LEAST_CLEARANCE_M) : own.point[0];
        out[3 * i + 0] = (float)point.x;
        out[3 * i + 1] = (float)point.y;
        out[3 * i + 2] = (float)point.z;
    }
}

static bool take_growth(growth *g)
{
    g->roots = calloc(g->strand_count, sizeof *g->roots);
    g->locks = calloc(g->lock_count, sizeof *g->locks);
    g->larger = calloc(g->larger_count, sizeof *g->larger);
    g->lock_of = calloc(g->strand_count, sizeof *g->lock_of);
    g->by_lock = calloc(g->strand_count, sizeof *g->by_lock);
    g->lock_first = calloc((size_t)g->lock_count + 1, sizeof *g->lock_first);
    return g->roots && g->locks && g->larger && g->lock_of && g->by_lock && g->lock_first;
}

static void growth_fini(growth *g)
{
    free(g->roots);
    free(g->locks);
    free(g->larger);
    free(g->lock_of);
    free(g->by_lock);
    free(g->lock_first);
}

/* Gathers the roots lock by lock (counting sort). */
static void gather_locks(growth *g)
{
    for (uint32_t s = 0; s < g->strand_count; s++) {
        g->lock_of[s] = nearest_place(g->look, g->roots[s], g->locks, g->lock_count);
        g->lock_first[g->lock_of[s] + 1]++;
    }
    for (uint32_t k = 0; k < g->lock_count; k++) {
        g->lock_first[k + 1] += g->lock_first[k];
    }
    for (uint32_t s = g->strand_count; s-- > 0;) {
        g->by_lock[--g->lock_first[g->lock_of[s] + 1]] = s;
    }
    /* each count now stands at its lock's beginning, one place too far */
    for (uint32_t k = 0; k < g->lock_count; k++) {
        g->lock_first[k] = g->lock_first[k + 1];
    }
    g->lock_first[g->lock_count] = g->strand_count;
}

static bool take_strands(awt_strands *strands, uint32_t strand_count, uint32_t points)
{
    strands->strand_count = strand_count;
    strands->point_count = strand_count * points;
    strands->first_point = calloc((size_t)strand_count + 1, sizeof *strands->first_point);
    strands->positions = calloc((size_t)strands->point_count * 3, sizeof *strands->positions);
    if (!strands->first_point || !strands->positions) {
        return false;
    }
    for (uint32_t s = 0; s <= strand_count; s++) {
        strands->first_point[s] = s * points;
    }
    return true;
}

static uint32_t within(uint32_t value, uint32_t least, uint32_t most)
{
    return value < least ? least : value > most ? most : value;
}

static awt_status check_growth(const awt_style *style, uint32_t strand_count, awt_error *error)
{
    if (!style_look_find(style->name)) {
        return error_set(error, AWT_NO_STYLE, "no built-in style is called \"%s\"", style->name);
    }
    if (strand_count == 0) {
        return error_set(error, AWT_NO_STRANDS, "a groom of no strands cannot be grown");
    }
    if (style->points_per_strand < 2 || style->points_per_strand > AWT_MAX_POINTS_PER_STRAND) {
        return error_set(error, AWT_LIMIT, "%lu points per strand; a strand has 2 to %d",
                         (unsigned long)style->points_per_strand, AWT_MAX_POINTS_PER_STRAND);
    }
    if (strand_count > AWT_MAX_STRANDS || (uint64_t)strand_count * style->points_per_strand > AWT_MAX_POINTS) {
        return error_set(error, AWT_LIMIT, "%lu strands of %lu points each; the limits are %d strands and %d points",
                         (unsigned long)strand_count, (unsigned long)style->points_per_strand, AWT_MAX_STRANDS,
                         AWT_MAX_POINTS);
    }
    return AWT_OK;
}

awt_status awt_style_grow(const awt_style *style, uint32_t strand_count, uint64_t seed, awt_strands *out,
                          awt_error *error)
{
    awt_status status = check_growth(style, strand_count, error);
    if (status != AWT_OK) {
        return status;
    }
    const uint32_t most = strand_count < GROW_MAX_LOCKS ? strand_count : GROW_MAX_LOCKS;
    const uint32_t points = style->points_per_strand;
    growth g = {.look = style_look_find(style->name), .seed = seed, .strand_count = strand_count};
    g.lock_count = within(style->finest_wisps, 1, most);
    g.larger_count = within(style->top_wisps, 1, most);
    awt_strands strands = {0};
    figure_init(&g.body);
    if (!take_growth(&g) || !take_strands(&strands, strand_count, points)) {
        goto fail;
    }
    scalp_spread(stream(seed, STREAM_ROOTS, 0).state, g.strand_count, ROOT_FRAY, g.roots);
    scalp_spread(stream(seed, STREAM_LOCKS, 0).state, g.lock_count, 0.0, g.locks);
    scalp_spread(stream(seed, STREAM_LARGER, 0).state, g.larger_count, 0.0, g.larger);
    gather_locks(&g);
    for (uint32_t k = 0; k < g.lock_count; k++) {
        lock l;
        grow_lock(&g, k, &l);
        for (uint32_t place = g.lock_first[k]; place < g.lock_first[k + 1]; place++) {
            grow_strand(&g, &l, g.by_lock[place], points, strands.positions + 3 * (size_t)place * points);
        }
    }
    growth_fini(&g);
    *out = strands;
    return AWT_OK;

fail:
    growth_fini(&g);
    awt_strands_fini(&strands);
    return error_set(error, AWT_NO_MEMORY, NULL);
}
