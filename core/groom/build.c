/* build.c: awt_groom_build, stage by stage. The sizes are planned first, so that all memory is taken before the work
 * begins and no stage can fail: one arena for the groom, one for the scratch of the build. */
#include "groom/draft.h"

#include <stdlib.h>
#include <string.h>
#include "base/error.h"
#include "groom/pack.h"
#include "groom/plan.h"
#include "sim/evaluate.h"

#define COARSE_NODE_KG 0.001 /* AWT §5: about 1 g a coarse node, 0.5 to 2 kg a head */

awt_groom_def awt_groom_def_default(void)
{
    return (awt_groom_def){.levels = 3, .head_radius_m = AWT_HEAD_RADIUS_M};
}

awt_groom_def awt_groom_def_of_style(const awt_style *style)
{
    return (awt_groom_def){.levels = style->levels,
                           .sections = style->sections,
                           .finest_wisps = style->finest_wisps,
                           .top_wisps = style->top_wisps,
                           .points_per_strand = style->points_per_strand,
                           .head_radius_m = AWT_HEAD_RADIUS_M};
}

/* What the stages report and the share of the time that has passed then: on 50,000 strands of the built-in styles and
 * on the film head of the real data, about. DRAFT_DONE ends the last stage. */
#define DRAFT_DONE 1.1
static const struct {
    double stage, share;
} report_times[] = {{0.0, 0.0}, {0.1, 0.05}, {0.2, 0.40}, {0.4, 0.50}, {0.7, 0.60}, {1.0, 0.90}, {DRAFT_DONE, 1.0}};

void draft_report(const groom_draft *build, double stage)
{
    size_t i = 1;
    if (!build->progress) {
        return;
    }
    while (stage > report_times[i].stage) {
        i++;
    }
    const double from = report_times[i - 1].stage, before = report_times[i - 1].share;
    const double way = (stage - from) / (report_times[i].stage - from);
    build->progress(build->context, before + way * (report_times[i].share - before));
}

static void lay_out_scratch(groom_draft *build, arena *memory)
{
    const size_t strands = build->groom->info.strand_count;
    build->features = ARENA_PUSH(memory, float, strands *CLUSTER_FEATURES);
    build->clusters.features = build->features;
    build->clusters.order = ARENA_PUSH(memory, uint32_t, strands);
    build->clusters.part = ARENA_PUSH(memory, uint32_t, strands);
    build->clusters.moved = ARENA_PUSH(memory, uint32_t, strands);
    build->clusters.nearest = ARENA_PUSH(memory, double, strands);
    build->gc_first = ARENA_PUSH(memory, uint32_t, build->groom->gc_count);
    build->length_m = ARENA_PUSH(memory, double, strands);
    build->strand_scratch = ARENA_PUSH(memory, float, awt_groom_strand_scratch(build->groom));
    build->rebuilt = ARENA_PUSH(memory, float, 3 * strands * build->groom->info.points_per_strand);
}

static bool take_memory(groom_draft *build)
{
    if (!groom_take_memory(build->groom)) {
        return false;
    }
    arena counting = arena_counting();
    lay_out_scratch(build, &counting);
    if (counting.overflowed || !arena_init(&build->memory, counting.used)) {
        return false;
    }
    lay_out_scratch(build, &build->memory);
    return true;
}

/* The least power of two that gives the whole hair COARSE_NODE_KG a coarse node or more. */
static void choose_mass_unit(awt_groom *groom)
{
    const double section_strands = (double)groom->info.strand_count * groom->info.sections;
    const double wanted = COARSE_NODE_KG * groom->info.coarse_nodes / section_strands;
    double unit = 1.0;
    while (0.5 * unit >= wanted) {
        unit *= 0.5;
    }
    groom->mass_unit_kg = (float)unit;
    groom->info.mass_kg = section_strands * unit;
}

static int compare_lengths(const void *a, const void *b)
{
    double x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return (x > y) - (x < y);
}

static void describe_lengths(groom_draft *build)
{
    awt_groom_info *info = &build->groom->info;
    qsort(build->length_m, info->strand_count, sizeof *build->length_m, compare_lengths);
    info->longest_strand_m = build->length_m[info->strand_count - 1];
    info->median_strand_m = build->length_m[info->strand_count / 2];
}

static void describe_radii(awt_groom *groom)
{
    for (uint32_t level = 0; level < groom->info.levels; level++) {
        size_t first = (size_t)groom->level_first[level] * groom->info.sections;
        size_t end = (size_t)groom->level_first[level + 1] * groom->info.sections;
        double sum = 0.0;
        for (size_t node = first; node < end; node++) {
            sum += (double)groom->rest_radius[node];
        }
        groom->info.mean_radius_m[level] = sum / (double)(end - first);
    }
}

/* The roots' bounds, grown by the longest strand under strain or by what a wisp can swing out, if that is more; never
 * smaller than the head (CONTRACT.md, Geometry). */
static void describe_box(groom_draft *build)
{
    awt_groom_info *info = &build->groom->info;
    double by_strand = info->longest_strand_m * DRAFT_STRAIN * DRAFT_STRAIN;
    double margin = by_strand > build->reach_m ? by_strand : build->reach_m;
    for (int axis = 0; axis < 3; axis++) {
        double least = 0.0, most = 0.0;
        for (uint32_t s = 0; s < info->strand_count; s++) {
            double root = (double)build->strands->positions[3 * (size_t)build->strands->first_point[s] + (size_t)axis];
            least = s == 0 || root < least ? root : least;
            most = s == 0 || root > most ? root : most;
        }
        least -= margin, most += margin;
        info->box_min[axis] = (float)(least < -info->head_radius_m ? least : -info->head_radius_m);
        info->box_max[axis] = (float)(most > info->head_radius_m ? most : info->head_radius_m);
    }
}

/* The sizes; and, for a hierarchy that came with the strands, their order. */
static awt_status plan_sizes(groom_draft *build, const awt_groom_def *def, groom_plan *plan, awt_error *error)
{
    awt_status status = plan_make(build->strands, def, plan, error);
    if (status == AWT_OK && def->hierarchy) {
        status = modelled_sort(build->strands, def->hierarchy, plan, &build->modelled, error);
    } else if (status == AWT_OK) {
        plan_choose_wisps(def, plan);
    }
    return status == AWT_OK ? plan_check_sizes(plan, error) : status;
}

static void draft_fini(groom_draft *build)
{
    arena_fini(&build->memory);
    free(build->modelled);
}

awt_status awt_groom_build(const awt_strands *strands, const awt_groom_def *def,
                           void (*progress)(void *context, double share), void *context, awt_groom **out,
                           awt_error *error)
{
    groom_draft build = {.strands = strands, .progress = progress, .context = context};
    groom_plan plan;
    *out = NULL;
    awt_status status = plan_sizes(&build, def, &plan, error);
    if (status != AWT_OK) {
        draft_fini(&build);
        return status;
    }
    build.groom = calloc(1, sizeof *build.groom);
    if (!build.groom) {
        goto fail;
    }
    groom_take_plan(build.groom, &plan);
    if (!take_memory(&build)) {
        goto fail;
    }
    hierarchy_build(&build);
    fit_wisps(&build);
    if (!pack_wisps(build.groom)) {
        goto fail;
    }
    bind_strands(&build);
    measure_rebuilt(&build);
    choose_mass_unit(build.groom);
    describe_lengths(&build);
    describe_radii(build.groom);
    describe_box(&build);
    memcpy(build.groom->info.colour, strands->colour, sizeof strands->colour);
    draft_fini(&build);
    draft_report(&build, DRAFT_DONE);
    *out = build.groom;
    return AWT_OK;

fail:
    draft_fini(&build);
    awt_groom_destroy(build.groom);
    return error_set(error, AWT_NO_MEMORY, NULL);
}
