/* awtctl_record.c: what awtctl play has measured, as a table, a summary and JSON. */
#include "awtctl_play.h"

#include "base/version.h"
#include "quantile.h"

#include <inttypes.h>
#include <stdlib.h>

void play_frame_path(const play_record *record, size_t frame, char *path, size_t size)
{
    snprintf(path, size, "%s/frame_%06zu.glb", record->plan->out, frame + 1);
}

/* ---- text -------------------------------------------------------------------------------------------------------- */

static const char *guessed(const play_record *record, int bit)
{
    return record->forest.guessed >> bit & 1 ? " (guessed)" : "";
}

static void print_wisps(const struct proto_create_reply *f, FILE *file)
{
    fprintf(file, "wisps  ");
    for (uint16_t level = 0; level < f->wisp_levels.count; level++) {
        const struct proto_wisp_level *l = &f->wisp_levels.items[level];
        fprintf(file, " %s%u of radius %.2f mm", level > 0 ? "> " : "", l->wisps, (double)l->mean_radius_m * 1000);
    }
    fprintf(file, "; %u sections; nodes: %u coarse, %u finest; built in %.2f s\n", f->sections, f->coarse_nodes,
            f->finest_nodes, (double)f->build_us * 1e-6);
    fprintf(file, "rebuilt at rest within %.3g mm of the strands given, %.2g mm on average\n",
            (double)f->rebuilt_max_m * 1000, (double)f->rebuilt_mean_m * 1000);
}

void play_record_print_forest(const play_record *record, FILE *file)
{
    const struct proto_create_reply *f = &record->forest;
    fprintf(file, "hair    %s: %u strands of %u points, %" PRIu32 " left out; longest %.3f m, median %.3f m, %.3f kg\n",
            record->source, f->strands, f->points_per_strand, f->skipped_strands, f->longest_strand_m,
            f->median_strand_m, f->mass_kg);
    print_wisps(f, file);
    if (record->plan->groom) {
        fprintf(file,
                "placed  %g m per unit%s, %s up%s, head at %.4g %.4g %.4g of radius %.4g in the file's units "
                "(%.4f m)%s\n",
                f->scale, guessed(record, 0), f->up == AWT_UP_Z ? "Z" : "Y", guessed(record, 1), f->head_x, f->head_y,
                f->head_z, f->head_radius, f->head_radius_m, guessed(record, 2));
        if (f->turned_degrees != 0) {
            fprintf(file, "        turned by %g degrees about the up axis, so that the face looks along +Z (guessed)\n",
                    f->turned_degrees);
        }
    }
    fprintf(file, "motion  %s\n", record->motion);
}

void play_record_print_frame(const play_record *record, size_t frame, FILE *file)
{
    const play_frame *f = &record->frames[frame];
    char path[4200] = "-";
    if (frame == 0) {
        fprintf(file, "%6s %9s %6s %6s %6s %5s %8s %8s %8s %8s %9s  %s\n", "frame", "time_s", "active", "splits",
                "merges", "steps", "queue_us", "step_us", "enc_us", "write_us", "bytes", "file");
    }
    if (f->written) {
        play_frame_path(record, frame, path, sizeof path);
    }
    fprintf(file, "%6zu %9.4f %6u %6u %6u %5u %8u %8u %8u %8u %9zu  %s\n", frame + 1, (double)f->time_us * 1e-6,
            f->active_nodes, f->splits, f->merges, f->steps, f->queue_us, f->step_us, f->encode_us, f->write_us,
            f->bytes, path);
    fflush(file); /* whole lines, wherever the progress bar is drawn */
}

/* ---- the summary ---------------------------------------------------------------------------------------------------
 */

/* The four stages of a frame's way, in its order. */
enum { STAGE_QUEUE, STAGE_STEP, STAGE_ENCODE, STAGE_WRITE, STAGES };

static const char *const STAGE_NAMES[STAGES] = {"queue_us", "step_us", "encode_us", "write_us"};

static uint32_t stage_of(const play_frame *f, int stage)
{
    const uint32_t values[STAGES] = {f->queue_us, f->step_us, f->encode_us, f->write_us};
    return values[stage];
}

typedef struct play_summary {
    struct {
        double p50, p99, mean;
    } stages[STAGES];
    uint32_t active_min, active_max;
    double active_mean, bytes_mean;
    uint64_t deltas;
    uint64_t splits, merges, steps, unreached_contacts, clamped_points, clamped_speeds;
    float link_error, last_kinetic_energy_j;
} play_summary;

/* Without memory for the sort the quantiles stay 0. */
static void summarise_stages(const play_record *record, play_summary *s)
{
    size_t count = record->frame_count;
    double *values = malloc((count + 1) * sizeof *values);
    for (int stage = 0; stage < STAGES && values; stage++) {
        double sum = 0;
        for (size_t i = 0; i < count; i++) {
            values[i] = stage_of(&record->frames[i], stage);
            sum += values[i];
        }
        quantile_sort(values, count);
        s->stages[stage].p50 = quantile_at(values, count, 0.5);
        s->stages[stage].p99 = quantile_at(values, count, 0.99);
        s->stages[stage].mean = count > 0 ? sum / (double)count : 0;
    }
    free(values);
}

static play_summary summarise(const play_record *record)
{
    play_summary s = {.active_min = UINT32_MAX};
    double active = 0, bytes = 0;
    for (size_t i = 0; i < record->frame_count; i++) {
        const play_frame *f = &record->frames[i];
        s.active_min = f->active_nodes < s.active_min ? f->active_nodes : s.active_min;
        s.active_max = f->active_nodes > s.active_max ? f->active_nodes : s.active_max;
        s.link_error = f->link_error > s.link_error ? f->link_error : s.link_error;
        s.last_kinetic_energy_j = f->kinetic_energy_j;
        active += f->active_nodes;
        bytes += (double)f->bytes;
        s.deltas += f->delta;
        s.splits += f->splits;
        s.merges += f->merges;
        s.steps += f->steps;
        s.unreached_contacts += f->unreached_contacts;
        s.clamped_points += f->clamped_points;
        s.clamped_speeds += f->clamped_speeds;
    }
    s.active_mean = active / (double)record->frame_count;
    s.bytes_mean = bytes / (double)record->frame_count;
    summarise_stages(record, &s);
    return s;
}

void play_record_print_summary(const play_record *record, FILE *file)
{
    play_summary s = summarise(record);
    const strandcheck *strands = &record->strands;
    fprintf(file, "\n%zu frames, %.4f s simulated in %" PRIu64 " steps\n", record->frame_count,
            (double)record->frames[record->frame_count - 1].time_us * 1e-6, s.steps);
    for (int stage = 0; stage < STAGES; stage++) {
        fprintf(file, "%-14s p50 %.0f, p99 %.0f, mean %.0f\n", STAGE_NAMES[stage], s.stages[stage].p50,
                s.stages[stage].p99, s.stages[stage].mean);
    }
    fprintf(file, "%-14s least %u, mean %.1f, greatest %u of %u; %" PRIu64 " splits, %" PRIu64 " merges\n",
            "active nodes", s.active_min, s.active_mean, s.active_max, record->forest.finest_nodes, s.splits, s.merges);
    fprintf(file, "%-14s %.0f a frame", "bytes", s.bytes_mean);
    if (record->plan->deltas) {
        fprintf(file, "; %" PRIu64 " of the frames were deltas", s.deltas);
    }
    fprintf(file, "\n");
    fprintf(file, "%-14s greatest %.2e; %" PRIu64 " unreached contacts, %" PRIu64 " speeds at the limit\n",
            "link error", (double)s.link_error, s.unreached_contacts, s.clamped_speeds);
    fprintf(file, "%-14s %" PRIu64 "\n", "clamped points", s.clamped_points);
    fprintf(file, "%-14s %.3e J at the end\n", "kinetic energy", (double)s.last_kinetic_energy_j);
    if (strands->frames > 0) {
        fprintf(file,
                "%-14s against the first of %zu decoded frames: length changed by p50 %.2f %%, p95 %.2f %%, at most "
                "%.2f %%; roots moved by %.4f mm in the head frame\n",
                "strands", strands->frames + 1, strandcheck_percent(strands, 0.5), strandcheck_percent(strands, 0.95),
                strands->greatest_percent, strands->greatest_root_m * 1000);
    }
}

/* ---- JSON
 * ------------------------------------------------------------------------------------------------------------ */

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
    for (int stage = 0; stage < STAGES; stage++) {
        jsonout_unsigned(json, STAGE_NAMES[stage], stage_of(f, stage));
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
    play_summary s = summarise(record);
    const strandcheck *strands = &record->strands;
    jsonout_object(json, "summary");
    for (int stage = 0; stage < STAGES; stage++) {
        jsonout_object(json, STAGE_NAMES[stage]);
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
