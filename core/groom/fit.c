/* fit.c: the shape of the wisps (AWT §2.1). A finest GC follows the mean of its strands, each measured by its own
 * length; a super-GC is moved to the centre-of-mass curve of its sub-GCs and its radius fitted to contain them.
 *
 * The mean of locks that curl together curls too, faster than sections a segment apart can follow: they would catch
 * the helix at every other side. So the mean is taken four times as densely, and where it is much longer than the
 * way it covers it is smoothed into the axis of the curl before sections are taken from it; the curl is then in the
 * radius and in the strands' offsets. Hair that is merely curved is left as it is. */
#include "groom/draft.h"

#include <string.h>

enum {
    FIT_PER_SEGMENT = 4, /* points of the mean curve */
    FIT_MAX_POINTS = (AWT_MAX_SECTIONS - 1) * FIT_PER_SEGMENT + 1,
    FIT_PASSES = 24 /* of smoothing for a full curl: about one segment to each side */
};

#define LEAST_RADIUS_M 0.0005f
/* strand length over length of the straightened mean: from here on a curl, and from here on a full one */
#define CURL_BEGINS 1.10
#define CURL_FULL 1.35

typedef struct wisp_fit {
    uint32_t point_count;
    dvec3 mean[FIT_MAX_POINTS];
    double strand_length_m; /* mean */
} wisp_fit;

static void average_strands(const groom_draft *build, uint32_t first, uint32_t end, wisp_fit *fit)
{
    polyline line;
    vec3 sample[FIT_MAX_POINTS];
    memset(fit->mean, 0, fit->point_count * sizeof *fit->mean);
    fit->strand_length_m = 0.0;
    for (uint32_t k = first; k < end; k++) {
        draft_measure(build, k, &line);
        polyline_sample(&line, fit->point_count, sample);
        for (uint32_t i = 0; i < fit->point_count; i++) {
            fit->mean[i] = dvec3_add(fit->mean[i], dvec3_of_vec3(sample[i]));
        }
        fit->strand_length_m += polyline_length(&line);
    }
    const double share = 1.0 / (double)(end - first);
    for (uint32_t i = 0; i < fit->point_count; i++) {
        fit->mean[i] = dvec3_scale(fit->mean[i], share);
    }
    fit->strand_length_m *= share;
}

/* One pass of 1 2 1 with the ends held. */
static void smooth_mean(wisp_fit *fit)
{
    dvec3 before = fit->mean[0];
    for (uint32_t i = 1; i + 1 < fit->point_count; i++) {
        dvec3 here = fit->mean[i];
        dvec3 beside = dvec3_scale(dvec3_add(before, fit->mean[i + 1]), 0.25);
        fit->mean[i] = dvec3_mad(beside, here, 0.5);
        before = here;
    }
}

static double mean_length(const wisp_fit *fit)
{
    double length = 0.0;
    for (uint32_t i = 1; i < fit->point_count; i++) {
        length += dvec3_length(dvec3_sub(fit->mean[i], fit->mean[i - 1]));
    }
    return length;
}

/* Smooths the mean into the axis of its curl, as far as it has one. */
static void straighten_curl(wisp_fit *fit)
{
    wisp_fit axis = *fit;
    for (int pass = 0; pass < FIT_PASSES; pass++) {
        smooth_mean(&axis);
    }
    double curl = fit->strand_length_m - CURL_BEGINS * mean_length(&axis);
    double full = (CURL_FULL - CURL_BEGINS) * mean_length(&axis);
    if (curl <= 0.0) {
        return;
    }
    double share = curl < full ? curl / full : 1.0;
    for (uint32_t i = 0; i < fit->point_count; i++) {
        dvec3 way = dvec3_sub(axis.mean[i], fit->mean[i]);
        fit->mean[i] = dvec3_mad(fit->mean[i], way, share);
    }
}

/* Along the curve at a section: the central difference; where points coincide, the direction before. */
static void curve_tangents(const vec3 *centres, uint32_t sections, vec3 *tangents)
{
    vec3 before = {0.0f, -1.0f, 0.0f};
    for (uint32_t i = 0; i < sections; i++) {
        vec3 back = centres[i > 0 ? i - 1 : 0], ahead = centres[i + 1 < sections ? i + 1 : i];
        tangents[i] = vec3_unit(vec3_sub(ahead, back), before);
        before = tangents[i];
    }
}

/* Frames that turn no more than the curve does (rotation-minimising), e_y along it. */
static void curve_frames(const vec3 *tangents, uint32_t sections, quat *frames)
{
    quat frame = quat_identity();
    for (uint32_t i = 0; i < sections; i++) {
        vec3 along = vec3_unit(quat_rotate(frame, vec3_make(0, 1, 0)), vec3_make(0, 1, 0));
        frame = quat_unit(quat_mul(quat_between(along, tangents[i]), frame));
        frames[i] = frame;
    }
}

/* sqrt(2) times the rms distance from the curve, across it: the radius of a disc that is evenly filled. */
static void fit_radii(const groom_draft *build, uint32_t first, uint32_t end, const vec3 *centres, const vec3 *tangents,
                      float *radii)
{
    const uint32_t sections = build->groom->info.sections;
    double squares[AWT_MAX_SECTIONS] = {0};
    polyline line;
    vec3 sample[AWT_MAX_SECTIONS];
    for (uint32_t k = first; k < end; k++) {
        draft_measure(build, k, &line);
        polyline_sample(&line, sections, sample);
        for (uint32_t i = 0; i < sections; i++) {
            dvec3 away = dvec3_of_vec3(vec3_sub(sample[i], centres[i]));
            dvec3 across = dvec3_cross(away, dvec3_of_vec3(tangents[i]));
            squares[i] += dvec3_dot(across, across);
        }
    }
    for (uint32_t i = 0; i < sections; i++) {
        float radius = (float)sqrt(2.0 * squares[i] / (double)(end - first));
        radii[i] = radius > LEAST_RADIUS_M ? radius : LEAST_RADIUS_M;
    }
}

/* Finest GC number `w` of its level. */
static void fit_finest(groom_draft *build, uint32_t w)
{
    awt_groom *groom = build->groom;
    const uint32_t sections = groom->info.sections;
    const uint32_t first = groom->gc_strand_first[w], end = groom->gc_strand_first[w + 1];
    const size_t node = (size_t)(groom_finest_first(groom) + w) * sections;
    vec3 *centres = groom->rest_position + node;
    vec3 tangents[AWT_MAX_SECTIONS];
    wisp_fit fit = {.point_count = (sections - 1) * FIT_PER_SEGMENT + 1};

    average_strands(build, first, end, &fit);
    straighten_curl(&fit);
    for (uint32_t i = 0; i < sections; i++) {
        centres[i] = vec3_of_dvec3(fit.mean[i * FIT_PER_SEGMENT]);
    }
    curve_tangents(centres, sections, tangents);
    curve_frames(tangents, sections, groom->rest_frame + (size_t)w * sections);
    fit_radii(build, first, end, centres, tangents, groom->rest_radius + node);
}

/* Cross-section i of GC g: the centre of mass of the sub-GCs', wide enough to contain them. */
static void fit_super_section(awt_groom *groom, uint32_t g, uint32_t i)
{
    const uint32_t sections = groom->info.sections;
    const uint32_t first = groom->gc_sub_first[g], end = first + groom->gc_sub_count[g];
    dvec3 sum = {0, 0, 0};
    for (uint32_t sub = first; sub < end; sub++) {
        dvec3 place = dvec3_of_vec3(groom->rest_position[(size_t)sub * sections + i]);
        sum = dvec3_mad(sum, place, groom->gc_strand_count[sub]);
    }
    const size_t node = (size_t)g * sections + i;
    const vec3 centre = vec3_of_dvec3(dvec3_scale(sum, 1.0 / (double)groom->gc_strand_count[g]));
    float radius = LEAST_RADIUS_M;
    for (uint32_t sub = first; sub < end; sub++) {
        size_t sub_node = (size_t)sub * sections + i;
        float needed = vec3_distance(centre, groom->rest_position[sub_node]) + groom->rest_radius[sub_node];
        radius = needed > radius ? needed : radius;
    }
    groom->rest_position[node] = centre;
    groom->rest_radius[node] = radius;
}

void fit_wisps(groom_draft *build)
{
    awt_groom *groom = build->groom;
    const uint32_t finest = groom->info.wisp_count[groom->info.levels - 1];
    for (uint32_t w = 0; w < finest; w++) {
        if (w % 64 == 0) {
            draft_report(build, 0.4 + 0.3 * w / finest);
        }
        fit_finest(build, w);
    }
    for (uint32_t g = groom_finest_first(groom); g-- > 0;) {
        for (uint32_t i = 0; i < groom->info.sections; i++) {
            fit_super_section(groom, g, i);
        }
    }
}
