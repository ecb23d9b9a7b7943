/* trig.c: range reduction to a quarter turn, then Taylor polynomials; only + - * and floor. */
#include "base/trig.h"

#include <math.h>

void trig_sin_cos(double radians, double *sine, double *cosine)
{
    double quarter = floor(radians * (2.0 / TRIG_PI) + 0.5);
    double r = radians - quarter * (TRIG_PI / 2.0); /* |r| <= pi/4 */
    double r2 = r * r;
    double s =
        r * (1.0 + r2 * (-1.0 / 6.0 +
                         r2 * (1.0 / 120.0 + r2 * (-1.0 / 5040.0 + r2 * (1.0 / 362880.0 + r2 * (-1.0 / 39916800.0))))));
    double c =
        1.0 + r2 * (-0.5 + r2 * (1.0 / 24.0 + r2 * (-1.0 / 720.0 + r2 * (1.0 / 40320.0 + r2 * (-1.0 / 3628800.0)))));
    double turns = quarter - 4.0 * floor(quarter / 4.0);
    if (turns < 0.5) {
        *sine = s, *cosine = c;
    } else if (turns < 1.5) {
        *sine = c, *cosine = -s;
    } else if (turns < 2.5) {
        *sine = -s, *cosine = -c;
    } else {
        *sine = -c, *cosine = s;
    }
}
