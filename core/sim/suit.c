/* suit.c: see suit.h.
 *
 * Preloaded style springs (rest_gravity) hold a groom at rest in equilibrium, but upright hair may tip out of it like a
 * column. A joint of M - 1 = n segments of length l has the stiffness omega^2 q u^2 l^2 / 2 where hair of weight q g a
 * metre is hung u metres further (joint.c), so (u^2 t')' + (2 g / omega^2 l^2) u t = 0 for its turning t along a
 * column. What stays finite at the tip is J1(2 sqrt(2 g u) / (omega l)) / sqrt(u), and a root held fast asks that it be
 * 0 there: the column stands while omega^2 > 2 g L / (l^2 j^2 / 4), j = 3.83 the first zero of J1. Hair that rises at a
 * slope is loaded by so much less; hair that hangs is not at all. */
#include "sim/suit.h"

#include "base/vec.h"

#include <math.h>

#define GRAVITY_M_S2 9.81f
#define BEND_RAD 0.7f /* of a joint by gravity alone; the built-in styles' own values lie near this */
#define OMEGA_LEAST 15.0f
#define OMEGA_MOST 40.0f
#define COLUMN 0.545f /* 8 / j^2 */
#define COLUMN_SAFETY \
    2.0f /* how much stiffer than what just stands; then it bends twice as far as without its weight */
#define COLUMN_OMEGA_MOST 80.0f
#define FALLING_SHARE 10 /* one strand of so many may tip over: a stray does not make all the others stiff */

enum { OMEGA_BINS = 81 };

/* What the wisp needs so as not to tip over: 0 where it hangs. */
static float column_omega(const awt_groom *groom, uint32_t g)
{
    const uint32_t sections = groom->info.sections;
    const vec3 *at = groom->rest_position + (size_t)g * sections;
    float length_m = 0, height = 0, reach = 0; /* the hung moments: of the height, of the way */
    for (uint32_t i = 1; i < sections; i++) {
        const float hung = (float)(sections - i), link_m = vec3_distance(at[i], at[i - 1]);
        length_m += link_m;
        height += hung * (at[i].y - at[i - 1].y);
        reach += hung * link_m;
    }
    const float segment_m = length_m / (float)(sections - 1);
    if (!(height > 0) || !(segment_m > 1e-3f)) {
        return 0;
    }
    return sqrtf(COLUMN_SAFETY * COLUMN * GRAVITY_M_S2 * length_m * height / reach) / segment_m;
}

/* The least that holds all but a few strands. */
static float upright_omega(const awt_groom *groom)
{
    uint32_t strands[OMEGA_BINS] = {0}, over = 0;
    for (uint32_t g = groom_finest_first(groom); g < groom->gc_count; g++) {
        const float omega = column_omega(groom, g);
        const int bin = omega < COLUMN_OMEGA_MOST ? (int)ceilf(omega) : OMEGA_BINS - 1;
        strands[bin] += groom->gc_strand_count[g];
    }
    int bin = OMEGA_BINS - 1;
    for (; bin > 0 && over + strands[bin] <= groom->info.strand_count / FALLING_SHARE; bin--) {
        over += strands[bin];
    }
    return (float)bin;
}

float suit_style_omega(const awt_groom *groom)
{
    const float segment_m = (float)groom->info.median_strand_m / (float)(groom->info.sections - 1);
    float omega = sqrtf(GRAVITY_M_S2 / (BEND_RAD * (segment_m > 1e-3f ? segment_m : 1e-3f)));
    omega = omega < OMEGA_LEAST ? OMEGA_LEAST : omega > OMEGA_MOST ? OMEGA_MOST : omega;
    const float upright = upright_omega(groom);
    return upright > omega ? upright : omega;
}
