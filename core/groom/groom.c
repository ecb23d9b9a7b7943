/* groom.c: a groom's memory, and the numbers that follow from its counts. */
#include "groom/groom.h"

#include <stdlib.h>

void groom_take_plan(awt_groom *groom, const groom_plan *plan)
{
    groom->info.strand_count = plan->strand_count;
    groom->info.points_per_strand = plan->points_per_strand;
    groom->info.levels = plan->levels;
    groom->info.sections = plan->sections;
    groom->info.head_radius_m = plan->head_radius_m;
    for (uint32_t level = 0; level < plan->levels; level++) {
        groom->info.wisp_count[level] = plan->wisp_count[level];
        groom->level_first[level + 1] = groom->level_first[level] + plan->wisp_count[level];
    }
    groom->gc_count = groom->level_first[plan->levels];
    groom->info.coarse_nodes = plan->wisp_count[0] * plan->sections;
    groom->info.finest_nodes = plan->wisp_count[plan->levels - 1] * plan->sections;
}

/* Every array of the groom, from a real arena or a counting one. */
static void groom_lay_out(awt_groom *groom, arena *memory)
{
    const size_t gcs = groom->gc_count, nodes = gcs * groom->info.sections;
    const size_t points = (size_t)groom->info.strand_count * groom->info.points_per_strand;
    groom->gc_super = ARENA_PUSH(memory, uint32_t, gcs);
    groom->gc_sub_first = ARENA_PUSH(memory, uint32_t, gcs);
    groom->gc_sub_count = ARENA_PUSH(memory, uint32_t, gcs);
    groom->gc_tree = ARENA_PUSH(memory, uint32_t, gcs);
    groom->gc_strand_count = ARENA_PUSH(memory, uint32_t, gcs);
    groom->rest_position = ARENA_PUSH(memory, vec3, nodes);
    groom->rest_radius = ARENA_PUSH(memory, float, nodes);
    groom->rest_room = ARENA_PUSH(memory, float, nodes);
    groom->rest_frame = ARENA_PUSH(memory, quat, groom->info.finest_nodes);
    groom->gc_strand_first = ARENA_PUSH(memory, uint32_t, (size_t)groom->info.wisp_count[groom->info.levels - 1] + 1);
    groom->strand_offset = ARENA_PUSH(memory, float, 3 * points);
}

bool groom_take_memory(awt_groom *groom)
{
    arena counting = arena_counting();
    groom_lay_out(groom, &counting);
    if (counting.overflowed || !arena_init(&groom->memory, counting.used)) {
        return false;
    }
    groom_lay_out(groom, &groom->memory);
    groom->info.bytes = sizeof *groom + groom->memory.size;
    return true;
}

/* The sub-GCs of one level's GCs: one run after the other, all of the next level, each with some strands. */
static bool groom_number_subs(awt_groom *groom, uint32_t level)
{
    const uint32_t end = groom->level_first[level + 1], subs_end = groom->level_first[level + 2];
    uint32_t sub = end;
    for (uint32_t g = groom->level_first[level]; g < end; g++) {
        uint64_t strands = 0;
        if (groom->gc_sub_count[g] == 0 || groom->gc_sub_count[g] > subs_end - sub) {
            return false;
        }
        groom->gc_sub_first[g] = sub;
        for (uint32_t k = 0; k < groom->gc_sub_count[g]; k++, sub++) {
            groom->gc_super[sub] = g;
            groom->gc_tree[sub] = groom->gc_tree[g];
            strands += groom->gc_strand_count[sub];
        }
        if (strands != groom->gc_strand_count[g]) {
            return false;
        }
    }
    return sub == subs_end;
}

static bool groom_number_strands(awt_groom *groom)
{
    const uint32_t first = groom_finest_first(groom), finest = groom->gc_count - first;
    uint64_t strand = 0;
    for (uint32_t w = 0; w < finest; w++) {
        groom->gc_strand_first[w] = (uint32_t)strand;
        strand += groom->gc_strand_count[first + w];
        if (groom->gc_sub_count[first + w] != 0 || groom->gc_strand_count[first + w] == 0 ||
            strand > groom->info.strand_count) {
            return false;
        }
    }
    groom->gc_strand_first[finest] = (uint32_t)strand;
    return strand == groom->info.strand_count;
}

bool groom_number(awt_groom *groom)
{
    for (uint32_t g = 0; g < groom->info.wisp_count[0]; g++) {
        groom->gc_super[g] = groom->gc_tree[g] = g;
    }
    bool sound = true;
    for (uint32_t level = 0; level + 1 < groom->info.levels; level++) {
        sound = sound && groom_number_subs(groom, level);
    }
    return sound && groom_number_strands(groom);
}

void awt_groom_destroy(awt_groom *groom)
{
    if (groom) {
        arena_fini(&groom->memory);
        free(groom);
    }
}

void awt_groom_get_info(const awt_groom *groom, awt_groom_info *info)
{
    *info = groom->info;
}
