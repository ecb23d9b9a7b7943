/* polyline.h: a strand measured along its length, and points taken from it at even distances. */
#ifndef GROOM_POLYLINE_H
#define GROOM_POLYLINE_H

#include "awt.h"
#include "base/vec.h"

typedef struct polyline {
    const float *positions; /* [count][3], not owned */
    uint32_t count;
    double arc_m[AWT_MAX_POINTS_PER_STRAND]; /* from the first point to each */
} polyline;

/* `positions` [count][3] must outlive the polyline; 2 <= count <= AWT_MAX_POINTS_PER_STRAND. */
void polyline_measure(polyline *line, const float *positions, uint32_t count);

static inline double polyline_length(const polyline *line)
{
    return line->arc_m[line->count - 1];
}

/* `count` >= 2 points, evenly by arc length; the first and the last are the polyline's own, to the bit. A polyline
 * without length is sampled evenly by its points. */
void polyline_sample(const polyline *line, uint32_t count, vec3 *out);

/* As polyline_sample, but a polyline that has `count` points gives its own, to the bit. */
void polyline_resample(const polyline *line, uint32_t count, vec3 *out);

#endif
