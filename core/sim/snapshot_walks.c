/* snapshot_walks.c: see snapshot_walks.h. */
#include "sim/snapshot_walks.h"

#include "base/error.h"
#include "sim/snapshot.h"

/* In the spirit of SNAPSHOT_FARTHEST_M. */
#define FASTEST_M_S 1e6
#define FIERCEST_M_S2 1e12

/* ---- arrays: section, kind, array, count, least, most ------------------------------------------------------------ */

void snapshot_groom_spans(const awt_groom *g, span out[SNAPSHOT_GROOM_SPANS])
{
    const size_t gcs = g->gc_count, nodes = gcs * g->info.sections;
    const size_t points = (size_t)g->info.strand_count * g->info.points_per_strand;
    const span spans[SNAPSHOT_GROOM_SPANS] = {
        {"GSUB", SPAN_U32, g->gc_sub_count, gcs, 0, AWT_MAX_NODES},
        {"GSTR", SPAN_U32, g->gc_strand_count, gcs, 1, AWT_MAX_STRANDS},
        {"GPOS", SPAN_F32, g->rest_position, 3 * nodes, -SNAPSHOT_FARTHEST_M, SNAPSHOT_FARTHEST_M},
        {"GRAD", SPAN_F32, g->rest_radius, nodes, 0, SNAPSHOT_FARTHEST_M},
        {"GFRM", SPAN_UNIT, g->rest_frame, 4 * (size_t)g->info.finest_nodes, -2, 2},
        {"GOFF", SPAN_F32, g->strand_offset, 3 * points, -SNAPSHOT_FARTHEST_M, SNAPSHOT_FARTHEST_M},
    };
    memcpy(out, spans, sizeof spans);
}

void snapshot_forest_spans(const awt_forest *f, span out[SNAPSHOT_FOREST_SPANS])
{
    const size_t gcs = f->groom->gc_count, nodes = gcs * f->groom->info.sections;
    const double first_time = -(double)AWT_MAX_TIME_US, now = (double)f->time_us;
    const span spans[SNAPSHOT_FOREST_SPANS] = {
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

/* ---- single values -------------------------------------------------------------------------------------------------
 */

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

awt_status snapshot_walk_sizes(codec *c, snapshot *s)
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

awt_status snapshot_walk_measures(codec *c, snapshot *s)
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

awt_status snapshot_walk_look(codec *c, snapshot *s)
{
    walk_f32s(c, s->groom->info.colour, 3);
    return AWT_OK;
}

awt_status snapshot_walk_params(codec *c, snapshot *s)
{
    if (c->in) {
        return snapshot_read_params(c, s->skip_unknown, &s->def.params, s->error);
    }
    snapshot_write_params(c, &s->def.params);
    return AWT_OK;
}

awt_status snapshot_walk_colliders(codec *c, snapshot *s)
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

awt_status snapshot_walk_motion(codec *c, snapshot *s)
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

awt_status snapshot_walk_trees(codec *c, snapshot *s)
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
