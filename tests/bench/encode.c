/* encode.c: awt-bench encode: its command line, its table, its JSON. */
#include "bench/encode.h"

#include "base/options.h"
#include "base/version.h"
#include "files.h"
#include "jsonout.h"
#include "motion/load.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const KINDS[] = {"ribbon", "strands"};
static const char *const LEVELS[] = {"full", "fifth", "guides"};
static const char *const MOVINGS[] = {"all", "quarter", "none"};

static double mbit_s(const encode_row *row)
{
    return row->bytes_per_point * (double)row->points * 8 * ENCODE_FRAME_RATE * 1e-6;
}

/* ---- the table ---- */

/* "strands" or, of deltas, "strands-1": the base's age. */
static const char *row_name(const encode_row *row, char name[16])
{
    if (row->base_age > 0) {
        snprintf(name, 16, "%s-%u", KINDS[row->kind], row->base_age % 10);
    } else {
        snprintf(name, 16, "%s", KINDS[row->kind]);
    }
    return name;
}

static void table(FILE *text, const encode_plan *plan, const encode_row rows[ENCODE_ROWS])
{
    fprintf(text, "%s, %s: %u frames from %.2f s on, one core, medians\n\n",
            plan->groom_file ? plan->groom_file : plan->style->name, plan->clip.description, plan->frames,
            (double)plan->begin_us * 1e-6);
    fputs("                                   |        encode, ms       |       | million  |  bytes a point  | entropy "
          "| error |"
          "  decode, ms   | Mbit/s\n"
          "kind      level  bits moving  pat. |   ours  stock vertices | ratio | points/s |   ours    stock | bits/pt "
          "|    mm |"
          "   ours  stock | at 60 Hz\n",
          text);
    for (int i = 0; i < ENCODE_ROWS; i++) {
        const encode_row *r = &rows[i];
        char name[16];
        fprintf(text,
                "%-9s %-6s %4d %-7s %4u | %6.3f %6.2f %8.3f | %4.1fx | %8.1f | %6.3f   %6.3f | %7.2f | %5.3f | %6.2f "
                "%6.2f | "
                "%6.1f\n",
                row_name(r, name), LEVELS[r->level], r->quantisation_bits, MOVINGS[r->moving], r->patches, r->encode_ms,
                r->stock_encode_ms, r->vertices_ms, r->stock_encode_ms / r->encode_ms,
                (double)r->points / r->encode_ms * 1e-3, r->bytes_per_point, r->stock_bytes_per_point,
                r->entropy_bits_per_point, r->max_error_mm, r->decode_ms, r->stock_decode_ms, mbit_s(r));
    }
    fputs("\nstrands-1, strands-3: deltas to the frame before, and to the third one before\n", text);
    fputs("strands of a level evaluated, ms:", text);
    for (int level = 0; level < ENCODE_LEVELS; level++) {
        const encode_row *r = &rows[2 * level * ENCODE_MOVINGS];
        fprintf(text, " %s %.3f (%zu points)", LEVELS[level], r->evaluate_ms, r->points);
    }
    fputs("\n", text);
    for (int i = 0; i < ENCODE_WHOLE_ROWS && plan->hands > 1; i += ENCODE_MOVINGS) {
        if (rows[i].shared_encode_ms > 0) {
            fprintf(text, "by %u hands together: %s %s %.3f ms, %.2fx one\n", plan->hands, KINDS[rows[i].kind],
                    LEVELS[rows[i].level], rows[i].shared_encode_ms, rows[i].encode_ms / rows[i].shared_encode_ms);
        }
    }
    fprintf(text, "memory of an encoder: ribbon %.1f MiB, strands %.1f MiB\n", (double)rows[0].scratch_bytes / 1048576,
            (double)rows[ENCODE_MOVINGS].scratch_bytes / 1048576);
}

static void table_of_guides(FILE *text, const guides_row rows[GUIDES_KINDS], size_t binding_bytes)
{
    fputs(
        "\n                   |            |        ms       |     bytes a     | entropy | strand error, mm | Mbit/s\n"
        "kind         nodes | bits, turn | encode  receive |  frame     node | bits/nd |      max    mean | at 60 Hz\n",
        text);
    for (int i = 0; i < GUIDES_KINDS; i++) {
        const guides_row *r = &rows[i];
        fprintf(text, "%-12s %5.0f | %4u %5u | %6.3f %8.3f | %6.0f %8.3f | %7.2f | %8.3f %7.3f | %6.2f\n", r->name,
                r->nodes, r->position_bits, r->turn_bits, r->encode_ms, r->receive_ms, r->bytes, r->bytes / r->nodes,
                r->entropy_bits, r->max_error_mm, r->mean_error_mm, r->bytes * 8 * ENCODE_FRAME_RATE * 1e-6);
    }
    fprintf(text, "\nbinding, once: %.2f MiB\n", (double)binding_bytes / 1048576);
}

/* ---- the same as JSON ---- */

static void json_guides(jsonout *j, const guides_row *r)
{
    jsonout_object(j, NULL);
    jsonout_text(j, "kind", r->kind);
    jsonout_bool(j, "delta", r->delta);
    jsonout_text(j, "name", r->name);
    jsonout_real(j, "nodes", r->nodes);
    jsonout_unsigned(j, "quantisation_bits", r->position_bits);
    jsonout_unsigned(j, "turn_bits", r->turn_bits);
    jsonout_real(j, "encode_ms", r->encode_ms);
    jsonout_real(j, "receive_ms", r->receive_ms);
    jsonout_real(j, "bytes", r->bytes);
    jsonout_real(j, "entropy_bits_per_node", r->entropy_bits);
    jsonout_real(j, "max_error_mm", r->max_error_mm);
    jsonout_real(j, "mean_error_mm", r->mean_error_mm);
    jsonout_real(j, "mbit_s_at_60hz", r->bytes * 8 * ENCODE_FRAME_RATE * 1e-6);
    jsonout_close(j);
}

static void json_row(jsonout *j, const encode_row *r)
{
    jsonout_object(j, NULL);
    jsonout_text(j, "kind", KINDS[r->kind]);
    jsonout_text(j, "level", LEVELS[r->level]);
    jsonout_bool(j, "delta", r->base_age > 0);
    jsonout_unsigned(j, "base_age_frames", r->base_age);
    jsonout_integer(j, "quantisation_bits", r->quantisation_bits);
    jsonout_text(j, "moving", MOVINGS[r->moving]);
    jsonout_unsigned(j, "points", r->points);
    jsonout_unsigned(j, "patches", r->patches);
    jsonout_real(j, "encode_ms", r->encode_ms);
    jsonout_real(j, "stock_encode_ms", r->stock_encode_ms);
    if (r->shared_encode_ms > 0) {
        jsonout_real(j, "shared_encode_ms", r->shared_encode_ms);
    }
    jsonout_real(j, "vertices_ms", r->vertices_ms);
    jsonout_real(j, "evaluate_ms", r->evaluate_ms);
    jsonout_real(j, "bytes_per_point", r->bytes_per_point);
    jsonout_real(j, "entropy_bits_per_point", r->entropy_bits_per_point);
    jsonout_real(j, "stock_bytes_per_point", r->stock_bytes_per_point);
    jsonout_real(j, "max_error_mm", r->max_error_mm);
    jsonout_real(j, "decode_ms", r->decode_ms);
    jsonout_real(j, "stock_decode_ms", r->stock_decode_ms);
    jsonout_real(j, "mbit_s_at_60hz", mbit_s(r));
    jsonout_unsigned(j, "scratch_bytes", r->scratch_bytes);
    jsonout_close(j);
}

static bool json_document_to(FILE *file, const encode_plan *plan, const encode_row rows[ENCODE_ROWS],
                             const guides_row of_guides[GUIDES_KINDS])
{
    jsonout j = jsonout_begin(file);
    jsonout_object(&j, NULL);
    jsonout_text(&j, "version", AWTD_VERSION);
    jsonout_text(&j, "hair", plan->groom_file ? plan->groom_file : plan->style->name);
    jsonout_text(&j, "motion", plan->motion_name);
    jsonout_unsigned(&j, "frames", plan->frames);
    jsonout_array(&j, "rows");
    for (int i = 0; i < ENCODE_ROWS; i++) {
        json_row(&j, &rows[i]);
    }
    jsonout_close(&j);
    jsonout_array(&j, "guides");
    for (int i = 0; i < GUIDES_KINDS; i++) {
        json_guides(&j, &of_guides[i]);
    }
    jsonout_close(&j);
    jsonout_close(&j);
    return jsonout_done(&j);
}

/* To standard output, or to a file whole or not at all. */
static bool json_write(const encode_plan *plan, const encode_row rows[ENCODE_ROWS],
                       const guides_row of_guides[GUIDES_KINDS])
{
    char *text = NULL, error[512] = "not enough memory for the JSON text";
    size_t size = 0;
    if (strcmp(plan->json, "-") == 0) {
        return json_document_to(stdout, plan, rows, of_guides);
    }
    FILE *memory = open_memstream(&text, &size);
    bool done = memory && json_document_to(memory, plan, rows, of_guides);
    done = memory && fclose(memory) == 0 && done && files_write(plan->json, text, size, error, sizeof error);
    if (!done) {
        fprintf(stderr, "awt-bench encode: %s\n", error);
    }
    free(text);
    return done;
}

/* ---- the command line ---- */

static bool plan_check(encode_plan *plan, const char *style, double begin_s)
{
    const motion_options as_guessed = {.up = AWT_UP_GUESS};
    char text[512];
    plan->style = awt_style_find(style);
    if (!plan->style) {
        fprintf(stderr, "awt-bench encode: there is no style \"%s\"; awtctl styles lists them\n", style);
        return false;
    }
    if (!motion_load(plan->motion_name, &as_guessed, &plan->clip, text, sizeof text)) {
        fprintf(stderr, "awt-bench encode: %s\n", text);
        return false;
    }
    plan->begin_us = (int64_t)(begin_s * 1e6);
    return true;
}

/* False: the program ends here, with *code. On success motion_fini. */
static bool plan_read(int argc, char *const *argv, encode_plan *plan, int *code)
{
    const char *style = "long";
    long long strands = AWT_DEFAULT_STRANDS, points = 16, frames = 30, stride = 6, hands = 1;
    double begin_s = 1;
    *plan = (encode_plan){.motion_name = "lean"};
    const option options[] = {
        {"style", OPTION_TEXT, "NAME", &style, 0, 0, "a built-in style"},
        {"groom", OPTION_TEXT, "FILE", &plan->groom_file, 0, 0, "hair from a .tfx or .hair file instead"},
        {"strands", OPTION_INTEGER, "N", &strands, 1, AWT_MAX_STRANDS, "strands of the style"},
        {"points", OPTION_INTEGER, "N", &points, 2, AWT_MAX_POINTS_PER_STRAND, "points of each strand"},
        {"motion", OPTION_TEXT, "CLIP", &plan->motion_name, 0, 0,
         "lean, lean-forever, jump, run, shake, or a BVH or CSV file"},
        {"begin", OPTION_REAL, "S", &begin_s, 0, 60, "seconds into the motion at which measuring begins"},
        {"frames", OPTION_INTEGER, "N", &frames, 1, ENCODE_MAX_FRAMES, "frames to measure"},
        {"stride", OPTION_INTEGER, "N", &stride, 1, 1000, "measure every Nth frame of 60 a second"},
        {"hands", OPTION_INTEGER, "N", &hands, 1, 8, "threads that encode a frame together, measured beside one"},
        {"json", OPTION_OPTIONAL_TEXT, "FILE", &plan->json, 0, 0, "all figures as JSON, to FILE or stdout"},
    };
    const option_program program = {"awt-bench encode",
                                    "What frames of moving hair cost to encode and decode, beside stock libdraco.",
                                    NULL, options, sizeof options / sizeof options[0]};
    size_t operands;
    if (!options_begin(&program, argc, argv, NULL, 0, &operands, code)) {
        return false;
    }
    plan->strands = (uint32_t)strands;
    plan->points = (uint32_t)points;
    plan->frames = (uint32_t)frames;
    plan->stride = (uint32_t)stride;
    plan->hands = (uint32_t)hands;
    *code = 2;
    return plan_check(plan, style, begin_s);
}

int bench_encode(int argc, char *const *argv)
{
    encode_plan plan;
    encode_row rows[ENCODE_ROWS];
    guides_row of_guides[GUIDES_KINDS];
    size_t binding_bytes = 0;
    int code;
    if (!plan_read(argc, argv, &plan, &code)) {
        return code;
    }
    bool done = encode_measure(&plan, rows, of_guides, &binding_bytes);
    if (done) {
        FILE *text = plan.json && strcmp(plan.json, "-") == 0 ? stderr : stdout;
        table(text, &plan, rows);
        table_of_guides(text, of_guides, binding_bytes);
        done = !plan.json || json_write(&plan, rows, of_guides);
    }
    motion_fini(&plan.clip);
    return done ? 0 : 1;
}
