/* run.c: a head of hair goes through a clip, step by step, with a clock beside it.
 *
 * Half a second of holding still goes before the clip, unmeasured: caches and branch predictors warm up, and the
 * single-level method splits all that it will ever split. Strands are evaluated after the clip, so that they take no
 * cache from the steps. Times are processor time of the thread that steps. Every worker measures into arrays of its
 * own; the first one is the caller's thread. */
#include "bench/bench.h"

#include "base/error.h"
#include "progress.h"
#include "quantile.h"

#include <inttypes.h>
#include <pthread.h>
#include <stdlib.h>

enum { WARM_UP_STEPS = 50, EVALUATIONS = 31 };

typedef struct worker {
    const bench_pass *pass;
    pthread_t thread;
    bool started;
    awt_forest *forest;
    double *step_ms; /* [steps] */
    size_t steps;
    progress *bar; /* of the first worker */
    bench_figures figures;
    double active_sum;
    awt_status status;
    awt_error error;
} worker;

awt_params bench_single_level(awt_params params)
{
    params.split_threshold = 0;
    params.residence = 0;
    params.split_budget = 0;
    return params;
}

/* ---- one worker ---- */

static awt_status step_to(worker *w, int64_t time_us, awt_step_stats *stats)
{
    motion_sample pose = motion_at(w->pass->clip, time_us);
    awt_motion m = {.time_us = time_us, .head = pose.head, .body = pose.body};
    awt_status status = awt_forest_move(w->forest, &m, &w->error);
    return status == AWT_OK ? awt_forest_advance(w->forest, time_us, stats, &w->error) : status;
}

static void count_step(worker *w, uint32_t coarse_nodes, const awt_step_stats *stats)
{
    bench_figures *all = &w->figures;
    w->active_sum += stats->active_nodes;
    all->active_max = stats->active_nodes > all->active_max ? stats->active_nodes : all->active_max;
    all->asleep_trees = stats->asleep_trees;
    all->splits += stats->splits;
    all->merges += stats->merges;
    all->unreached_contacts += stats->unreached_contacts;
    all->link_error = stats->link_error > all->link_error ? stats->link_error : all->link_error;
    bool merged = stats->active_nodes == coarse_nodes && all->splits > 0;
    all->merged_at_s = !merged ? -1 : all->merged_at_s < 0 ? (double)stats->time_us * 1e-6 : all->merged_at_s;
}

static void show_step(worker *w, size_t n, const awt_step_stats *stats)
{
    if (w->bar) {
        char text[64];
        snprintf(text, sizeof text, "%.1f s, %" PRIu32 " active", (double)stats->time_us * 1e-6, stats->active_nodes);
        progress_show(w->bar, (double)(n + 1) / (double)w->steps, text);
    }
}

static void *worker_run(void *argument)
{
    worker *w = argument;
    awt_groom_info info;
    awt_groom_get_info(w->pass->groom, &info);
    awt_step_stats stats;
    for (int64_t n = 1 - WARM_UP_STEPS; n <= 0 && w->status == AWT_OK; n++) {
        w->status = step_to(w, n * AWT_STEP_US, &stats);
    }
    w->figures.merged_at_s = -1;
    for (size_t n = 0; n < w->steps && w->status == AWT_OK; n++) {
        double begin = bench_thread_ms();
        w->status = step_to(w, (int64_t)(n + 1) * AWT_STEP_US, &stats);
        w->step_ms[n] = bench_thread_ms() - begin;
        count_step(w, info.coarse_nodes, &stats);
        show_step(w, n, &stats);
    }
    return NULL;
}

static awt_status worker_init(worker *w, const bench_pass *pass, double *step_ms, size_t steps)
{
    *w = (worker){.pass = pass, .step_ms = step_ms, .steps = steps};
    awt_forest_def def = awt_forest_def_default(pass->groom);
    motion_sample pose = motion_at(pass->clip, 0);
    def.params = pass->params;
    def.start = (awt_motion){.time_us = -WARM_UP_STEPS * AWT_STEP_US, .head = pose.head, .body = pose.body};
    return awt_forest_create(pass->groom, &def, &w->forest, &w->error);
}

/* ---- all of them ---- */

/* The first worker runs here, the others beside it. */
static awt_status workers_run(worker *workers, uint32_t count, awt_error *error)
{
    awt_status status = AWT_OK;
    for (uint32_t k = 1; k < count && status == AWT_OK; k++) {
        workers[k].started = pthread_create(&workers[k].thread, NULL, worker_run, &workers[k]) == 0;
        if (!workers[k].started) {
            status = error_set(error, AWT_NO_MEMORY, "this machine gives no thread for worker %u", k + 1);
        }
    }
    if (status == AWT_OK) {
        worker_run(&workers[0]);
    }
    for (uint32_t k = 0; k < count; k++) {
        if (workers[k].started) {
            pthread_join(workers[k].thread, NULL);
        }
        if (status == AWT_OK && workers[k].status != AWT_OK) {
            status = workers[k].status;
            *error = workers[k].error;
        }
    }
    return status;
}

static double mean_of(const double *values, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        sum += values[i];
    }
    return sum / (double)count;
}

/* The figures of all workers' steps; `step_ms` is in the workers' order, and sorted afterwards. */
static bench_figures workers_sum_up(const worker *workers, uint32_t count, double *step_ms)
{
    const worker *first = &workers[0];
    const size_t steps = first->steps, second = (size_t)(1000000 / AWT_STEP_US), last = steps < second ? steps : second;
    bench_figures all = first->figures;
    for (uint32_t k = 0; k < count; k++) {
        all.last_second_ms += mean_of(workers[k].step_ms + steps - last, last) / count;
    }
    all.step_ms.mean = mean_of(step_ms, count * steps);
    all.active_mean = first->active_sum / (double)steps;
    all.active_ns = all.step_ms.mean * 1e6 / all.active_mean;
    all.forest_bytes = awt_forest_bytes(first->forest);
    quantile_sort(step_ms, count * steps);
    all.step_ms.p50 = quantile_at(step_ms, count * steps, 0.5);
    all.step_ms.p99 = quantile_at(step_ms, count * steps, 0.99);
    all.step_ms.max = quantile_at(step_ms, count * steps, 1);
    return all;
}

/* ---- strands ---- */

/* The median times of the guides and of the strand kernel, each by itself. */
static awt_status evaluate(const awt_forest *forest, bench_figures *out, awt_error *error)
{
    const awt_groom *groom = awt_forest_groom(forest);
    awt_groom_info info;
    awt_groom_get_info(groom, &info);
    const size_t points = (size_t)info.strand_count * info.points_per_strand;
    const size_t scratch_floats = awt_groom_strand_scratch(groom);
    double guides_ms[EVALUATIONS], strands_ms[EVALUATIONS];
    float *centres = malloc((7 * (size_t)info.finest_nodes + scratch_floats + 3 * points) * sizeof *centres);
    if (!centres) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    float *frames = centres + 3 * (size_t)info.finest_nodes, *scratch = frames + 4 * (size_t)info.finest_nodes;
    for (int n = 0; n < EVALUATIONS; n++) {
        double begin = bench_thread_ms();
        awt_forest_guides(forest, centres, frames);
        double between = bench_thread_ms();
        awt_groom_strands(groom, centres, frames, scratch, scratch + scratch_floats);
        guides_ms[n] = between - begin;
        strands_ms[n] = bench_thread_ms() - between;
    }
    free(centres);
    quantile_sort(guides_ms, EVALUATIONS);
    quantile_sort(strands_ms, EVALUATIONS);
    out->guide_ns = quantile_at(guides_ms, EVALUATIONS, 0.5) * 1e6 / info.finest_nodes;
    out->point_ns = quantile_at(strands_ms, EVALUATIONS, 0.5) * 1e6 / (double)points;
    return AWT_OK;
}

awt_status bench_run(const bench_pass *pass, bench_figures *out, awt_error *error)
{
    const size_t steps = (size_t)(pass->length_us / AWT_STEP_US);
    worker *workers = calloc(pass->workers, sizeof *workers);
    double *step_ms = calloc(pass->workers * steps, sizeof *step_ms);
    progress bar = progress_begin(stderr, pass->label, false);
    awt_status status = workers && step_ms ? AWT_OK : error_set(error, AWT_NO_MEMORY, NULL);
    for (uint32_t k = 0; status == AWT_OK && k < pass->workers; k++) {
        status = worker_init(&workers[k], pass, step_ms + k * steps, steps);
        if (status != AWT_OK) {
            *error = workers[k].error;
        }
    }
    if (status == AWT_OK) {
        workers[0].bar = &bar;
        status = workers_run(workers, pass->workers, error);
    }
    progress_hide(&bar);
    if (status == AWT_OK) {
        *out = workers_sum_up(workers, pass->workers, step_ms);
        status = evaluate(workers[0].forest, out, error);
    }
    for (uint32_t k = 0; workers && k < pass->workers; k++) {
        awt_forest_destroy(workers[k].forest);
    }
    free(workers);
    free(step_ms);
    return status;
}
