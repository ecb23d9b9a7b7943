/* invariant_fixture.h: what the tests of the physics' invariants share: small heads of hair, motions drawn from a seed,
 * and strands read back. A failure to make one ends the program, as in fixture.h. */
#ifndef INVARIANT_FIXTURE_H
#define INVARIANT_FIXTURE_H

#include "awt.h"
#include "base/vec.h"

/* A built-in style grown from `seed` with few wisps, so that a second of it takes milliseconds. The caller destroys. */
awt_groom *small_groom(const char *style, uint64_t seed);

/* At rest at time 0 with identity poses, with the default head and body. The caller destroys. */
awt_forest *small_forest(const awt_groom *groom, const awt_params *params);

/* The forest again, and its groom, from a snapshot of it. The caller destroys both, the forest first. */
awt_forest *small_restored(const awt_forest *f, awt_groom **groom);

/* The style's parameters, with the ones that tests depend on set here: no contact, threshold 0.3. */
awt_params small_params(const char *style);

/* A head that sways and turns about all axes at once, each at an amplitude and a rate from the seed; at rest at time 0.
 * The body sways with it and turns half as far. */
typedef struct wild {
    double sway_m[3], turn_rad[3], sway_rate[3], turn_rate[3];
} wild;

/* Amplitudes 5 to 10 cm and 0.2 to 0.4 rad, times `vigour`; rates 6 to 9 rad/s. */
wild wild_make(uint64_t seed, double vigour);
awt_motion wild_at(const wild *w, int64_t time_us);
/* Moves and advances the forest to time_us. */
void wild_advance(awt_forest *f, const wild *w, int64_t time_us, awt_step_stats *stats);

/* First b, then a; both turn head into world. */
void orientation_mul(const double a[4], const double b[4], double out[4]);

/* Strand points, head frame. */
typedef struct strand_points {
    float *centres, *frames, *scratch, *points;
    size_t count;
} strand_points;

strand_points strand_points_of(const awt_forest *f);
void strand_points_read(strand_points *p, const awt_forest *f);
void strand_points_fini(strand_points *p);
/* Infinite where a coordinate is not a number. */
double strand_points_greatest(const strand_points *a, const strand_points *b);
double strand_points_mean(const strand_points *a, const strand_points *b);

#endif
