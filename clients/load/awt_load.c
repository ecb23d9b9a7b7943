/* awt_load.c: awt-load: makes the load, shows how far it is, says what came of it. Exit codes: 0 fine, 1 failed or with
 * errors, 2 wrong usage. */
#include "load/crew.h"
#include "load/descriptors.h"
#include "load/floor.h"
#include "load/idle.h"
#include "load/report.h"
#include "load/scenario.h"
#include "load/wait.h"
#include "progress.h"

#include <stdlib.h>
#include <string.h>

enum { GATHER_NS_A_LINK = 20000000, TEND_NS = 1000000000 };
#define GATHER_LEAST_NS INT64_C(20000000000)

/* What the callback of crew_run shows with. */
static struct {
    progress bar;
    int64_t tended_ns;
    double done, share; /* of the whole, before this round and of it */
} shown;

static void show(load_run *run, int64_t at_ns)
{
    char text[96];
    awtclient_error error;
    const load_mode mode = run->busy_s[LOAD_PLAIN] > 0 ? LOAD_LADEN : LOAD_PLAIN; /* the second round is laden */
    const hdr *h = run->book.latency[mode];
    const double round = (double)at_ns / (double)(run->line.slices * run->line.slice_ns);
    snprintf(text, sizeof text, "%llu answers, p50 %.0f us, p99 %.0f us, %llu errors", (unsigned long long)hdr_count(h),
             (double)hdr_at(h, 0.5) * 1e-3, (double)hdr_at(h, 0.99) * 1e-3,
             (unsigned long long)atomic_load(&run->book.errors));
    progress_show(&shown.bar, shown.done + shown.share * round, text);
    if (wait_now_ns() - shown.tended_ns > TEND_NS) {
        shown.tended_ns = wait_now_ns();
        if (!heads_tend(&run->heads, &error)) {
            book_error(&run->book, "%s", error.text);
            atomic_store(&run->failed, true);
        }
    }
}

/* One round through the line. */
static bool round_run(load_run *run, crew *c, double done, double share)
{
    shown.done = done;
    shown.share = share;
    shown.tended_ns = wait_now_ns();
    const bool good = crew_run(c, show) && !atomic_load(&run->failed);
    for (int mode = 0; mode < LOAD_MODES; mode++) {
        run->busy_s[mode] += timeline_busy_s(&run->line, (load_mode)mode);
    }
    return good;
}

/* Without idle connections first, then with them, so that the one is the other's measure. */
static bool round_laden(load_run *run, crew *c, uint32_t descriptors)
{
    const load_plan *p = run->plan;
    const uint32_t used = scenario_descriptors(run), most = descriptors > used ? descriptors - used : 0;
    idle *held = idle_open(run, p->idle < most ? p->idle : most, &run->idle);
    timeline_make(&run->line, 0, p->duration_ns, run->floor != NULL, true, 0);
    const bool good = held && round_run(run, c, 0.5, 0.5);
    idle_close(held);
    return good;
}

static bool measure(load_run *run, uint32_t descriptors)
{
    const load_plan *p = run->plan;
    crew *c = crew_create(run, p->threads);
    timeline_make(&run->line, p->settle_ns, p->duration_ns, run->floor != NULL, false, p->pairs);
    const bool laden = p->scenario == LOAD_IDLE;
    bool good = c && scenario_fill(run, c) && crew_gather(c, GATHER_LEAST_NS + p->connections * GATHER_NS_A_LINK);
    shown.bar = progress_begin(stderr, "load", p->quiet);
    good = good && round_run(run, c, 0, laden ? 0.5 : 1);
    good = good && (!laden || round_laden(run, c, descriptors));
    progress_hide(&shown.bar);
    crew_destroy(c);
    return good;
}

static bool enough_descriptors(const load_run *run, uint32_t descriptors)
{
    const uint32_t needed = scenario_descriptors(run);
    if (needed > descriptors) {
        fprintf(stderr, "awt-load: %u descriptors are needed, and the system gives %u (ulimit -n)\n", needed,
                descriptors);
    }
    return needed <= descriptors;
}

static bool load(const load_plan *plan, const char *floor, uint32_t descriptors)
{
    static load_run run;
    awtclient_error error = {0};
    run.plan = plan;
    run.floor = floor;
    if (!enough_descriptors(&run, descriptors)) {
        return false;
    }
    if (!book_init(&run.book, plan->pairs > 0 ? TIMELINE_MAX_SLICES : 0)) {
        fputs("awt-load: not enough memory\n", stderr);
        book_fini(&run.book);
        return false;
    }
    bool good = heads_open(&run.heads, plan, &error);
    if (!good) {
        fprintf(stderr, "awt-load: %s\n", error.text);
    } else if (!(good = measure(&run, descriptors))) {
        fprintf(stderr, "awt-load: %s\n", book_error_text(&run.book));
    } else {
        const bool json_on_stdout = plan->json && strcmp(plan->json, "-") == 0;
        report_table(&run, json_on_stdout ? stderr : stdout);
        good = report_files(&run) && atomic_load(&run.book.errors) == 0;
    }
    heads_close(&run.heads);
    book_fini(&run.book);
    return good;
}

/* `place`: HOST:PORT, or a port alone, of the loopback. */
static int serve_floor(const char *place)
{
    char bound[FLOOR_ADDRESS], error[256], address[300];
    snprintf(address, sizeof address, "%s%s", strchr(place, ':') ? "" : "127.0.0.1:", place);
    const int listener = floor_listen(address, bound, error, sizeof error);
    if (listener < 0) {
        fprintf(stderr, "awt-load: %s\n", error);
        return 1;
    }
    printf("listening on %s\n", bound);
    fflush(stdout);
    floor_serve(listener, -1);
    return 1; /* it only ends for want of memory */
}

int main(int argc, char **argv)
{
    load_plan plan;
    floor_process floor = {0};
    char error[256];
    const load_asked asked = load_plan_read(argc > 0 ? argc - 1 : 0, argv + (argc > 0), &plan);
    if (asked != LOAD_RUN) {
        return asked == LOAD_DONE ? 0 : 2;
    }
    const uint32_t descriptors = descriptors_raise();
    if (plan.floor_server) {
        return serve_floor(plan.floor_server);
    }
    if (!plan.no_floor && !plan.floor && !floor_start(&floor, error, sizeof error)) {
        fprintf(stderr, "awt-load: %s\n", error);
        return 1;
    }
    const bool good = load(&plan, plan.no_floor ? NULL : plan.floor ? plan.floor : floor.address, descriptors);
    floor_stop(&floor);
    return good ? 0 : 1;
}
