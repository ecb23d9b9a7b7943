/* bench.h: what awt-bench's subcommands are, and what they share: the pass of a head of hair through a clip. */
#ifndef BENCH_H
#define BENCH_H

#include "awt.h"
#include "base/options.h"
#include "motion/motion.h"

#include <time.h>

enum { BENCH_MAX_WORKERS = 64 };

/* Arguments without the subcommand's name; the exit code. */
int bench_paper(int argc, char *const *argv);
int bench_encode(int argc, char *const *argv);
int bench_soak(int argc, char *const *argv);
int bench_capacity(int argc, char *const *argv);

/* How the values of a list lie. */
typedef struct bench_spread {
    double mean, p50, p99, max;
} bench_spread;

/* One pass: `workers` forests alike, stepped at once, each on a thread of its own. */
typedef struct bench_pass {
    const char *label; /* for the progress */
    const awt_groom *groom;
    awt_params params;
    const motion *clip;
    int64_t length_us;
    uint32_t workers; /* 1 .. BENCH_MAX_WORKERS */
} bench_pass;

/* Times are those of all workers' steps; what happened in the simulation is the same for all, and told once. */
typedef struct bench_figures {
    bench_spread step_ms;
    double last_second_ms;         /* mean of the clip's last second: asleep, if the clip ends so */
    double active_mean, active_ns; /* active nodes; time for each of them in a step */
    uint32_t active_max, splits, merges, unreached_contacts;
    double merged_at_s; /* all merged from here to the end; < 0: never */
    float link_error;
    uint32_t asleep_trees; /* at the end */
    size_t forest_bytes;
    double guide_ns; /* awt_forest_guides by finest node, in the state at the end */
    double point_ns; /* awt_groom_strands by strand point */
} bench_figures;

/* AWT_NO_MEMORY (of threads, too), or what the forest says. */
awt_status bench_run(const bench_pass *pass, bench_figures *out, awt_error *error);

/* Parameters of the single-level method: everything has split, nothing merges. */
awt_params bench_single_level(awt_params params);

/* Milliseconds of a clock that only goes on. */
static inline double bench_now_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

/* Processor time of this thread: what work costs, whatever else the machine does meanwhile. */
static inline double bench_thread_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

#endif
