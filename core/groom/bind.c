/* bind.c: each strand attached to its finest GC (AWT §2.2). The search for a point's station begins at the same way
 * from the root, counted in the mean length of the GC's strands, and goes on to the nearest in space, so that a point
 * lies beside its station and not ahead of it; what is longer than the mean hangs on the last station. */
#include "groom/draft.h"

#include "sim/evaluate.h"

enum { BIND_MAX_STATIONS = (AWT_MAX_SECTIONS - 1) * GROOM_TABLE_PER_SEGMENT + 1 };

typedef struct wisp_stations {
    evaluate_station station[BIND_MAX_STATIONS];
    uint32_t count;
    double mean_length_m; /* of the GC's strands: what the last station stands for */
} wisp_stations;

static uint32_t station_at(const wisp_stations *stations, double arc_m)
{
    const uint32_t last = stations->count - 1;
    if (!(arc_m < stations->mean_length_m)) {
        return stations->mean_length_m > 0.0 ? last : 0;
    }
    return (uint32_t)(arc_m / stations->mean_length_m * last + 0.5);
}

/* From station `at` on downhill to the one nearest to `point`: locally, so that a curl that passes by is no match. */
static uint32_t nearest_station(const wisp_stations *stations, uint32_t at, vec3 point)
{
    float here = vec3_distance(point, evaluate_centre(&stations->station[at]));
    for (int step = -1; step <= 1; step += 2) {
        for (;;) {
            uint32_t next = at + (uint32_t)step; /* below 0 it wraps past the end */
            if (next >= stations->count || vec3_distance(point, evaluate_centre(&stations->station[next])) >= here) {
                break;
            }
            at = next;
            here = vec3_distance(point, evaluate_centre(&stations->station[at]));
        }
    }
    return at;
}

/* Binds the points of strand k; returns the largest offset. */
static float bind_strand(groom_draft *build, uint32_t k, const wisp_stations *stations)
{
    awt_groom *groom = build->groom;
    const uint32_t points = groom->info.points_per_strand;
    polyline line;
    vec3 own[AWT_MAX_POINTS_PER_STRAND];
    draft_measure(build, k, &line);
    polyline_resample(&line, points, own);
    polyline_measure(&line, &own[0].x, points);
    float largest = 0.0f;
    for (uint32_t i = 0; i < points; i++) {
        uint32_t at = i > 0 ? nearest_station(stations, station_at(stations, line.arc_m[i]), own[i]) : 0;
        const evaluate_station *station = &stations->station[at];
        vec3 offset = mat3_apply_transposed(evaluate_frame(station), vec3_sub(own[i], evaluate_centre(station)));
        groom->strand_station[(size_t)k * points + i] = (uint16_t)at;
        groom->strand_offset[(size_t)k * points + i] = offset;
        largest = vec3_length(offset) > largest ? vec3_length(offset) : largest;
    }
    return largest;
}

static void measure_strands(groom_draft *build)
{
    polyline line;
    for (uint32_t k = 0; k < build->groom->info.strand_count; k++) {
        draft_measure(build, k, &line);
        build->length_m[k] = polyline_length(&line);
    }
}

static double wisp_length(const vec3 *centres, uint32_t sections)
{
    double length = 0.0;
    for (uint32_t i = 1; i < sections; i++) {
        length += (double)vec3_distance(centres[i], centres[i - 1]);
    }
    return length;
}

static void bind_wisp(groom_draft *build, uint32_t w)
{
    awt_groom *groom = build->groom;
    const uint32_t sections = groom->info.sections;
    const uint32_t first = groom->gc_strand_first[w], end = groom->gc_strand_first[w + 1];
    const vec3 *centres = groom->rest_position + (size_t)(groom_finest_first(groom) + w) * sections;
    wisp_stations stations = {.count = evaluate_station_count(sections, GROOM_TABLE_PER_SEGMENT)};
    evaluate_stations(centres, groom->rest_frame + (size_t)w * sections, sections, GROOM_TABLE_PER_SEGMENT,
                      stations.station);
    for (uint32_t k = first; k < end; k++) {
        stations.mean_length_m += build->length_m[k] / (double)(end - first);
    }
    float largest = 0.0f;
    for (uint32_t k = first; k < end; k++) {
        float offset = bind_strand(build, k, &stations);
        largest = offset > largest ? offset : largest;
    }
    double reach = wisp_length(centres, sections) * DRAFT_STRAIN + (double)largest;
    build->reach_m = reach > build->reach_m ? reach : build->reach_m;
}

void bind_strands(groom_draft *build)
{
    awt_groom *groom = build->groom;
    const uint32_t finest = groom->info.wisp_count[groom->info.levels - 1];
    measure_strands(build);
    for (uint32_t w = 0; w < finest; w++) {
        if (w % 64 == 0) {
            draft_report(build, 0.7 + 0.3 * w / finest);
        }
        bind_wisp(build, w);
    }
}
