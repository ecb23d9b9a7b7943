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

typedef struct evaluate_station {
    vec3 centre;
    mat3 frame; /* station's frame to head frame, y along the wisp */
} evaluate_station;

/* Stations of a GC of `sections` sections. */
static inline uint32_t evaluate_station_count(uint32_t sections, uint32_t per_segment)
{
    return (sections - 1) * per_segment + 1;
}

/* Fills evaluate_station_count stations of one GC from its section centres and frames, [sections] each. */
void evaluate_stations(const vec3 *centres, const quat *frames, uint32_t sections, uint32_t per_segment,
                       evaluate_station *out);

/* points[i] = the station's point + its frame times offsets[i]. */
void evaluate_points(const evaluate_station *stations, const uint16_t *station, const vec3 *offsets, uint32_t count,
                     vec3 *points);

#endif
