/* snapshot.c: the whole state of a forest as bytes; snapshot_restore.c has the way back.
 *
 * What follows from what is stored (snapshot_walks.h) is not: the numbering of the wisps (groom_number), their room
 * (pack_wisps), the slots of active nodes (tree_rebuild), the head's matrix (step_orient), working memory. Per-node
 * arrays are stored whole, inactive nodes included: parent_node and link_length of a node that merged are looked at
 * again when it becomes active anew. */
#include "base/error.h"
#include "sim/sections.h"
#include "sim/snapshot_walks.h"

static void write_spans(sections_writer *w, const span *spans, size_t count)
{
    for (size_t k = 0; k < count; k++) {
        span_write(&spans[k], sections_open(w, spans[k].name));
        sections_close(w);
    }
}

/* The parts of a forest as the walks want them; they do not write into it unless they read (codec.h). */
static void snapshot_of_forest(const awt_forest *f, snapshot *s)
{
    const awt_groom_info *info = &f->groom->info;
    s->plan = (groom_plan){.strand_count = info->strand_count,
                           .points_per_strand = info->points_per_strand,
                           .levels = info->levels,
                           .sections = info->sections,
                           .head_radius_m = info->head_radius_m};
    memcpy(s->plan.wisp_count, info->wisp_count, sizeof info->wisp_count);
    s->groom = (awt_groom *)f->groom;
    s->forest = (awt_forest *)f;
    s->def.params = f->params;
    s->def.collider_count = f->collider_count;
    memcpy(s->def.colliders, f->colliders, sizeof f->colliders);
}

awt_status awt_forest_snapshot(const awt_forest *forest, void *bytes, size_t capacity, size_t *size, awt_error *error)
{
    snapshot s = {0};
    span in_groom[SNAPSHOT_GROOM_SPANS], in_forest[SNAPSHOT_FOREST_SPANS];
    snapshot_of_forest(forest, &s);
    snapshot_groom_spans(forest->groom, in_groom);
    snapshot_forest_spans(forest, in_forest);
    sections_writer w = sections_begin(bytes, capacity, SNAPSHOT_SECTIONS);
#define WRITE_WALK(section, walk)         \
    walk(sections_open(&w, section), &s); \
    sections_close(&w);
    SNAPSHOT_WALKS(WRITE_WALK)
#undef WRITE_WALK
    write_spans(&w, in_groom, SNAPSHOT_GROOM_SPANS);
    write_spans(&w, in_forest, SNAPSHOT_FOREST_SPANS);
    sections_end(&w, AWT_PHYSICS_VERSION);
    *size = w.to.at;
    if (w.to.spent) {
        return error_set(error, AWT_LIMIT, "a snapshot of this forest has %zu bytes, and there is room for %zu",
                         w.to.at, capacity);
    }
    return AWT_OK;
}
