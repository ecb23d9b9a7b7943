/* awtctl_record.c: what awtctl play has measured, summed up, as a table and a summary; awtctl_record_json.c: as JSON.
 */
#include "awtctl_play.h"

#include "quantile.h"

#include <inttypes.h>
#include <stdlib.h>

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

const char *const PLAY_STAGE_NAMES[PLAY_STAGES] = {"queue_us", "step_us", "encode_us", "write_us"};

uint32_t play_frame_stage(const play_frame *f, int stage)
{
    const uint32_t values[PLAY_STAGES] = {f->queue_us, f->step_us, f->encode_us, f->write_us};
    return values[stage];
}

/* Without memory for the sort the quantiles stay 0. */
static void summarise_stages(const play_record *record, play_summary *s)
{
    size_t count = record->frame_count;
    double *values = malloc((count + 1) * sizeof *values);
    for (int stage = 0; stage < PLAY_STAGES && values; stage++) {
        double sum = 0;
        for (size_t i = 0; i < count; i++) {
            values[i] = play_frame_stage(&record->frames[i], stage);
            sum += values[i];
        }
        quantile_sort(values, count);
        s->stages[stage].p50 = quantile_at(values, count, 0.5);
        s->stages[stage].p99 = quantile_at(values, count, 0.99);
        s->stages[stage].mean = count > 0 ? sum / (double)count : 0;
    }
    free(values);
}

play_summary play_record_summarise(const play_record *record)
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
    play_summary s = play_record_summarise(record);
    const strandcheck *strands = &record->strands;
    fprintf(file, "\n%zu frames, %.4f s simulated in %" PRIu64 " steps\n", record->frame_count,
            (double)record->frames[record->frame_count - 1].time_us * 1e-6, s.steps);
    for (int stage = 0; stage < PLAY_STAGES; stage++) {
        fprintf(file, "%-14s p50 %.0f, p99 %.0f, mean %.0f\n", PLAY_STAGE_NAMES[stage], s.stages[stage].p50,
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
