/* hierarchy.c: strands into trees of wisps (AWT §2.1): clustered by root place and shape into the top-level GCs, each
 * of them into sub-GCs, level by level; or as a modeller had them (modelled.h). The strands of a GC stay together at
 * every further level, so each GC is a run of strands, sub-GCs are contiguous, and numbers follow from the order. */
#include "groom/draft.h"

#include <string.h>
#include "base/assert.h"

/* How much the root and the points at one, two and three thirds of the length count. Tips least: strands of one lock
 * differ most in length. */
static const float feature_weight[4] = {1.6f, 1.0f, 0.7f, 0.4f};

static void describe_strands(groom_draft *build)
{
    polyline line;
    for (uint32_t s = 0; s < build->groom->info.strand_count; s++) {
        build->clusters.order[s] = s;
        draft_measure(build, s, &line);
        vec3 third[4];
        polyline_sample(&line, 4, third);
        float *features = build->features + (size_t)s * CLUSTER_FEATURES;
        for (int i = 0; i < 4; i++) {
            features[3 * i + 0] = third[i].x * feature_weight[i];
            features[3 * i + 1] = third[i].y * feature_weight[i];
            features[3 * i + 2] = third[i].z * feature_weight[i];
        }
    }
}

/* Where the strands of each GC of a level begin. */
static void begin_level(groom_draft *build, uint32_t level)
{
    awt_groom *groom = build->groom;
    uint32_t strand = 0;
    for (uint32_t g = groom->level_first[level]; g < groom->level_first[level + 1]; g++) {
        build->gc_first[g] = strand;
        strand += groom->gc_strand_count[g];
    }
}

static void build_top_level(groom_draft *build)
{
    awt_groom *groom = build->groom;
    cluster_split(&build->clusters, 0, groom->info.strand_count, groom->info.wisp_count[0], groom->gc_strand_count);
    begin_level(build, 0);
}

/* Sub-GCs are shared out by strand count; each gets at least one strand. */
static void refine_level(groom_draft *build, uint32_t level)
{
    awt_groom *groom = build->groom;
    const uint32_t first = groom->level_first[level], end = groom->level_first[level + 1];
    cluster_share(groom->gc_strand_count + first, end - first, groom->info.wisp_count[level + 1],
                  groom->gc_sub_count + first);
    uint32_t sub = end;
    for (uint32_t g = first; g < end; g++) {
        cluster_split(&build->clusters, build->gc_first[g], groom->gc_strand_count[g], groom->gc_sub_count[g],
                      groom->gc_strand_count + sub);
        sub += groom->gc_sub_count[g];
    }
    begin_level(build, level + 1);
}

static void cluster_levels(groom_draft *build)
{
    awt_groom *groom = build->groom;
    describe_strands(build);
    draft_report(build, 0.1);
    build_top_level(build);
    for (uint32_t level = 0; level + 1 < groom->info.levels; level++) {
        draft_report(build, 0.2 + 0.2 * level / groom->info.levels);
        refine_level(build, level);
    }
}

/* Is this strand of the groom's order the first of its GC? */
static bool begins_wisp(const modelled_strand *order, uint32_t k, uint32_t level)
{
    return k == 0 || order[k].first[level] != order[k - 1].first[level];
}

/* Counts the strands and sub-GCs of each GC. */
static void take_modelled(groom_draft *build)
{
    awt_groom *groom = build->groom;
    const uint32_t levels = groom->info.levels;
    uint32_t next[AWT_MAX_LEVELS]; /* GC that the next one of each level gets */
    memcpy(next, groom->level_first, levels * sizeof *next);
    for (uint32_t k = 0; k < groom->info.strand_count; k++) {
        build->clusters.order[k] = build->modelled[k].strand;
        for (uint32_t level = 0; level < levels; level++) {
            bool begins = begins_wisp(build->modelled, k, level);
            next[level] += begins ? 1 : 0;
            groom->gc_strand_count[next[level] - 1]++;
            if (begins && level > 0) {
                groom->gc_sub_count[next[level - 1] - 1]++;
            }
        }
    }
}

void hierarchy_build(groom_draft *build)
{
    draft_report(build, 0.0);
    if (build->modelled) {
        take_modelled(build);
    } else {
        cluster_levels(build);
    }
    bool sound = groom_number(build->groom);
    ASSERT(sound);
    draft_report(build, 0.4);
}
