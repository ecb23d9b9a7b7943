/* snapshot.c: the whole state of a forest as bytes, and back.
 *
 * What goes in stands in lists that writer and reader walk alike: SNAPSHOT_WALKS for the
 * handful of single values, groom_spans and forest_spans for the arrays. What follows from them is not stored: the
 * numbering of the wisps (groom_number), their room (pack_wisps), the slots of active nodes (tree_rebuild), the head's
 * matrix (step_orient), working memory. Per-node arrays are stored whole, inactive nodes included: parent_node and
 * link_length of a node that merged are looked at again when it becomes active anew.
 *
 * The reader believes nothing. Sizes are checked against the limits and against the bytes that are there before any
 * memory is taken; then every number against its range, then what must hold between them. */
#include "sim/snapshot.h"

#include "base/error.h"
#include "groom/pack.h"
#include "sim/sections.h"
#include "sim/span.h"
#include "sim/state.h"
#include "sim/step.h"
#include "sim/tree.h"

#include <stdlib.h>

/* In the spirit of SNAPSHOT_FARTHEST_M. */
#define FASTEST_M_S 1e6
#define FIERCEST_M_S2 1e12

enum { GROOM_SPANS = 6, FOREST_SPANS = 12 };

/* ---- arrays: section, kind, array, count, least, most ------------------------------------------------------------ */

static void groom_spans(const awt_groom *g, span out[GROOM_SPANS])
{
    const size_t gcs = g->gc_count, nodes = gcs * g->info.sections;
    const size_t points = (size_t)g->info.strand_count * g->info.points_per_strand;
    const span spans[GROOM_SPANS] = {
        {"GSUB", SPAN_U32, g->gc_sub_count, gcs, 0, AWT_MAX_NODES},
        {"GSTR", SPAN_U32, g->gc_strand_count, gcs, 1, AWT_MAX_STRANDS},
        {"GPOS", SPAN_F32, g->rest_position, 3 * nodes, -SNAPSHOT_FARTHEST_M, SNAPSHOT_FARTHEST_M},
        {"GRAD", SPAN_F32, g->rest_radius, nodes, 0, SNAPSHOT_FARTHEST_M},
        {"GFRM", SPAN_UNIT, g->rest_frame, 4 * (size_t)g->info.finest_nodes, -2, 2},
        {"GOFF", SPAN_F32, g->strand_offset, 3 * points, -SNAPSHOT_FARTHEST_M, SNAPSHOT_FARTHEST_M},
    };
    memcpy(out, spans, sizeof spans);
}

static void forest_spans(const awt_forest *f, span out[FOREST_SPANS])
{
    const size_t gcs = f->groom->gc_count, nodes = gcs * f->groom->info.sections;
    const double first_time = -(double)AWT_MAX_TIME_US, now = (double)f->time_us;
    const span spans[FOREST_SPANS] = {
        {"SPLT", SPAN_U32, f->first_split, gcs, 1, f->groom->info.sections},
        {"EVNT", SPAN_I64, f->event_us, gcs, first_time, now},
        {"NPOS", SPAN_F32, f->position, 3 * nodes, -SNAPSHOT_FARTHEST_M, SNAPSHOT_FARTHEST_M},
        {"NVEL", SPAN_F32, f->velocity, 3 * nodes, -FASTEST_M_S, FASTEST_M_S},
        {"NACC", SPAN_F32, f->acceleration, 3 * nodes, -FIERCEST_M_S2, FIERCEST_M_S2},
        {"NAGI", SPAN_F32, f->agitation, nodes, 0, FIERCEST_M_S2},
        {"NRAD", SPAN_F32, f->radius, nodes, 0, SNAPSHOT_FARTHEST_M},
        {"NLNK", SPAN_F32, f->link_length, nodes, 0, SNAPSHOT_FARTHEST_M},
        {"NPAR", SPAN_U32, f->parent_node, nodes, 0, UINT32_MAX}, /* compared, never followed */
        {"NREF", SPAN_F32, f->reference, 3 * nodes, -2, 2},
        {"NOFF", SPAN_F32, f->offset, 3 * nodes, -SNAPSHOT_FARTHEST_M, SNAPSHOT_FARTHEST_M},
        {"NFRM", SPAN_UNIT, f->frame, 4 * (size_t)f->groom->info.finest_nodes, -2, 2},
    };
    memcpy(out, spans, sizeof spans);
}

/* ---- single values: what a walk passes is written, read or counted ----------------------------------------------- */

/* Section, walk. Reading needs the earlier ones for the later. */
#define SNAPSHOT_WALKS(X)     \
    X("SIZE", walk_sizes)     \
    X("MEAS", walk_measures)  \
    X("PARA", walk_params)    \
    X("COLL", walk_colliders) \
    X("MOTN", walk_motion)    \
    X("TREE", walk_trees)

/* What the walks are about; each uses its part. */
typedef struct snapshot {
    groom_plan plan;
    awt_groom *groom;
    awt_forest_def def; /* params, colliders; the start stays at rest */
    awt_forest *forest;
    bool skip_unknown; /* parameters that this version has not */
    awt_error *error;
} snapshot;

static void walk_f32s(codec *c, float *values, int count)
{
    for (int k = 0; k < count; k++) {
        codec_f32(c, &values[k]);
    }
}

static void walk_dvec3(codec *c, dvec3 *v)
{
    codec_f64(c, &v->x), codec_f64(c, &v->y), codec_f64(c, &v->z);
}

static void walk_dquat(codec *c, dquat *q)
{
    codec_f64(c, &q->x), codec_f64(c, &q->y), codec_f64(c, &q->z), codec_f64(c, &q->w);
}

static awt_status walk_sizes(codec *c, snapshot *s)
{
    codec_u32(c, &s->plan.strand_count);
    codec_u32(c, &s->plan.points_per_strand);
    codec_u32(c, &s->plan.levels);
    codec_u32(c, &s->plan.sections);
    for (int level = 0; level < AWT_MAX_LEVELS; level++) {
        codec_u32(c, &s->plan.wisp_count[level]);
    }
    codec_f64(c, &s->plan.head_radius_m);
    return AWT_OK;
}

static awt_status walk_measures(codec *c, snapshot *s)
{
    awt_groom_info *info = &s->groom->info;
    codec_f32(c, &s->groom->mass_unit_kg);
    codec_f64(c, &info->mass_kg);
    codec_f64(c, &info->longest_strand_m);
    codec_f64(c, &info->median_strand_m);
    for (int level = 0; level < AWT_MAX_LEVELS; level++) {
        codec_f64(c, &info->mean_radius_m[level]);
    }
    walk_f32s(c, info->box_min, 3);
    walk_f32s(c, info->box_max, 3);
    return AWT_OK;
}

static awt_status walk_params(codec *c, snapshot *s)
{
    if (c->in) {
        return snapshot_read_params(c, s->skip_unknown, &s->def.params, s->error);
    }
    snapshot_write_params(c, &s->def.params);
    return AWT_OK;
}

static awt_status walk_colliders(codec *c, snapshot *s)
{
    codec_u32(c, &s->def.collider_count);
    if (s->def.collider_count > AWT_MAX_COLLIDERS) {
        return error_set(s->error, AWT_LIMIT, "the snapshot has %lu obstacles; %d are the most",
                         (unsigned long)s->def.collider_count, AWT_MAX_COLLIDERS);
    }
    for (uint32_t k = 0; k < s->def.collider_count; k++) {
        awt_collider *collider = &s->def.colliders[k];
        uint32_t frame = (uint32_t)collider->frame;
        codec_u32(c, &collider->id);
        codec_u32(c, &frame);
        walk_f32s(c, collider->a, 3);
        walk_f32s(c, collider->b, 3);
        codec_f32(c, &collider->radius_a);
        codec_f32(c, &collider->radius_b);
        collider->frame = frame <= AWT_FRAME_OWN ? (awt_frame)frame : AWT_FRAME_HEAD;
        c->spent = c->spent || frame > AWT_FRAME_OWN;
    }
    return AWT_OK;
}

/* Head, body and the obstacles with frames of their own; the other poses are never looked at. */
static void walk_poses(codec *c, track_pose *pose, uint32_t own_count)
{
    for (uint32_t k = 0; k < TRACK_OWN + own_count; k++) {
        walk_dvec3(c, &pose[k].position);
        walk_dquat(c, &pose[k].orientation);
        walk_dvec3(c, &pose[k].velocity);
        walk_dquat(c, &pose[k].rate);
    }
}

static void walk_instant(codec *c, track_instant *instant, uint32_t own_count)
{
    codec_i64(c, &instant->time_us);
    codec_bool(c, &instant->teleport);
    walk_poses(c, instant->pose, own_count);
}

static awt_status walk_motion(codec *c, snapshot *s)
{
    awt_forest *f = s->forest;
    track *t = &f->track;
    codec_i64(c, &f->time_us);
    walk_dvec3(c, &f->frame_velocity);
    walk_dquat(c, &f->still_orientation);
    walk_poses(c, f->pose, t->own_count);
    walk_instant(c, &t->last, t->own_count);
    codec_u32(c, &t->queue_count);
    if (t->queue_count > AWT_MAX_QUEUED_POSES) {
        t->queue_count = 0;
        return error_set(s->error, AWT_LIMIT, "more than %d poses wait in the snapshot", AWT_MAX_QUEUED_POSES);
    }
    for (uint32_t k = 0; k < t->queue_count; k++) {
        if (c->in) {
            t->queue[track_queued(t, k)] = t->last; /* the poses that are not stored */
        }
        walk_instant(c, &t->queue[track_queued(t, k)], t->own_count);
    }
    walk_f32s(c, &f->still_s, 1);
    return AWT_OK;
}

static awt_status walk_trees(codec *c, snapshot *s)
{
    codec_u32(c, &s->forest->split_from);
    for (uint32_t t = 0; t < s->groom->info.wisp_count[0]; t++) {
        codec_bool(c, &s->forest->trees[t].asleep);
        codec_bool(c, &s->forest->trees[t].loose);
        codec_f32(c, &s->forest->trees[t].quiet_s);
        codec_f32(c, &s->forest->trees[t].unrelaxed_s);
    }
    return AWT_OK;
}

/* ---- writing --------------------------------------------------------------------------------------------------------
 */

static void write_spans(sections_writer *w, const span *spans, size_t count)
{
    for (size_t k = 0; k < count; k++) {
        span_write(&spans[k], sections_open(w, spans[k].name));
        sections_close(w);
    }
}

#define COUNT_WALK(section, walk) +1
enum { WALK_COUNT = 0 SNAPSHOT_WALKS(COUNT_WALK), SECTION_COUNT = WALK_COUNT + GROOM_SPANS + FOREST_SPANS };
#undef COUNT_WALK

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
    span in_groom[GROOM_SPANS], in_forest[FOREST_SPANS];
    snapshot_of_forest(forest, &s);
    groom_spans(forest->groom, in_groom);
    forest_spans(forest, in_forest);
    sections_writer w = sections_begin(bytes, capacity, SECTION_COUNT);
#define WRITE_WALK(section, walk)         \
    walk(sections_open(&w, section), &s); \
    sections_close(&w);
    SNAPSHOT_WALKS(WRITE_WALK)
#undef WRITE_WALK
    write_spans(&w, in_groom, GROOM_SPANS);
    write_spans(&w, in_forest, FOREST_SPANS);
    sections_end(&w, AWT_PHYSICS_VERSION);
    *size = w.to.at;
    if (w.to.spent) {
        return error_set(error, AWT_LIMIT, "a snapshot of this forest has %zu bytes, and there is room for %zu",
                         w.to.at, capacity);
    }
    return AWT_OK;
}

/* ---- reading: bytes -------------------------------------------------------------------------------------------------
 */

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

/* ---- reading: the groom -------------------------------------------------------------------------------------------
 */

/* Sets s->groom; on an error it is the caller's all the same. */
static awt_status read_groom(const sections_reader *r, snapshot *s)
{
    awt_groom sizes = {0};
    span spans[GROOM_SPANS];
    awt_status status = read_walk(r, "SIZE", walk_sizes, s);
    if (status == AWT_OK) {
        status = snapshot_check_sizes(&s->plan, s->error);
    }
    if (status == AWT_OK) {
        groom_take_plan(&sizes, &s->plan);
        groom_spans(&sizes, spans);
        status = check_spans(r, spans, GROOM_SPANS, s->error);
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
    groom_spans(s->groom, spans);
    status = read_spans(r, spans, GROOM_SPANS, s->error);
    if (status == AWT_OK && !groom_number(s->groom)) {
        status = snapshot_damaged("GSUB", s->error);
    }
    if (status == AWT_OK) {
        status = read_walk(r, "MEAS", walk_measures, s);
    }
    if (status == AWT_OK) {
        status = snapshot_check_measures(s->groom, s->error);
    }
    return status == AWT_OK && !pack_wisps(s->groom) ? error_set(s->error, AWT_NO_MEMORY, NULL) : status;
}

/* ---- reading: the forest -------------------------------------------------------------------------------------------
 */

/* A forest at rest on s->groom, which checks parameters and obstacles; then all of its state. Sets s->forest; on an
 * error it is the caller's all the same. */
static awt_status read_forest(const sections_reader *r, snapshot *s)
{
    span spans[FOREST_SPANS];
    s->def.start.head.orientation[3] = s->def.start.body.orientation[3] = 1.0;
    awt_status status = read_walk(r, "COLL", walk_colliders, s);
    if (status == AWT_OK) {
        status = awt_forest_create(s->groom, &s->def, &s->forest, s->error);
    }
    if (status == AWT_OK) {
        status = read_walk(r, "MOTN", walk_motion, s);
    }
    if (status == AWT_OK) {
        status = read_walk(r, "TREE", walk_trees, s);
    }
    if (status == AWT_OK) {
        status = snapshot_check_motion(s->forest, s->error);
    }
    if (status == AWT_OK) {
        forest_spans(s->forest, spans);
        status = read_spans(r, spans, FOREST_SPANS, s->error);
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
        status = read_walk(&r, "PARA", walk_params, &s);
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
    if (r->count != SECTION_COUNT) {
        return error_set(error, AWT_BAD_VALUE, "the snapshot has %lu sections and must have %d",
                         (unsigned long)r->count, SECTION_COUNT);
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
        status = read_walk(&r, "PARA", walk_params, &s);
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
