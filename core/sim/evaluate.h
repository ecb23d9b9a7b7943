/* evaluate.h: strands from the finest nodes (AWT §2.2: each strand is attached to one of the finest GCs).
 *
 * Along each finest GC stand stations, GROOM_TABLE_PER_SEGMENT to a segment: a point of the smooth curve through the
 * section centres and a frame blended between the sections' frames. A strand point is its station's point plus a
 * constant offset in its station's frame, so at rest the strands are the groom's own, exactly, and they move rigidly
 * with the wisp around them (§3.3). The client library evaluates with this same code. */
#ifndef SIM_EVALUATE_H
#define SIM_EVALUATE_H

#include "base/vec.h"
#include <stdint.h>

/* Four columns of four floats, so that a point is four operations on whole columns; the fourth floats are 0. */
typedef struct evaluate_station {
    float x[4], y[4], z[4]; /* station's frame to head frame, y along the wisp */
    float centre[4];
} evaluate_station;

static inline vec3 evaluate_centre(const evaluate_station *s)
{
    return (vec3){s->centre[0], s->centre[1], s->centre[2]};
}

static inline mat3 evaluate_frame(const evaluate_station *s)
{
    return (mat3){{s->x[0], s->x[1], s->x[2]}, {s->y[0], s->y[1], s->y[2]}, {s->z[0], s->z[1], s->z[2]}};
}

/* Stations of a GC of `sections` sections. */
static inline uint32_t evaluate_station_count(uint32_t sections, uint32_t per_segment)
{
    return (sections - 1) * per_segment + 1;
}

/* Fills evaluate_station_count stations of one GC from its section centres and frames, [sections] each;
 * 2 <= sections <= AWT_MAX_SECTIONS. */
void evaluate_stations(const vec3 *centres, const quat *frames, uint32_t sections, uint32_t per_segment,
                       evaluate_station *out);

/* points[i] = the station's point + its frame times offsets[i]. */
void evaluate_points(const evaluate_station *restrict stations, const uint16_t *restrict station,
                     const vec3 *restrict offsets, uint32_t count, float *restrict points);

#endif
