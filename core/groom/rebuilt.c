/* rebuilt.c: how far the strands that come out of the groom at rest are from those that went in. Measured through the
 * way that every reader takes, awt_groom_strands on guides at rest, so that it holds whatever binding does.
 *
 * A strand of as many points as come out must come back point for point. Of another the points lie elsewhere along the
 * same way: there the distance of each of its points from the rebuilt way is measured, from pieces near the same share
 * of the length, which never makes it less than it is. */
#include "groom/draft.h"

enum { REBUILT_NEAR = 2 }; /* pieces of the rebuilt way to either side that a point is compared with */

typedef struct rebuilt_sum {
    double max_m, sum_m;
    uint64_t count;
} rebuilt_sum;

static void add_distance(rebuilt_sum *sum, double distance_m)
{
    sum->max_m = distance_m > sum->max_m ? distance_m : sum->max_m;
    sum->sum_m += distance_m;
    sum->count++;
}

static dvec3 point_of(const float *positions, uint32_t index)
{
    const float *p = positions + 3 * (size_t)index;
    return dvec3_of_vec3(vec3_make(p[0], p[1], p[2]));
}

/* From a point to the piece a to b. */
static double piece_distance(dvec3 point, dvec3 a, dvec3 b)
{
    const dvec3 along = dvec3_sub(b, a), from = dvec3_sub(point, a);
    const double square = dvec3_dot(along, along), way = dvec3_dot(from, along);
    const double share = !(way > 0.0) ? 0.0 : way < square ? way / square : 1.0;
    return dvec3_length(dvec3_sub(from, dvec3_scale(along, share)));
}

static void compare_points(const polyline *line, const float *rebuilt, rebuilt_sum *sum)
{
    for (uint32_t i = 0; i < line->count; i++) {
        add_distance(sum, dvec3_length(dvec3_sub(point_of(rebuilt, i), point_of(line->positions, i))));
    }
}

static void compare_way(const polyline *line, const float *rebuilt, uint32_t points, rebuilt_sum *sum)
{
    const uint32_t pieces = points - 1;
    const double length_m = polyline_length(line);
    for (uint32_t i = 0; i < line->count; i++) {
        const dvec3 point = point_of(line->positions, i);
        const double share = length_m > 0.0 ? line->arc_m[i] / length_m : (double)i / (double)(line->count - 1);
        const uint32_t at = (uint32_t)(share * pieces);
        const uint32_t first = at > REBUILT_NEAR ? at - REBUILT_NEAR : 0;
        const uint32_t end = at + REBUILT_NEAR + 1 < pieces ? at + REBUILT_NEAR + 1 : pieces;
        double least = -1.0;
        for (uint32_t piece = first; piece < end; piece++) {
            double distance = piece_distance(point, point_of(rebuilt, piece), point_of(rebuilt, piece + 1));
            least = least < 0.0 || distance < least ? distance : least;
        }
        add_distance(sum, least);
    }
}

void measure_rebuilt(groom_draft *build)
{
    awt_groom *groom = build->groom;
    const uint32_t points = groom->info.points_per_strand;
    const size_t node = (size_t)groom_finest_first(groom) * groom->info.sections;
    rebuilt_sum sum = {0};
    polyline line;
    draft_report(build, 1.0);
    awt_groom_strands(groom, &groom->rest_position[node].x, &groom->rest_frame[0].x, build->strand_scratch,
                      build->rebuilt);
    for (uint32_t k = 0; k < groom->info.strand_count; k++) {
        const float *rebuilt = build->rebuilt + 3 * (size_t)k * points;
        draft_measure(build, k, &line);
        if (line.count == points) {
            compare_points(&line, rebuilt, &sum);
        } else {
            compare_way(&line, rebuilt, points, &sum);
        }
    }
    groom->rebuilt = (awt_rebuilt){.known = true, .max_m = sum.max_m, .mean_m = sum.sum_m / (double)sum.count};
}

awt_rebuilt awt_groom_rebuilt(const awt_groom *groom)
{
    return groom->rebuilt;
}
