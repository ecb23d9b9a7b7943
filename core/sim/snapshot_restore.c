/* snapshot_restore.c: a forest, or its groom alone, from the bytes of a snapshot.
 *
 * The reader believes nothing. Sizes are checked against the limits and against the bytes that are there before any
 * memory is taken; then every number against its range, then what must hold between them. */
#include "base/error.h"
#include "groom/pack.h"
#include "sim/sections.h"
#include "sim/snapshot.h"
#include "sim/snapshot_walks.h"
#include "sim/step.h"
#include "sim/tree.h"

#include <stdlib.h>

/* ---- bytes ------------------------------------------------------------------------------------------------------- */

static awt_status read_walk(const sections_reader *r, const char *section, awt_status (*walk)(codec *, snapshot *),
                            snapshot *s)
{
    codec c;
    if (!sections_find(r, section, &c)) {
        return error_set(s->error, AWT_BAD_VALUE, "the snapshot has no section %s", section);
    }
    awt_status status = walk(&c, s);
    return status == AWT_OK && !codec_ends(&c) ? snapshot_damaged(section, s->error) : status;
}

/* Are the arrays there, of the sizes that they must have? Looks at no pointer of theirs. */
static awt_status check_spans(const sections_reader *r, const span *spans, size_t count, awt_error *error)
{
    for (size_t k = 0; k < count; k++) {
        codec c;
        if (!sections_find(r, spans[k].name, &c) || c.size != span_bytes(&spans[k])) {
            return error_set(error, AWT_BAD_VALUE, "section %s of the snapshot is missing or of the wrong size",
                             spans[k].name);
        }
    }
    return AWT_OK;
}

static awt_status read_spans(const sections_reader *r, const span *spans, size_t count, awt_error *error)
{
    awt_status status = check_spans(r, spans, count, error);
    for (size_t k = 0; status == AWT_OK && k < count; k++) {
        codec c;
        sections_find(r, spans[k].name, &c);
        status = span_read(&spans[k], &c) ? AWT_OK : snapshot_damaged(spans[k].name, error);
    }
    return status;
}

/* The physics version that snapshots have section LOOK from. */
enum { LOOK_SINCE = 5 };

/* ---- the groom --------------------------------------------------------------------------------------------------- */

/* Sets s->groom; on an error it is the caller's all the same. */
static awt_status read_groom(const sections_reader *r, snapshot *s)
{
    awt_groom sizes = {0};
    span spans[SNAPSHOT_GROOM_SPANS];
    awt_status status = read_walk(r, "SIZE", snapshot_walk_sizes, s);
    if (status == AWT_OK) {
        status = snapshot_check_sizes(&s->plan, s->error);
    }
    if (status == AWT_OK) {
        groom_take_plan(&sizes, &s->plan);
        snapshot_groom_spans(&sizes, spans);
        status = check_spans(r, spans, SNAPSHOT_GROOM_SPANS, s->error);
    }
    if (status != AWT_OK) {
        return status;
    }
    s->groom = calloc(1, sizeof *s->groom);
    if (!s->groom) {
        return error_set(s->error, AWT_NO_MEMORY, NULL);
    }
    *s->groom = sizes;
    if (!groom_take_memory(s->groom)) {
        return error_set(s->error, AWT_NO_MEMORY, NULL);
    }
    snapshot_groom_spans(s->groom, spans);
    status = read_spans(r, spans, SNAPSHOT_GROOM_SPANS, s->error);
    if (status == AWT_OK && !groom_number(s->groom)) {
        status = snapshot_damaged("GSUB", s->error);
    }
    if (status == AWT_OK) {
        status = read_walk(r, "MEAS", snapshot_walk_measures, s);
    }
    if (status == AWT_OK) {
        status = snapshot_check_measures(s->groom, s->error);
    }
    if (status == AWT_OK && r->physics_version >= LOOK_SINCE) {
        status = read_walk(r, "LOOK", snapshot_walk_look, s);
    }
    if (status == AWT_OK) {
        status = snapshot_check_look(s->groom, s->error);
    }
    return status == AWT_OK && !pack_wisps(s->groom) ? error_set(s->error, AWT_NO_MEMORY, NULL) : status;
}

/* ---- the forest -------------------------------------------------------------------------------------------------- */

/* A forest at rest on s->groom, which checks parameters and obstacles; then all of its state. Sets s->forest; on an
 * error it is the caller's all the same. */
static awt_status read_forest(const sections_reader *r, snapshot *s)
{
    span spans[SNAPSHOT_FOREST_SPANS];
    s->def.start.head.orientation[3] = s->def.start.body.orientation[3] = 1.0;
    awt_status status = read_walk(r, "COLL", snapshot_walk_colliders, s);
    if (status == AWT_OK) {
        status = awt_forest_create(s->groom, &s->def, &s->forest, s->error);
    }
    if (status == AWT_OK) {
        status = read_walk(r, "MOTN", snapshot_walk_motion, s);
    }
    if (status == AWT_OK) {
        status = read_walk(r, "TREE", snapshot_walk_trees, s);
    }
    if (status == AWT_OK) {
        status = snapshot_check_motion(s->forest, s->error);
    }
    if (status == AWT_OK) {
        snapshot_forest_spans(s->forest, spans);
        status = read_spans(r, spans, SNAPSHOT_FOREST_SPANS, s->error);
    }
    if (status == AWT_OK) {
        status = snapshot_check_splits(s->forest, s->error);
    }
    if (status == AWT_OK) {
        step_orient(s->forest);
        for (uint32_t t = 0; t < s->groom->info.wisp_count[0]; t++) {
            tree_rebuild(s->forest, t);
        }
        status = snapshot_check_trees(s->forest, s->error);
    }
    return status;
}

awt_status awt_snapshot_read_groom(const void *bytes, size_t size, awt_groom **groom, awt_params *params,
                                   awt_error *error)
{
    snapshot s = {.skip_unknown = true, .error = error};
    sections_reader r;
    *groom = NULL;
    awt_status status = sections_check(bytes, size, &r, error);
    if (status == AWT_OK) {
        status = read_walk(&r, "PARA", snapshot_walk_params, &s);
    }
    if (status == AWT_OK) {
        status = read_groom(&r, &s);
    }
    if (status != AWT_OK) {
        awt_groom_destroy(s.groom);
        return status;
    }
    *groom = s.groom;
    *params = s.def.params;
    return AWT_OK;
}

static awt_status check_version(const sections_reader *r, awt_error *error)
{
    if (r->physics_version != AWT_PHYSICS_VERSION) {
        return error_set(error, AWT_OTHER_VERSION,
                         "a snapshot of physics version %lu, and this is version %d: its motion cannot go on, but its "
                         "groom and parameters can be read",
                         (unsigned long)r->physics_version, AWT_PHYSICS_VERSION);
    }
    if (r->count != SNAPSHOT_SECTIONS) {
        return error_set(error, AWT_BAD_VALUE, "the snapshot has %lu sections and must have %d",
                         (unsigned long)r->count, SNAPSHOT_SECTIONS);
    }
    return AWT_OK;
}

awt_status awt_snapshot_restore(const void *bytes, size_t size, awt_groom **groom, awt_forest **forest,
                                awt_error *error)
{
    snapshot s = {.error = error};
    sections_reader r;
    *groom = NULL;
    *forest = NULL;
    awt_status status = sections_check(bytes, size, &r, error);
    if (status == AWT_OK) {
        status = check_version(&r, error);
    }
    if (status == AWT_OK) {
        status = read_walk(&r, "PARA", snapshot_walk_params, &s);
    }
    if (status == AWT_OK) {
        status = read_groom(&r, &s);
    }
    if (status == AWT_OK) {
        status = read_forest(&r, &s);
    }
    if (status != AWT_OK) {
        goto fail;
    }
    *groom = s.groom;
    *forest = s.forest;
    return AWT_OK;
fail:
    awt_forest_destroy(s.forest);
    awt_groom_destroy(s.groom);
    return status;
}
