/* report.c: see report.h. */
#include "load/report.h"

#include "files.h"
#include "jsonout.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { REPORT_SHARES = 6 };

static const struct {
    const char *key, *head;
    double share;
} SHARES[REPORT_SHARES] = {{"p50", "p50", 0.5},      {"p90", "p90", 0.9},         {"p99", "p99", 0.99},
                           {"p999", "p99.9", 0.999}, {"p9999", "p99.99", 0.9999}, {"max", "max", 1}};

/* A figure of a histogram, microseconds; not a number where nothing was measured. */
static double figure(const hdr *h, int k)
{
    return hdr_count(h) > 0 ? (double)hdr_at(h, SHARES[k].share) * 1e-3 : NAN;
}

static double rate_of(const load_run *run, const atomic_uint_fast64_t *counts, load_mode mode)
{
    return run->busy_s[mode] > 0 ? (double)atomic_load(&counts[mode]) / run->busy_s[mode] : NAN;
}

static uint64_t of_daemon(const atomic_uint_fast64_t *counts)
{
    return (uint64_t)(atomic_load(&counts[LOAD_PLAIN]) + atomic_load(&counts[LOAD_LADEN]));
}

/* The daemon's slices that the figures are of. */
static load_mode subject_of(const load_run *run)
{
    return run->busy_s[LOAD_LADEN] > 0 ? LOAD_LADEN : LOAD_PLAIN;
}

/* ---- the table --------------------------------------------------------------------------------------------------- */

static void cell(FILE *file, double value)
{
    if (isnan(value)) {
        fprintf(file, " %9s", "-");
    } else {
        fprintf(file, value < 1000 ? " %9.2f" : " %9.0f", value);
    }
}

static void row_of_times(FILE *file, const char *name, double offered, double achieved, const hdr *h)
{
    fprintf(file, "%-16s", name);
    cell(file, offered);
    cell(file, achieved);
    for (int k = 0; k < REPORT_SHARES; k++) {
        cell(file, figure(h, k));
    }
    fputc('\n', file);
}

static void row_of_mode(const load_run *run, FILE *file, const char *name, load_mode mode)
{
    const book *b = &run->book;
    if (run->busy_s[mode] > 0) {
        row_of_times(file, name, rate_of(run, b->due, mode), rate_of(run, b->came, mode), b->latency[mode]);
    }
}

static void row_of_ratios(const load_run *run, FILE *file, const char *name, load_mode over, load_mode under)
{
    const book *b = &run->book;
    if (run->busy_s[over] > 0 && run->busy_s[under] > 0) {
        fprintf(file, "%-16s %9s", name, "");
        cell(file, rate_of(run, b->came, over) / rate_of(run, b->came, under));
        for (int k = 0; k < REPORT_SHARES; k++) {
            cell(file, figure(b->latency[over], k) / figure(b->latency[under], k));
        }
        fputc('\n', file);
    }
}

static void title(const load_run *run, FILE *file)
{
    const load_plan *p = run->plan;
    fprintf(file, "%s: %" PRIu32 " connections", load_scenario_name(p->scenario), p->connections);
    if (run->idle > 0) {
        fprintf(file, " and %" PRIu32 " idle ones", run->idle);
        if (run->idle < p->idle) {
            fprintf(file, " of %" PRIu32 " (%s)", p->idle, run->idle_end[0] ? run->idle_end : "no more descriptors");
        }
    }
    fprintf(file, ", %" PRIu32 " heads of %s, ", p->forests, p->style);
    if (p->closed) {
        fputs("as fast as answers come", file);
    } else {
        fprintf(file, "%g a second %s", p->rate, load_scenario_streams(p->scenario) ? "of each head" : "each");
    }
    fprintf(file, "; %" PRIu64 " bytes each\n\n", book_mean_bytes(&run->book, subject_of(run)));
}

static const char *laden_name(const load_run *run)
{
    return run->plan->scenario == LOAD_IDLE ? "awtd, idle held" : "awtd, stalled";
}

void report_table(const load_run *run, FILE *file)
{
    const book *b = &run->book;
    title(run, file);
    fprintf(file, "%-16s %9s %9s", "microseconds", "offered/s", "came/s");
    for (int k = 0; k < REPORT_SHARES; k++) {
        fprintf(file, " %9s", SHARES[k].head);
    }
    fputc('\n', file);
    row_of_mode(run, file, "awtd", LOAD_PLAIN);
    row_of_mode(run, file, laden_name(run), LOAD_LADEN);
    row_of_mode(run, file, "bare poll()", LOAD_FLOOR);
    row_of_ratios(run, file, "awtd / bare", LOAD_PLAIN, LOAD_FLOOR);
    row_of_ratios(run, file, "laden / bare", LOAD_LADEN, LOAD_FLOOR);
    row_of_ratios(run, file, "laden / awtd", LOAD_LADEN, LOAD_PLAIN);
    row_of_times(file, "age of frames", NAN, NAN, b->age[subject_of(run)]);
    fprintf(file,
            "\nsent late (> 1 ms): %" PRIu64 " to awtd, %" PRIu64 " to the bare server; frames left out: %" PRIu64
            ", stale: %" PRIu64 "\n",
            of_daemon(b->late), (uint64_t)atomic_load(&b->late[LOAD_FLOOR]), of_daemon(b->skipped),
            of_daemon(b->stale));
    if (run->plan->pairs > 0) {
        fprintf(file, "p99 with stalled viewers / without, median of %" PRIu32 " pairs: %.3f\n", run->plan->pairs,
                book_pair_ratio(b, &run->line));
    }
    fprintf(file, "errors: %" PRIu64 "%s%s\n", (uint64_t)atomic_load(&b->errors),
            book_error_text(b)[0] ? ", the first: " : "", book_error_text(b));
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

static void json_times(jsonout *j, const char *key, const hdr *h)
{
    jsonout_object(j, key);
    for (int k = 0; k < REPORT_SHARES; k++) {
        jsonout_real(j, SHARES[k].key, figure(h, k));
    }
    jsonout_close(j);
}

bool report_json(const load_run *run, FILE *file)
{
    const book *b = &run->book;
    const load_mode mode = subject_of(run);
    jsonout j = jsonout_begin(file);
    jsonout_object(&j, NULL);
    jsonout_text(&j, "scenario", load_scenario_name(run->plan->scenario));
    jsonout_unsigned(&j, "connections", run->plan->connections);
    jsonout_real(&j, "offered_per_s", rate_of(run, b->due, mode));
    jsonout_real(&j, "achieved_per_s", rate_of(run, b->came, mode));
    json_times(&j, "latency_us", b->latency[mode]);
    json_times(&j, "floor_us", b->latency[LOAD_FLOOR]);
    json_times(&j, "frame_age_us", b->age[mode]);
    jsonout_unsigned(&j, "late_sends", of_daemon(b->late));
    jsonout_unsigned(&j, "errors", atomic_load(&b->errors));
    jsonout_close(&j);
    return jsonout_done(&j);
}

static bool percentiles(const load_run *run, FILE *file)
{
    return hdr_write(run->book.latency[subject_of(run)], file);
}

/* To standard output ("-"), or to a file whole or not at all. */
static bool write_whole(const char *path, const load_run *run, bool (*fill)(const load_run *run, FILE *file))
{
    char *text = NULL, error[512] = "not enough memory for the text";
    size_t size = 0;
    if (strcmp(path, "-") == 0) {
        return fill(run, stdout) && fflush(stdout) == 0;
    }
    FILE *memory = open_memstream(&text, &size);
    bool done = memory && fill(run, memory);
    done = memory && fclose(memory) == 0 && done && files_write(path, text, size, error, sizeof error);
    if (!done) {
        fprintf(stderr, "awt-load: %s\n", error);
    }
    free(text);
    return done;
}

bool report_files(const load_run *run)
{
    const load_plan *p = run->plan;
    bool done = !p->json || write_whole(p->json, run, report_json);
    return (!p->hdr || write_whole(p->hdr, run, percentiles)) && done;
}
