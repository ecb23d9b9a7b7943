/* paper.c: the paper's §5.2: mean time of a step for the four styles, all finest GCs simulated against the AWT, with
 * the same motion in the same run. Strands are evaluated apart and reported by point. Contact between wisps is not
 * simulated yet, in neither method. */
#include "bench/bench.h"

#include "awt.h"
#include "base/options.h"
#include "base/version.h"
#include "motion/motion.h"
#include "progress.h"
#include "quantile.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { EVALUATE_EVERY = 10 };

typedef struct run_result {
    double mean_ms, p99_ms, max_ms;
    double active_mean, ns_per_active;
    uint32_t active_max, splits, merges;
    double merged_at_s;  /* all merged again from here on; < 0: not */
    double ns_per_point; /* of a strand */
} run_result;

static double now_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

/* Time to evaluate all strands once, ms. */
static double evaluate_ms(const awt_forest *forest, float *memory)
{
    const awt_groom *groom = awt_forest_groom(forest);
    awt_groom_info info;
    awt_groom_get_info(groom, &info);
    float *centres = memory, *frames = centres + 3 * (size_t)info.finest_nodes,
          *scratch = frames + 4 * (size_t)info.finest_nodes;
    double begin = now_ms();
    awt_forest_guides(forest, centres, frames);
    awt_groom_strands(groom, centres, frames, scratch, scratch + awt_groom_strand_scratch(groom));
    return now_ms() - begin;
}

static size_t evaluate_floats(const awt_groom *groom, const awt_groom_info *info)
{
    return 7 * (size_t)info->finest_nodes + awt_groom_strand_scratch(groom) +
           3 * (size_t)info->strand_count * info->points_per_strand;
}

static bool run_clip(awt_forest *forest, const motion *clip, int64_t length_us, float *memory, progress *bar,
                     run_result *out)
{
    awt_groom_info info;
    awt_groom_get_info(awt_forest_groom(forest), &info);
    size_t steps = (size_t)(length_us / AWT_STEP_US), evaluations = 0;
    double *times = malloc(steps * sizeof *times), sum = 0, evaluate_sum = 0, active_sum = 0;
    if (!times) {
        return false;
    }
    *out = (run_result){.merged_at_s = -1};
    for (size_t n = 0; n < steps; n++) {
        int64_t time_us = (int64_t)(n + 1) * AWT_STEP_US;
        motion_sample pose = motion_at(clip, time_us);
        awt_motion m = {.time_us = time_us, .head = pose.head, .body = pose.body};
        awt_step_stats stats;
        double begin = now_ms();
        awt_forest_move(forest, &m, NULL);
        awt_forest_advance(forest, time_us, &stats, NULL);
        times[n] = now_ms() - begin;
        sum += times[n];
        active_sum += stats.active_nodes;
        out->active_max = stats.active_nodes > out->active_max ? stats.active_nodes : out->active_max;
        out->splits += stats.splits;
        out->merges += stats.merges;
        bool merged = stats.active_nodes == info.coarse_nodes && out->splits > 0;
        out->merged_at_s = !merged ? -1 : out->merged_at_s < 0 ? (double)time_us * 1e-6 : out->merged_at_s;
        if (n % EVALUATE_EVERY == 0) {
            evaluate_sum += evaluate_ms(forest, memory);
            evaluations++;
        }
        char text[64];
        snprintf(text, sizeof text, "%.1f s, %u active", (double)time_us * 1e-6, stats.active_nodes);
        progress_show(bar, (double)(n + 1) / (double)steps, text);
    }
    quantile_sort(times, steps);
    out->mean_ms = sum / (double)steps;
    out->p99_ms = quantile_at(times, steps, 0.99);
    out->max_ms = quantile_at(times, steps, 1);
    out->active_mean = active_sum / (double)steps;
    out->ns_per_active = sum * 1e6 / active_sum;
    out->ns_per_point = evaluate_sum * 1e6 / (double)evaluations / ((double)info.strand_count * info.points_per_strand);
    free(times);
    return true;
}

/* One style, single level or AWT. */
static bool run_style(const awt_groom *groom, const awt_style *style, bool single, const motion *clip,
                      int64_t length_us, float *memory, run_result *out)
{
    awt_forest_def def = awt_forest_def_default(groom);
    def.params = style->params;
    if (single) { /* everything splits, nothing merges */
        def.params.split_threshold = 0;
        def.params.residence = 0;
    }
    motion_sample start = motion_at(clip, 0);
    def.start = (awt_motion){.head = start.head, .body = start.body};
    awt_forest *forest = NULL;
    if (awt_forest_create(groom, &def, &forest, NULL) != AWT_OK) {
        return false;
    }
    char label[64];
    snprintf(label, sizeof label, "%s, %s", style->name, single ? "single level" : "AWT");
    progress bar = progress_begin(stderr, label, false);
    bool ran = run_clip(forest, clip, length_us, memory, &bar, out);
    progress_hide(&bar);
    awt_forest_destroy(forest);
    return ran;
}

static bool bench_style(const awt_style *style, uint32_t strand_count, const motion *clip, int64_t length_us)
{
    awt_groom_def def = awt_groom_def_of_style(style);
    awt_strands strands = {0};
    awt_groom *groom = NULL;
    float *memory = NULL;
    run_result single, awt;
    bool done = false;
    if (awt_style_grow(style, strand_count, 1, &strands, NULL) == AWT_OK &&
        awt_groom_build(&strands, &def, NULL, NULL, &groom, NULL) == AWT_OK) {
        awt_groom_info info;
        awt_groom_get_info(groom, &info);
        memory = malloc(evaluate_floats(groom, &info) * sizeof *memory);
        done = memory && run_style(groom, style, true, clip, length_us, memory, &single) &&
               run_style(groom, style, false, clip, length_us, memory, &awt);
        if (done) {
            printf("%-12s %6u %2u %6u | %6.3f %6.3f %6.3f | %6.3f %6.3f %6.3f | %5.1fx | %6.0f %6u | %6u %6u %6.2f | "
                   "%6.0f %6.2f\n",
                   style->name, info.finest_nodes, info.levels, info.coarse_nodes, single.mean_ms, single.p99_ms,
                   single.max_ms, awt.mean_ms, awt.p99_ms, awt.max_ms, single.mean_ms / awt.mean_ms, awt.active_mean,
                   awt.active_max, awt.splits, awt.merges, awt.merged_at_s, awt.ns_per_active, awt.ns_per_point);
        }
    }
    free(memory);
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
    return done;
}

int bench_paper(int argc, char *const *argv)
{
    const char *clip_name = "lean";
    long long strands = AWT_DEFAULT_STRANDS;
    double seconds = 10;
    const option options[] = {
        {"motion", OPTION_TEXT, "CLIP", &clip_name, 0, 0, "lean, jump, run or shake"},
        {"strands", OPTION_INTEGER, "N", &strands, 1, AWT_MAX_STRANDS, "strands of each style"},
        {"seconds", OPTION_REAL, "S", &seconds, 0.1, 600, "simulated time"},
    };
    const option_program program = {"awt-bench paper", "The table of the paper's §5.2: times of a 10 ms step, in ms.",
                                    NULL, options, sizeof options / sizeof options[0]};
    char error[160];
    size_t operands;
    switch (options_parse(&program, argc, argv, NULL, 0, &operands, error, sizeof error)) {
    case OPTIONS_HELP:
        options_help(&program, stdout);
        return 0;
    case OPTIONS_VERSION:
        puts("awt-bench " AWTD_VERSION);
        return 0;
    case OPTIONS_WRONG:
        fprintf(stderr, "awt-bench paper: %s\n", error);
        return 2;
    case OPTIONS_RUN:
        break;
    }
    motion clip;
    if (!motion_builtin(clip_name, &clip)) {
        fprintf(stderr, "awt-bench paper: there is no clip \"%s\"; there are lean, jump, run and shake\n", clip_name);
        return 2;
    }
    printf("style             N  L coarse | single mean    p99    max | AWT mean    p99    max |  ratio | active    "
           "max | splits merges merged | ns/node ns/point\n");
    bool done = true;
    for (size_t s = 0; done && s < awt_style_count(); s++) {
        done = bench_style(awt_style_at(s), (uint32_t)strands, &clip, (int64_t)(seconds * 1e6));
    }
    motion_fini(&clip);
    return done ? 0 : 1;
}
