/* awtctl_record_json.c: what awtctl play has measured, as JSON. */
#include "awtctl_play.h"

#include "base/version.h"

static void json_pose(jsonout *json, const char *key, const awt_pose *pose)
{
    jsonout_object(json, key);
    jsonout_reals(json, "position", pose->position, 3);
    jsonout_reals(json, "orientation", pose->orientation, 4);
    jsonout_close(json);
}

static void json_frame(jsonout *json, const play_record *record, size_t frame)
{
    const play_frame *f = &record->frames[frame];
    char path[4200];
    play_frame_path(record, frame, path, sizeof path);
    jsonout_object(json, NULL);
    json->compact = true;
    jsonout_real(json, "time_s", (double)f->time_us * 1e-6);
    jsonout_unsigned(json, "active_nodes", f->active_nodes);
    jsonout_unsigned(json, "splits", f->splits);
    jsonout_unsigned(json, "merges", f->merges);
    jsonout_unsigned(json, "steps", f->steps);
    for (int stage = 0; stage < PLAY_STAGES; stage++) {
        jsonout_unsigned(json, PLAY_STAGE_NAMES[stage], play_frame_stage(f, stage));
    }
    jsonout_unsigned(json, "bytes", f->bytes);
    jsonout_bool(json, "delta", f->delta);
    jsonout_text(json, "file", f->written ? path : NULL);
    jsonout_unsigned(json, "unreached_contacts", f->unreached_contacts);
    jsonout_unsigned(json, "clamped_points", f->clamped_points);
    jsonout_unsigned(json, "clamped_speeds", f->clamped_speeds);
    jsonout_float(json, "link_error", f->link_error);
    jsonout_float(json, "kinetic_energy_j", f->kinetic_energy_j);
    json_pose(json, "head", &f->head);
    json_pose(json, "body", &f->body);
    jsonout_close(json);
    json->compact = false;
}

static void json_colliders(jsonout *json, const struct proto_create_reply *forest)
{
    static const char *const frames[] = {"head", "body", "own"};
    jsonout_array(json, "colliders");
    for (uint16_t i = 0; i < forest->colliders.count; i++) {
        const struct proto_collider *c = &forest->colliders.items[i];
        const double a[3] = {(double)c->ax, (double)c->ay, (double)c->az};
        const double b[3] = {(double)c->bx, (double)c->by, (double)c->bz};
        jsonout_object(json, NULL);
        json->compact = true;
        jsonout_text(json, "frame", c->frame < 3 ? frames[c->frame] : NULL);
        jsonout_reals(json, "a", a, 3);
        jsonout_reals(json, "b", b, 3);
        jsonout_float(json, "radius_a", c->radius_a);
        jsonout_float(json, "radius_b", c->radius_b);
        jsonout_close(json);
        json->compact = false;
    }
    jsonout_close(json);
}

static void json_levels(jsonout *json, const struct proto_create_reply *forest)
{
    jsonout_array(json, "wisp_levels");
    for (uint16_t level = 0; level < forest->wisp_levels.count; level++) {
        const struct proto_wisp_level *l = &forest->wisp_levels.items[level];
        jsonout_object(json, NULL);
        json->compact = true;
        jsonout_unsigned(json, "wisps", l->wisps);
        jsonout_float(json, "mean_radius_m", l->mean_radius_m);
        jsonout_close(json);
        json->compact = false;
    }
    jsonout_close(json);
}

static void json_forest(jsonout *json, const play_record *record)
{
    const struct proto_create_reply *f = &record->forest;
    jsonout_text(json, "source", record->source);
    jsonout_text(json, "motion", record->motion);
    jsonout_real(json, "fps", record->plan->fps);
    jsonout_unsigned(json, "strands", f->strands);
    jsonout_unsigned(json, "skipped_strands", f->skipped_strands);
    jsonout_unsigned(json, "points_per_strand", f->points_per_strand);
    jsonout_unsigned(json, "finest_nodes", f->finest_nodes);
    jsonout_unsigned(json, "coarse_nodes", f->coarse_nodes);
    jsonout_unsigned(json, "levels", f->levels);
    jsonout_unsigned(json, "sections", f->sections);
    json_levels(json, f);
    jsonout_float(json, "rebuilt_max_m", f->rebuilt_max_m);
    jsonout_float(json, "rebuilt_mean_m", f->rebuilt_mean_m);
    jsonout_real(json, "head_radius_m", f->head_radius_m);
    jsonout_real(json, "turned_degrees", f->turned_degrees);
    jsonout_unsigned(json, "build_us", f->build_us);
    json_colliders(json, f);
}

static void json_summary(jsonout *json, const play_record *record)
{
    play_summary s = play_record_summarise(record);
    const strandcheck *strands = &record->strands;
    jsonout_object(json, "summary");
    for (int stage = 0; stage < PLAY_STAGES; stage++) {
        jsonout_object(json, PLAY_STAGE_NAMES[stage]);
        jsonout_real(json, "p50", s.stages[stage].p50);
        jsonout_real(json, "p99", s.stages[stage].p99);
        jsonout_real(json, "mean", s.stages[stage].mean);
        jsonout_close(json);
    }
    jsonout_unsigned(json, "active_min", s.active_min);
    jsonout_real(json, "active_mean", s.active_mean);
    jsonout_unsigned(json, "active_max", s.active_max);
    jsonout_unsigned(json, "splits", s.splits);
    jsonout_unsigned(json, "merges", s.merges);
    jsonout_unsigned(json, "steps", s.steps);
    jsonout_real(json, "bytes_mean", s.bytes_mean);
    jsonout_unsigned(json, "deltas", s.deltas);
    jsonout_float(json, "link_error", s.link_error);
    jsonout_float(json, "last_kinetic_energy_j", s.last_kinetic_energy_j);
    jsonout_unsigned(json, "unreached_contacts", s.unreached_contacts);
    jsonout_unsigned(json, "clamped_points", s.clamped_points);
    jsonout_unsigned(json, "clamped_speeds", s.clamped_speeds);
    jsonout_unsigned(json, "frames_compared", strands->frames);
    jsonout_real(json, "length_change_p50_percent", strandcheck_percent(strands, 0.5));
    jsonout_real(json, "length_change_p95_percent", strandcheck_percent(strands, 0.95));
    jsonout_real(json, "length_change_max_percent", strands->greatest_percent);
    jsonout_real(json, "roots_moved_mm", strands->greatest_root_m * 1000);
    jsonout_close(json);
}

void play_record_json(jsonout *json, const void *context)
{
    const play_record *record = context;
    jsonout_object(json, NULL);
    jsonout_text(json, "version", AWTD_VERSION);
    json_forest(json, record);
    json_summary(json, record);
    jsonout_array(json, "frames");
    for (size_t i = 0; i < record->frame_count; i++) {
        json_frame(json, record, i);
    }
    jsonout_close(json);
    jsonout_close(json);
}
