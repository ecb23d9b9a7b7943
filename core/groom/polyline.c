/* polyline.c: see polyline.h. Lengths are summed in double, so that 256 short pieces lose nothing. */
#include "groom/polyline.h"

static vec3 point_at(const polyline *line, uint32_t index)
{
    const float *p = line->positions + 3 * (size_t)index;
    return vec3_make(p[0], p[1], p[2]);
}

void polyline_measure(polyline *line, const float *positions, uint32_t count)
{
    line->positions = positions;
    line->count = count;
    line->arc_m[0] = 0.0;
    for (uint32_t i = 1; i < count; i++) {
        dvec3 step = dvec3_sub(dvec3_of_vec3(point_at(line, i)), dvec3_of_vec3(point_at(line, i - 1)));
        line->arc_m[i] = line->arc_m[i - 1] + dvec3_length(step);
    }
}

/* The point `share` of the way along piece `piece`. */
static vec3 piece_at(const polyline *line, uint32_t piece, double share)
{
    dvec3 a = dvec3_of_vec3(point_at(line, piece)), b = dvec3_of_vec3(point_at(line, piece + 1));
    return vec3_of_dvec3(dvec3_mad(a, dvec3_sub(b, a), share));
}

static void sample_by_index(const polyline *line, uint32_t count, vec3 *out)
{
    for (uint32_t i = 0; i + 1 < count; i++) {
        double place = (double)i * (double)(line->count - 1) / (double)(count - 1);
        uint32_t piece = (uint32_t)place;
        out[i] = piece_at(line, piece, place - (double)piece);
    }
}

static void sample_by_arc(const polyline *line, uint32_t count, vec3 *out)
{
    uint32_t piece = 0;
    for (uint32_t i = 0; i + 1 < count; i++) {
        double arc = polyline_length(line) * (double)i / (double)(count - 1);
        while (piece + 2 < line->count && line->arc_m[piece + 1] <= arc) {
            piece++;
        }
        double length = line->arc_m[piece + 1] - line->arc_m[piece];
        double share = length > 0.0 ? (arc - line->arc_m[piece]) / length : 0.0;
        out[i] = piece_at(line, piece, share < 1.0 ? share : 1.0);
    }
}

void polyline_sample(const polyline *line, uint32_t count, vec3 *out)
{
    if (polyline_length(line) > 0.0) {
        sample_by_arc(line, count, out);
    } else {
        sample_by_index(line, count, out);
    }
    out[0] = point_at(line, 0);
    out[count - 1] = point_at(line, line->count - 1);
}

void polyline_resample(const polyline *line, uint32_t count, vec3 *out)
{
    if (line->count != count) {
        polyline_sample(line, count, out);
        return;
    }
    for (uint32_t i = 0; i < count; i++) {
        out[i] = point_at(line, i);
    }
}
