/* scalp.c: see scalp.h. */
#include "groom/scalp.h"

#include "base/rng.h"
#include "base/trig.h"

/* The hairline, from the middle of the forehead round to the nape: cosine of the azimuth from the face's direction,
 * sine of the elevation. It recedes a little at the temples, comes down before the ear, passes over the ear and goes
 * down behind it. */
static const struct {
    double cos_azimuth, sin_elevation;
} hairline[] = {
    {1.00, 0.72},  {0.93, 0.73},   {0.85, 0.75},   {0.74, 0.70},   {0.62, 0.52},
    {0.50, 0.24},  {0.38, -0.04},  {0.24, -0.12},  {0.12, 0.02},   {0.00, 0.16},
    {-0.16, 0.14}, {-0.32, -0.08}, {-0.50, -0.36}, {-0.75, -0.56}, {-1.00, -0.62},
};

enum { HAIRLINE_COUNT = sizeof hairline / sizeof hairline[0] };

static double hairline_at(double cos_azimuth)
{
    int i = 1;
    while (i + 1 < HAIRLINE_COUNT && hairline[i].cos_azimuth > cos_azimuth) {
        i++;
    }
    double share =
        (hairline[i - 1].cos_azimuth - cos_azimuth) / (hairline[i - 1].cos_azimuth - hairline[i].cos_azimuth);
    return hairline[i - 1].sin_elevation + (hairline[i].sin_elevation - hairline[i - 1].sin_elevation) * share;
}

bool scalp_holds(dvec3 direction, double slack)
{
    double across = sqrt(direction.x * direction.x + direction.z * direction.z);
    if (across < 1e-9) {
        return direction.y > 0.0;
    }
    double wobble_a, wobble_b, unused;
    trig_sin_cos(23.0 * direction.x + 4.0 * direction.z, &wobble_a, &unused);
    trig_sin_cos(41.0 * direction.x - 17.0 * direction.z + 1.0, &wobble_b, &unused);
    double line = hairline_at(direction.z / across) + 0.014 * wobble_a + 0.010 * wobble_b;
    return direction.y > line - slack;
}

/* Steps of the two-dimensional golden-ratio sequence (Roberts 2018): 1/g and 1/g^2 with g^3 = g + 1. */
#define STEP_U 0.75487766624669276
#define STEP_V 0.56984029099805327
#define SCALP_SHARE 0.5 /* of the sphere, roughly: only the jitter depends on it */

static double fraction(double value)
{
    return value - floor(value);
}

void scalp_spread(uint64_t seed, uint32_t count, double fray, dvec3 *places)
{
    rng r = rng_seed(seed);
    const double start_u = rng_unit(&r), start_v = rng_unit(&r);
    const double jitter = 0.5 * sqrt(SCALP_SHARE / (double)(count > 0 ? count : 1)); /* half the mean distance */
    uint32_t placed = 0;
    for (double i = 0.0; placed < count; i += 1.0) {
        double u = fraction(start_u + i * STEP_U + rng_between(&r, -jitter, jitter) + 1.0);
        double v = fraction(start_v + i * STEP_V + rng_between(&r, -jitter, jitter) + 1.0);
        double y = 1.0 - 2.0 * u, across = sqrt(1.0 - y * y), sine, cosine;
        trig_sin_cos(2.0 * TRIG_PI * v, &sine, &cosine);
        dvec3 place = {across * sine, y, across * cosine};
        if (scalp_holds(place, rng_between(&r, -fray, fray))) {
            places[placed++] = place;
        }
    }
}
