/* evaluate.c: see evaluate.h.
 *
 * evaluate_points is where the time goes: 160,000 points a frame. Its columns of four floats are loops of fixed length
 * that compilers turn into vector operations, in the order that a scalar mat3_apply has: the bits are the same. */
#include "sim/evaluate.h"

#include "groom/groom.h"

#include <string.h>

/* Catmull-Rom through b and c at t in [0, 1]. */
static vec3 curve_at(vec3 a, vec3 b, vec3 c, vec3 d, float t)
{
    float t2 = t * t, t3 = t2 * t;
    float wa = 0.5f * (-t3 + 2.0f * t2 - t), wb = 0.5f * (3.0f * t3 - 5.0f * t2 + 2.0f);
    float wc = 0.5f * (-3.0f * t3 + 4.0f * t2 + t), wd = 0.5f * (t3 - t2);
    return vec3_mad(vec3_mad(vec3_mad(vec3_scale(a, wa), b, wb), c, wc), d, wd);
}

static evaluate_station station_of(vec3 centre, quat frame)
{
    mat3 m = mat3_of_quat(frame);
    return (evaluate_station){{m.x.x, m.x.y, m.x.z, 0},
                              {m.y.x, m.y.y, m.y.z, 0},
                              {m.z.x, m.z.y, m.z.z, 0},
                              {centre.x, centre.y, centre.z, 0}};
}

void evaluate_stations(const vec3 *centres, const quat *frames, uint32_t sections, uint32_t per_segment,
                       evaluate_station *out)
{
    for (uint32_t i = 0; i + 1 < sections; i++) {
        vec3 b = centres[i], c = centres[i + 1];
        /* beyond the ends the curve goes on straight */
        vec3 a = i > 0 ? centres[i - 1] : vec3_sub(vec3_add(b, b), c);
        vec3 d = i + 2 < sections ? centres[i + 2] : vec3_sub(vec3_add(c, c), b);
        *out++ = station_of(b, frames[i]);
        for (uint32_t k = 1; k < per_segment; k++) {
            float t = (float)k / (float)per_segment;
            *out++ = station_of(curve_at(a, b, c, d, t), quat_blend(frames[i], frames[i + 1], t));
        }
    }
    *out = station_of(centres[sections - 1], frames[sections - 1]);
}

/* One point: three floats and a fourth that means nothing. */
static inline void point_of(const evaluate_station *s, vec3 offset, float point[4])
{
    for (int axis = 0; axis < 4; axis++) {
        point[axis] = s->centre[axis] + (s->x[axis] * offset.x + s->y[axis] * offset.y + s->z[axis] * offset.z);
    }
}

void evaluate_points(const evaluate_station *restrict stations, const uint16_t *restrict station,
                     const vec3 *restrict offsets, uint32_t count, float *restrict points)
{
    float point[4];
    uint32_t i = 0;
    for (; i + 1 < count; i++, points += 3) { /* the next point goes over the fourth float */
        point_of(&stations[station[i]], offsets[i], point);
        memcpy(points, point, sizeof point);
    }
    if (i < count) {
        point_of(&stations[station[i]], offsets[i], point);
        memcpy(points, point, 3 * sizeof *point);
    }
}

size_t awt_groom_strand_scratch(const awt_groom *groom)
{
    uint32_t stations = evaluate_station_count(groom->info.sections, GROOM_TABLE_PER_SEGMENT);
    return stations * sizeof(evaluate_station) / sizeof(float);
}

void awt_groom_strands(const awt_groom *groom, const float *centres, const float *frames, float *scratch, float *points)
{
    const uint32_t sections = groom->info.sections;
    const uint32_t per_strand = groom->info.points_per_strand;
    const uint32_t finest = groom->info.wisp_count[groom->info.levels - 1];
    const vec3 *centre = (const vec3 *)(const void *)centres;
    const quat *frame = (const quat *)(const void *)frames;
    evaluate_station *stations = (evaluate_station *)(void *)scratch;
    for (uint32_t g = 0; g < finest; g++) {
        size_t first = (size_t)groom->gc_strand_first[g] * per_strand;
        uint32_t count = (groom->gc_strand_first[g + 1] - groom->gc_strand_first[g]) * per_strand;
        evaluate_stations(centre + (size_t)g * sections, frame + (size_t)g * sections, sections,
                          GROOM_TABLE_PER_SEGMENT, stations);
        evaluate_points(stations, groom->strand_station + first, groom->strand_offset + first, count,
                        points + 3 * first);
    }
}
