/* trig.h: sine and cosine by our own polynomials, because libm's last bit differs between builds. */
#ifndef BASE_TRIG_H
#define BASE_TRIG_H

#define TRIG_PI 3.14159265358979323846

/* Within 1e-9 of the true values for |radians| < 1e6. */
void trig_sin_cos(double radians, double *sine, double *cosine);

#endif
