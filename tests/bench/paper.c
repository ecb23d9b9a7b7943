/* paper.c: the paper's §5.2: mean time of a step for the four styles, all finest wisps simulated (single level)
 * against the AWT, with the same motion, in the same run, by the same code. */
#include "bench/plan.h"

#include "base/version.h"
#include "files.h"
#include "jsonout.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct style_figures {
    awt_groom_info info;
    bench_figures single, awt;
} style_figures;

static awt_groom *paper_groom(const paper_plan *plan, const awt_style *style, awt_error *error)
{
    awt_groom_def def = awt_groom_def_of_style(style);
    awt_strands strands = {0};
    awt_groom *groom = NULL;
    def.points_per_strand = plan->points;
    if (awt_style_grow(style, plan->strands, 1, &strands, error) == AWT_OK) {
        awt_groom_build(&strands, &def, NULL, NULL, &groom, error);
    }
    awt_strands_fini(&strands);
    return groom;
}

/* One line of the table. False: why has been said. */
static bool paper_measure(const paper_plan *plan, const awt_style *style, style_figures *out)
{
    awt_error error = {0};
    awt_groom *groom = paper_groom(plan, style, &error);
    bool done = groom != NULL;
    if (groom) {
        char label[64];
        bench_pass pass = {.label = label,
                           .groom = groom,
                           .clip = &plan->clip,
                           .length_us = plan->length_us,
                           .workers = plan->workers};
        awt_params params = paper_plan_params(plan, style);
        awt_groom_get_info(groom, &out->info);
        snprintf(label, sizeof label, "%s, single level", style->name);
        pass.params = bench_single_level(params);
        done = bench_run(&pass, &out->single, &error) == AWT_OK;
        snprintf(label, sizeof label, "%s, AWT", style->name);
        pass.params = params;
        done = done && bench_run(&pass, &out->awt, &error) == AWT_OK;
    }
    awt_groom_destroy(groom);
    if (!done) {
        fprintf(stderr, "awt-bench paper: %s: %s\n", style->name, error.text);
    }
    return done;
}

/* What each further head of the same groom costs, per finest node and per strand. */
static double bytes_per_node(const style_figures *f)
{
    return (double)f->awt.forest_bytes / f->info.finest_nodes;
}

static double bytes_per_strand(const style_figures *f)
{
    return (double)f->awt.forest_bytes / f->info.strand_count;
}

/* ---- the table ---- */

static void table_head(FILE *text, const paper_plan *plan)
{
    fprintf(text, "%s\n%.2f s in steps of %d ms, %" PRIu32 " strands of %" PRIu32 " points, %" PRIu32 " worker%s\n\n",
            plan->clip.description, (double)plan->length_us * 1e-6, (int)(AWT_STEP_US / 1000), plan->strands,
            plan->points, plan->workers, plan->workers == 1 ? "" : "s");
    fputs("                           |  single level, ms    |            AWT, ms           |       |  active nodes |"
          "                      |         ns per    |   memory of a forest\n"
          "style            N L coarse |   mean    p99    max |   mean    p99    max last s | ratio |    mean    max |"
          " splits merges merged |  node guide point |   MiB  B/node B/strand\n",
          text);
}

static void table_row(FILE *text, const awt_style *style, const style_figures *f)
{
    const bench_spread *single = &f->single.step_ms, *awt = &f->awt.step_ms;
    char merged[16] = "-";
    if (f->awt.merged_at_s >= 0) {
        snprintf(merged, sizeof merged, "%.2f s", f->awt.merged_at_s);
    }
    fprintf(text,
            "%-12s %5" PRIu32 " %" PRIu32 " %6" PRIu32 " | %6.3f %6.3f %6.3f | %6.3f %6.3f %6.3f %6.3f | %4.1fx | "
            "%7.0f %6" PRIu32 " | %6" PRIu32 " %6" PRIu32 " %6s | %5.0f %5.1f %5.2f | %5.2f %7.0f %8.0f\n",
            style->name, f->info.finest_nodes, f->info.levels, f->info.coarse_nodes, single->mean, single->p99,
            single->max, awt->mean, awt->p99, awt->max, f->awt.last_second_ms, single->mean / awt->mean,
            f->awt.active_mean, f->awt.active_max, f->awt.splits, f->awt.merges, merged, f->awt.active_ns,
            f->awt.guide_ns, f->awt.point_ns, (double)f->awt.forest_bytes / 1048576, bytes_per_node(f),
            bytes_per_strand(f));
    fflush(text);
}

/* ---- the same as JSON ---- */

static void json_spread(jsonout *j, const char *key, const bench_spread *spread)
{
    jsonout_object(j, key);
    jsonout_real(j, "mean", spread->mean);
    jsonout_real(j, "p50", spread->p50);
    jsonout_real(j, "p99", spread->p99);
    jsonout_real(j, "max", spread->max);
    jsonout_close(j);
}

static void json_active(jsonout *j, const char *key, const bench_figures *f)
{
    jsonout_object(j, key);
    jsonout_real(j, "mean", f->active_mean);
    jsonout_unsigned(j, "max", f->active_max);
    jsonout_close(j);
}

static void json_style(jsonout *j, const awt_style *style, const style_figures *f)
{
    jsonout_object(j, NULL);
    jsonout_text(j, "name", style->name);
    jsonout_unsigned(j, "finest_nodes", f->info.finest_nodes);
    jsonout_unsigned(j, "levels", f->info.levels);
    jsonout_unsigned(j, "coarse_nodes", f->info.coarse_nodes);
    json_spread(j, "single_ms", &f->single.step_ms);
    json_spread(j, "awt_ms", &f->awt.step_ms);
    jsonout_real(j, "ratio", f->single.step_ms.mean / f->awt.step_ms.mean);
    json_active(j, "active", &f->awt);
    json_active(j, "single_active", &f->single);
    jsonout_unsigned(j, "splits", f->awt.splits);
    jsonout_unsigned(j, "merges", f->awt.merges);
    jsonout_real(j, "merged_at_s", f->awt.merged_at_s >= 0 ? f->awt.merged_at_s : NAN); /* null: not */
    jsonout_real(j, "last_second_ms", f->awt.last_second_ms);
    jsonout_unsigned(j, "top_wisps", f->info.wisp_count[0]);
    jsonout_unsigned(j, "asleep_trees", f->awt.asleep_trees);
    jsonout_real(j, "ns_per_active_node", f->awt.active_ns);
    jsonout_real(j, "single_ns_per_active_node", f->single.active_ns);
    jsonout_real(j, "ns_per_guide", f->awt.guide_ns);
    jsonout_real(j, "ns_per_strand_point", f->awt.point_ns);
    jsonout_real(j, "forest_bytes_per_finest_node", bytes_per_node(f));
    jsonout_real(j, "forest_bytes_per_strand", bytes_per_strand(f));
    jsonout_real(j, "groom_bytes_per_strand", (double)f->info.bytes / f->info.strand_count);
    jsonout_float(j, "link_error", f->awt.link_error);
    jsonout_unsigned(j, "unreached_contacts", f->awt.unreached_contacts);
    jsonout_close(j);
}

static bool json_document_to(FILE *file, const paper_plan *plan, const style_figures *figures)
{
    jsonout j = jsonout_begin(file);
    jsonout_object(&j, NULL);
    jsonout_text(&j, "version", AWTD_VERSION);
    jsonout_text(&j, "motion", plan->motion_name);
    jsonout_real(&j, "seconds", (double)plan->length_us * 1e-6);
    jsonout_unsigned(&j, "strands", plan->strands);
    jsonout_unsigned(&j, "points_per_strand", plan->points);
    jsonout_unsigned(&j, "workers", plan->workers);
    jsonout_real(&j, "theta", plan->theta >= 0 ? plan->theta : NAN);                            /* null: the style's */
    jsonout_text(&j, "links", plan->links < 0 ? NULL : plan->links == 1 ? "springs" : "rigid"); /* likewise */
    jsonout_array(&j, "styles");
    for (size_t s = 0; s < plan->style_count; s++) {
        json_style(&j, plan->styles[s], &figures[s]);
    }
    jsonout_close(&j);
    jsonout_close(&j);
    return jsonout_done(&j);
}

/* To standard output, or to a file whole or not at all. */
static bool json_write(const paper_plan *plan, const style_figures *figures)
{
    char *text = NULL, error[512] = "not enough memory for the JSON text";
    size_t size = 0;
    if (plan->json[0] == '-' && plan->json[1] == '\0') {
        return json_document_to(stdout, plan, figures);
    }
    FILE *memory = open_memstream(&text, &size);
    bool done = memory && json_document_to(memory, plan, figures);
    done = memory && fclose(memory) == 0 && done && files_write(plan->json, text, size, error, sizeof error);
    if (!done) {
        fprintf(stderr, "awt-bench paper: %s\n", error);
    }
    free(text);
    return done;
}

int bench_paper(int argc, char *const *argv)
{
    paper_plan plan;
    int code;
    if (!paper_plan_read(argc, argv, &plan, &code)) {
        return code;
    }
    style_figures figures[PAPER_MAX_STYLES];
    FILE *text = plan.json && plan.json[0] == '-' && plan.json[1] == '\0' ? stderr : stdout;
    table_head(text, &plan);
    bool done = true;
    for (size_t s = 0; done && s < plan.style_count; s++) {
        done = paper_measure(&plan, plan.styles[s], &figures[s]);
        if (done) {
            table_row(text, plan.styles[s], &figures[s]);
        }
    }
    done = done && (!plan.json || json_write(&plan, figures));
    paper_plan_fini(&plan);
    return done ? 0 : 1;
}
