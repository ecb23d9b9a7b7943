/* bind.c: each strand attached to its finest GC (AWT §2.2), point by point: point i at station i, each at the same
 * share of the way from root to tip. */
#include "groom/draft.h"

#include "sim/evaluate.h"

/* Binds the points of strand k to the stations of its GC; returns the largest offset. */
static float bind_strand(groom_draft *build, uint32_t k, const evaluate_table *stations)
{
    const uint32_t points = build->groom->info.points_per_strand;
    float *offset = build->groom->strand_offset + (size_t)k * 3 * points;
    polyline line;
    vec3 own[AWT_MAX_POINTS_PER_STRAND];
    draft_measure(build, k, &line);
    build->length_m[k] = polyline_length(&line);
    polyline_resample(&line, points, own);
    float largest = 0.0f;
    for (uint32_t i = 0; i < points; i++) {
        vec3 away = vec3_sub(own[i], evaluate_centre(stations, i));
        vec3 here = mat3_apply_transposed(evaluate_frame(stations, i), away);
        offset[i] = here.x, offset[points + i] = here.y, offset[2 * points + i] = here.z;
        largest = vec3_length(here) > largest ? vec3_length(here) : largest;
    }
    return largest;
}

static double wisp_length(const vec3 *centres, uint32_t sections)
{
    double length = 0.0;
    for (uint32_t i = 1; i < sections; i++) {
        length += (double)vec3_distance(centres[i], centres[i - 1]);
    }
    return length;
}

/* Binds the strands of finest GC `w`; takes the GC's length and the largest offset into `length_m` and `largest_m`. */
static void bind_wisp(groom_draft *build, uint32_t w, evaluate_table *stations, double *length_m, float *largest_m)
{
    awt_groom *groom = build->groom;
    const uint32_t sections = groom->info.sections;
    const vec3 *centres = groom->rest_position + (size_t)(groom_finest_first(groom) + w) * sections;
    evaluate_stations(stations, centres, groom->rest_frame + (size_t)w * sections);
    for (uint32_t k = groom->gc_strand_first[w]; k < groom->gc_strand_first[w + 1]; k++) {
        float offset = bind_strand(build, k, stations);
        *largest_m = offset > *largest_m ? offset : *largest_m;
    }
    double length = wisp_length(centres, sections);
    *length_m = length > *length_m ? length : *length_m;
}

void bind_strands(groom_draft *build)
{
    awt_groom *groom = build->groom;
    const uint32_t finest = groom->info.wisp_count[groom->info.levels - 1];
    evaluate_table stations;
    arena memory = arena_over(build->strand_scratch, awt_groom_strand_scratch(groom) * sizeof(float));
    evaluate_lay_out(&stations, &memory, groom->info.sections, groom->info.points_per_strand);
    double length_m = 0.0;
    float largest_m = 0.0f;
    for (uint32_t w = 0; w < finest; w++) {
        if (w % 64 == 0) {
            draft_report(build, 0.7 + 0.3 * w / finest);
        }
        bind_wisp(build, w, &stations, &length_m, &largest_m);
    }
    /* a merged wisp goes where its super-wisp does: any length may meet any offset */
    build->reach_m = length_m * DRAFT_STRAIN + (double)largest_m;
    /* hair without length turns about its root with all that its top-level wisp is wide */
    float widest_m = 0.0f;
    for (uint32_t g = 0; g < groom->info.wisp_count[0]; g++) {
        float radius = groom->rest_radius[(size_t)g * groom->info.sections];
        widest_m = radius > widest_m ? radius : widest_m;
    }
    double turning_m = 2.0 * ((double)widest_m + (double)largest_m);
    build->reach_m = turning_m > build->reach_m ? turning_m : build->reach_m;
}
