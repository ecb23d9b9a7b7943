/* plan.c: see plan.h. */
#include "groom/plan.h"

#include "base/error.h"
#include "base/vec.h"

/* Hair farther from the head than this was not brought into metres; below it no square overflows. */
#define FARTHEST_POINT_M 1000.0f

/* Segments of about this length, where the caller does not say: shorter ones bend at less than a wisp's own width,
 * which tears at the strands on its rim. */
#define CHOSEN_SEGMENT_M 0.02

enum {
    CHOSEN_SECTIONS_LEAST = 5,
    CHOSEN_SECTIONS_MOST = 16,
    CHOSEN_STRANDS_PER_WISP = 8,
    CHOSEN_FINEST_NODES = 6000 /* the paper's grooms have 4,909 to 9,853 (§5.2) */
};

/* Finest wisps to a top one, by the number of levels, where the caller does not say. */
static const uint32_t chosen_finest_per_top[AWT_MAX_LEVELS + 1] = {1, 1, 6, 7, 20};

static awt_status check_layout(const awt_strands *strands, awt_error *error)
{
    if (strands->strand_count == 0) {
        return error_set(error, AWT_NO_STRANDS, NULL);
    }
    if (strands->strand_count > AWT_MAX_STRANDS || strands->point_count > AWT_MAX_POINTS) {
        return error_set(error, AWT_LIMIT, "%lu strands with %lu points; the limits are %d and %d",
                         (unsigned long)strands->strand_count, (unsigned long)strands->point_count, AWT_MAX_STRANDS,
                         AWT_MAX_POINTS);
    }
    for (uint32_t s = 0; s < strands->strand_count; s++) {
        uint32_t first = strands->first_point[s], end = strands->first_point[s + 1];
        if (end > strands->point_count || first > end || end - first < 2 || end - first > AWT_MAX_POINTS_PER_STRAND) {
            return error_set(error, AWT_BAD_VALUE, "strand %lu does not have 2 to %d points", (unsigned long)s,
                             AWT_MAX_POINTS_PER_STRAND);
        }
    }
    return AWT_OK;
}

static awt_status check_positions(const awt_strands *strands, awt_error *error)
{
    for (uint32_t s = 0; s < strands->strand_count; s++) {
        const float *p = strands->positions + 3 * (size_t)strands->first_point[s];
        size_t numbers = 3 * (size_t)(strands->first_point[s + 1] - strands->first_point[s]);
        for (size_t i = 0; i < numbers; i++) {
            if (!(fabsf(p[i]) <= FARTHEST_POINT_M)) {
                return error_set(error, AWT_BAD_VALUE,
                                 "point %lu of strand %lu is not a number or more than %g m from the head",
                                 (unsigned long)(i / 3), (unsigned long)s, (double)FARTHEST_POINT_M);
            }
        }
    }
    return AWT_OK;
}

static awt_status check_levels(uint32_t levels, awt_error *error)
{
    if (levels < 1 || levels > AWT_MAX_LEVELS) {
        return error_set(error, AWT_BAD_VALUE, "%lu levels; a groom has 1 to %d", (unsigned long)levels,
                         AWT_MAX_LEVELS);
    }
    return AWT_OK;
}

/* What says how many wisps there are to be. */
static awt_status check_wisps(const awt_groom_def *def, awt_error *error)
{
    if (def->hierarchy) {
        return check_levels(def->hierarchy->levels, error);
    }
    if (def->finest_wisps != 0 && def->top_wisps > def->finest_wisps) {
        return error_set(error, AWT_BAD_VALUE, "%lu top wisps cannot be refined into %lu finest wisps",
                         (unsigned long)def->top_wisps, (unsigned long)def->finest_wisps);
    }
    return check_levels(def->levels, error);
}

static awt_status check_def(const awt_groom_def *def, awt_error *error)
{
    if (def->sections != 0 && (def->sections < 2 || def->sections > AWT_MAX_SECTIONS)) {
        return error_set(error, AWT_BAD_VALUE, "%lu sections; a wisp has 2 to %d, or 0 for a fitting number",
                         (unsigned long)def->sections, AWT_MAX_SECTIONS);
    }
    if (def->points_per_strand == 1 || def->points_per_strand > AWT_MAX_POINTS_PER_STRAND) {
        return error_set(error, AWT_BAD_VALUE, "%lu points per strand; a strand has 2 to %d, or 0 for the file's own",
                         (unsigned long)def->points_per_strand, AWT_MAX_POINTS_PER_STRAND);
    }
    if (!(def->head_radius_m > 0.0 && def->head_radius_m <= (double)FARTHEST_POINT_M)) {
        return error_set(error, AWT_BAD_VALUE, "a head of radius %g m; it must be more than 0", def->head_radius_m);
    }
    return check_wisps(def, error);
}

static uint32_t at_least_one(uint32_t value)
{
    return value > 0 ? value : 1;
}

static uint32_t largest_point_count(const awt_strands *strands)
{
    uint32_t largest = 0;
    for (uint32_t s = 0; s < strands->strand_count; s++) {
        uint32_t count = strands->first_point[s + 1] - strands->first_point[s];
        largest = count > largest ? count : largest;
    }
    return largest;
}

static double mean_length_m(const awt_strands *strands)
{
    double sum = 0.0;
    for (uint32_t s = 0; s < strands->strand_count; s++) {
        for (uint32_t i = strands->first_point[s] + 1; i < strands->first_point[s + 1]; i++) {
            const float *a = strands->positions + 3 * (size_t)(i - 1), *b = a + 3;
            sum += (double)vec3_distance(vec3_make(a[0], a[1], a[2]), vec3_make(b[0], b[1], b[2]));
        }
    }
    return sum / (double)strands->strand_count;
}

static uint32_t choose_sections(const awt_strands *strands)
{
    double sections = 1.5 + mean_length_m(strands) / CHOSEN_SEGMENT_M; /* to the nearest */
    return sections < CHOSEN_SECTIONS_LEAST  ? CHOSEN_SECTIONS_LEAST
           : sections > CHOSEN_SECTIONS_MOST ? CHOSEN_SECTIONS_MOST
                                             : (uint32_t)sections;
}

static uint64_t power(uint64_t base, uint32_t exponent)
{
    return exponent == 0 ? 1 : base * power(base, exponent - 1);
}

/* The level below one of `above` wisps, `refinements` steps from the finest: equal factors, rounded down. In whole
 * numbers (at most 200,000 to the third), because cube roots differ between libraries. */
static uint32_t refine_count(uint32_t above, uint32_t finest, uint32_t refinements)
{
    const uint64_t most = power(above, refinements - 1) * finest;
    uint32_t count = above;
    while (power((uint64_t)count + 1, refinements) <= most) {
        count++;
    }
    return count;
}

void plan_choose_wisps(const awt_groom_def *def, groom_plan *plan)
{
    plan->levels = def->levels;
    uint32_t by_strands = plan->strand_count / CHOSEN_STRANDS_PER_WISP;
    uint32_t by_nodes = CHOSEN_FINEST_NODES / plan->sections;
    uint32_t chosen = at_least_one(by_strands < by_nodes ? by_strands : by_nodes);
    uint32_t finest = def->finest_wisps ? def->finest_wisps : chosen;
    finest = finest < plan->strand_count ? finest : plan->strand_count;
    uint32_t top = def->top_wisps ? def->top_wisps : at_least_one(finest / chosen_finest_per_top[plan->levels]);
    plan->wisp_count[0] = top < finest && plan->levels > 1 ? top : finest;
    for (uint32_t level = 1; level < plan->levels; level++) {
        plan->wisp_count[level] = refine_count(plan->wisp_count[level - 1], finest, plan->levels - level);
    }
}

awt_status plan_check_sizes(const groom_plan *plan, awt_error *error)
{
    uint64_t points = (uint64_t)plan->strand_count * plan->points_per_strand;
    if (points > AWT_MAX_POINTS) {
        return error_set(error, AWT_LIMIT, "%lu strands of %lu points each; the limit is %d points in all",
                         (unsigned long)plan->strand_count, (unsigned long)plan->points_per_strand, AWT_MAX_POINTS);
    }
    uint64_t nodes = (uint64_t)plan->wisp_count[plan->levels - 1] * plan->sections;
    if (nodes > AWT_MAX_NODES) {
        return error_set(error, AWT_LIMIT, "%lu wisps of %lu sections each; the limit is %d nodes in all",
                         (unsigned long)plan->wisp_count[plan->levels - 1], (unsigned long)plan->sections,
                         AWT_MAX_NODES);
    }
    return AWT_OK;
}

awt_status plan_make(const awt_strands *strands, const awt_groom_def *def, groom_plan *out, awt_error *error)
{
    awt_status status = check_def(def, error);
    if (status == AWT_OK) {
        status = check_layout(strands, error);
    }
    if (status == AWT_OK) {
        status = check_positions(strands, error);
    }
    if (status != AWT_OK) {
        return status;
    }
    groom_plan plan = {.strand_count = strands->strand_count};
    uint32_t largest = largest_point_count(strands);
    plan.points_per_strand = def->points_per_strand ? def->points_per_strand : largest;
    plan.sections = def->sections ? def->sections : choose_sections(strands);
    plan.head_radius_m = def->head_radius_m;
    *out = plan;
    return AWT_OK;
}
