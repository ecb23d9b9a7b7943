/* wind.c: see wind.h. Phases are doubles, in turns, reduced before they become angles; time is reduced as an integer.
 */
#include "sim/wind.h"

#include "base/trig.h"

/* Periods in gust_period: 1, the golden section, the root of 3. The amplitudes add up to 1. */
static const struct {
    double period, amplitude;
} waves[WIND_WAVES] = {{1.0, 0.5}, {0.6180339887498949, 0.3}, {1.7320508075688772, 0.2}};

/* 0 where there is no telling: a place beyond all sense among ripples shorter than it can be told by. */
static double fraction(double turns)
{
    double part = turns - floor(turns);
    return part >= 0.0 && part <= 1.0 ? part : 0.0;
}

/* Of the time in a period, 0 .. 1: exact microseconds, however many periods have gone. */
static double time_phase(int64_t time_us, int64_t period_us)
{
    int64_t since = time_us % period_us;
    return (double)(since < 0 ? since + period_us : since) / (double)period_us;
}

wind_field wind_blow(const awt_params *p, int64_t time_us, dvec3 head)
{
    wind_field w = {.mean = {p->wind_x, p->wind_y, p->wind_z}, .share = (double)p->wind_gust};
    dvec3 mean = dvec3_of_vec3(w.mean);
    double speed = dvec3_length(mean);
    w.gusts = p->wind_gust > 0.0f && p->drag > 0.0f && speed > 0.0;
    if (!w.gusts) {
        return w;
    }
    w.along = dvec3_scale(mean, 1.0 / speed);
    for (int k = 0; k < WIND_WAVES; k++) {
        double period_us = floor((double)p->gust_period * 1e6 * waves[k].period + 0.5);
        w.per_m[k] = 1.0 / (speed * period_us * 1e-6);
        w.phase[k] = fraction(time_phase(time_us, (int64_t)period_us) - dvec3_dot(w.along, head) * w.per_m[k]);
    }
    return w;
}

float wind_gust_at(const wind_field *w, vec3 place)
{
    if (!w->gusts) {
        return 0.0f;
    }
    double metres = dvec3_dot(w->along, dvec3_of_vec3(place)), sum = 0.0;
    for (int k = 0; k < WIND_WAVES; k++) {
        double sine, cosine;
        trig_sin_cos(2.0 * TRIG_PI * fraction(w->phase[k] - metres * w->per_m[k]), &sine, &cosine);
        sum += waves[k].amplitude * sine;
    }
    return (float)(w->share * sum);
}
