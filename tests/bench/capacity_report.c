/* capacity_report.c: the cost model as a table and as JSON: see capacity.h. */
#include "bench/capacity.h"

#include "base/version.h"
#include "files.h"
#include "jsonout.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const KINDS[] = {"ribbon", "strands"};
static const char *const LEVELS[] = {"full", "fifth", "guides"};

/* ---- the table ---- */

static void table_parts(FILE *text, const capacity_row *row)
{
    fprintf(text, "%-10s step awake %.3f, asleep %.3f; frame moving %.3f, at rest %.3f; of it sections %.3f ms\n",
            row->style->name, row->awake.step_ms, row->asleep.step_ms, row->awake.frame_ms, row->asleep.frame_ms,
            row->guides_ms);
    fputs("  kind     level  | strands, ms  encode, moving  at rest  write | bytes\n", text);
    for (size_t k = 0; k < ENCODE_SUBJECTS; k++) {
        const encode_row *all = &row->rows[k * ENCODE_MOVINGS], *none = all + ENCODE_NONE;
        fprintf(text, "  %-8s %-6s | %11.3f  %14.3f  %7.3f  %5.3f | %7.0f\n", KINDS[all->kind], LEVELS[all->level],
                all->evaluate_ms, all->encode_ms, none->encode_ms, row->write_ms[k],
                all->bytes_per_point * (double)all->points);
    }
    for (size_t k = 0; k < GUIDES_KINDS; k++) {
        fprintf(text, "  %-15s | %11s  %14.3f  %7s  %5s | %7.0f\n", row->guides[k].name, "", row->guides[k].encode_ms,
                "", "", row->guides[k].bytes);
    }
    const encode_row *delta = &row->rows[ENCODE_WHOLE_ROWS];
    fprintf(text, "  %-15s | %11s  %14.3f  %7.3f  %5s | %7.0f\n", "strands delta", "", delta->encode_ms,
            delta[ENCODE_NONE].encode_ms, "", delta->bytes_per_point * (double)delta->points);
}

static void table(FILE *text, const capacity_plan *plan, const capacity_row *rows)
{
    fprintf(text, "%u strands, one core; steps and frames (%s, %s) of %u heads by turns, means; ", plan->strands,
            KINDS[plan->kind], LEVELS[plan->level], plan->heads);
    fputs("parts of frames alone, medians\n\n", text);
    for (size_t k = plan->first; k < plan->end; k++) {
        table_parts(text, &rows[k]);
    }
    fprintf(text, "\n%d frames of %s, %s (at rest %d), to %u viewers and %d steps a second:\n", ENCODE_FRAME_RATE,
            KINDS[plan->kind], LEVELS[plan->level], CAPACITY_REST_RATE, plan->viewers, CAPACITY_STEP_RATE);
    fputs("           | ms a second of a head | heads a core, of which move\n"
          "style      |     moving    at rest |    none     10 %    100 %\n",
          text);
    for (size_t k = plan->first; k < plan->end; k++) {
        const capacity_row *row = &rows[k];
        fprintf(text, "%-10s | %10.2f %10.2f | %7.1f  %7.1f  %7.1f\n", row->style->name, row->moving_ms, row->still_ms,
                row->heads[0], row->heads[1], row->heads[2]);
    }
}

/* ---- the same as JSON ---- */

static void json_frame(jsonout *j, const capacity_row *row, size_t k)
{
    const encode_row *all = &row->rows[k * ENCODE_MOVINGS], *none = all + ENCODE_NONE;
    jsonout_object(j, NULL);
    jsonout_text(j, "kind", KINDS[all->kind]);
    jsonout_text(j, "level", LEVELS[all->level]);
    jsonout_real(j, "evaluate_ms", all->evaluate_ms);
    jsonout_real(j, "encode_moving_ms", all->encode_ms);
    jsonout_real(j, "encode_still_ms", none->encode_ms);
    jsonout_real(j, "write_ms", row->write_ms[k]);
    jsonout_real(j, "bytes", all->bytes_per_point * (double)all->points);
    jsonout_close(j);
}

static void json_guides(jsonout *j, const guides_row *guides)
{
    jsonout_object(j, NULL);
    jsonout_text(j, "name", guides->name);
    jsonout_real(j, "encode_ms", guides->encode_ms);
    jsonout_real(j, "bytes", guides->bytes);
    jsonout_close(j);
}

static void json_row(jsonout *j, const capacity_row *row)
{
    jsonout_object(j, NULL);
    jsonout_text(j, "style", row->style->name);
    jsonout_real(j, "step_awake_ms", row->awake.step_ms);
    jsonout_real(j, "step_asleep_ms", row->asleep.step_ms);
    jsonout_real(j, "frame_moving_ms", row->awake.frame_ms);
    jsonout_real(j, "frame_still_ms", row->asleep.frame_ms);
    jsonout_real(j, "sections_ms", row->guides_ms);
    jsonout_array(j, "frames");
    for (size_t k = 0; k < ENCODE_SUBJECTS; k++) {
        json_frame(j, row, k);
    }
    jsonout_close(j);
    jsonout_array(j, "guides");
    for (size_t k = 0; k < GUIDES_KINDS; k++) {
        json_guides(j, &row->guides[k]);
    }
    jsonout_close(j);
    jsonout_real(j, "delta_encode_ms", row->rows[ENCODE_WHOLE_ROWS].encode_ms);
    jsonout_real(j, "moving_ms_a_second", row->moving_ms);
    jsonout_real(j, "still_ms_a_second", row->still_ms);
    jsonout_reals(j, "heads_per_core", row->heads, CAPACITY_SHARES);
    jsonout_close(j);
}

static bool json_to(FILE *file, const capacity_plan *plan, const capacity_row *rows)
{
    jsonout j = jsonout_begin(file);
    jsonout_object(&j, NULL);
    jsonout_text(&j, "version", AWTD_VERSION);
    jsonout_unsigned(&j, "strands", plan->strands);
    jsonout_unsigned(&j, "heads", plan->heads);
    jsonout_text(&j, "kind", KINDS[plan->kind]);
    jsonout_text(&j, "level", LEVELS[plan->level]);
    jsonout_unsigned(&j, "viewers", plan->viewers);
    jsonout_reals(&j, "moving", CAPACITY_MOVING, CAPACITY_SHARES);
    jsonout_array(&j, "styles");
    for (size_t k = plan->first; k < plan->end; k++) {
        json_row(&j, &rows[k]);
    }
    jsonout_close(&j);
    jsonout_close(&j);
    return jsonout_done(&j);
}

/* To standard output, or to a file whole or not at all. */
static bool json_write(const capacity_plan *plan, const capacity_row *rows)
{
    char *text = NULL, error[512] = "not enough memory for the JSON text";
    size_t size = 0;
    if (strcmp(plan->json, "-") == 0) {
        return json_to(stdout, plan, rows);
    }
    FILE *memory = open_memstream(&text, &size);
    bool done = memory && json_to(memory, plan, rows);
    done = memory && fclose(memory) == 0 && done && files_write(plan->json, text, size, error, sizeof error);
    if (!done) {
        fprintf(stderr, "awt-bench capacity: %s\n", error);
    }
    free(text);
    return done;
}

bool capacity_report(const capacity_plan *plan, const capacity_row *rows)
{
    table(plan->json && strcmp(plan->json, "-") == 0 ? stderr : stdout, plan, rows);
    return !plan->json || json_write(plan, rows);
}
