/* topology.c: see topology.h. */
#include "geom/topology.h"

static uint16_t *put_ribbon(uint32_t first_point, uint32_t points, uint16_t *out)
{
    for (uint32_t i = 0; i + 1 < points; i++) {
        uint32_t left = (first_point + i) * 2;
        /* steps of +1 and -1 only, which Draco's index coder likes best */
        *out++ = (uint16_t)left;
        *out++ = (uint16_t)(left + 1);
        *out++ = (uint16_t)(left + 2);
        *out++ = (uint16_t)(left + 3);
        *out++ = (uint16_t)(left + 2);
        *out++ = (uint16_t)(left + 1);
    }
    return out;
}

static uint16_t *put_line(uint32_t first_point, uint32_t points, uint16_t *out)
{
    for (uint32_t i = 0; i < (points + 2) / 3 * 3; i++) {
        *out++ = (uint16_t)(first_point + (i < points ? i : points - 1));
    }
    return out;
}

void topology_indices(geom_kind kind, uint32_t strands, uint32_t points_per_strand, uint16_t *out)
{
    for (uint32_t s = 0; s < strands; s++) {
        uint32_t first = s * points_per_strand;
        out = kind == GEOM_RIBBON ? put_ribbon(first, points_per_strand, out) : put_line(first, points_per_strand, out);
    }
}
