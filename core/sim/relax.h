/* relax.h: first-order relaxation in time. */
#ifndef SIM_RELAX_H
#define SIM_RELAX_H

/* Share of the way that a first-order relaxation of time constant tau goes in dt (implicit: never overshoots). */
static inline float relaxation_share(float dt_s, float tau_s)
{
    return dt_s / (tau_s + dt_s);
}

#endif
