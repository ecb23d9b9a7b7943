/* wind.h: the air about the head: the wind of the parameters, and gusts that travel with it.
 *
 * A gust is a share of the wind, more or less of it in the same direction: a sum of sines of the time and of the place
 * in the world, carried along by the wind (what blows here blows |wind| metres farther on a second later). Their
 * periods have no common multiple to speak of, so that it never seems to repeat, and the mean over time is the wind. */
#ifndef SIM_WIND_H
#define SIM_WIND_H

#include "awt.h"
#include "base/vec.h"

enum { WIND_WAVES = 3 };

/* Of one sub-step: it follows from parameters, time and the head's place, and is no state. */
typedef struct wind_field {
    vec3 mean; /* m/s, world axes */
    bool gusts;
    double share; /* greatest gust, as a share of the mean */
    dvec3 along;  /* unit; world axes */
    /* of each wave, in turns: its phase at the head's centre, 0 .. 1, and how much it falls behind in each metre */
    double phase[WIND_WAVES], per_m[WIND_WAVES];
} wind_field;

/* The air at time_us about a head at `head` (m, world). Keeps its precision whatever the time and the place. */
wind_field wind_blow(const awt_params *p, int64_t time_us, dvec3 head);

/* How much more than the mean blows at `place` (m, from the head's centre, world axes), as a share of it: within
 * +-share; 0 without gusts. */
float wind_gust_at(const wind_field *w, vec3 place);

/* m/s, world axes, relative to the head's own motion. */
static inline vec3 wind_at(const wind_field *w, vec3 place)
{
    return vec3_mad(w->mean, w->mean, wind_gust_at(w, place));
}

#endif
