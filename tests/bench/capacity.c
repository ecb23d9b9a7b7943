/* capacity.c: awt-bench capacity: the cost model of a daemon: see capacity.h.
 *
 * A head costs a core, each second, 100 steps, and for each of its frames, 60 where it moves and 4 at rest, what
 * drawing takes and a write to each viewer. Steps and drawing are measured among several heads (capacity_heads.c); the
 * parts of a frame, by themselves, say where its time goes. Reading the requests and the way through the scheduler are
 * not in it: what a daemon holds is less. */
#include "bench/capacity.h"

#include <stdio.h>
#include <string.h>

const double CAPACITY_MOVING[CAPACITY_SHARES] = {0, 0.1, 1};

/* ---- the model ---- */

static size_t subject_of(geom_kind kind, geom_level level)
{
    return 2 * (size_t)level + (kind == GEOM_STRANDS);
}

void capacity_sum_up(const capacity_plan *plan, capacity_row *row)
{
    const double write_ms = row->write_ms[subject_of(plan->kind, plan->level)] * plan->viewers;
    row->moving_ms = CAPACITY_STEP_RATE * row->awake.step_ms + ENCODE_FRAME_RATE * (row->awake.frame_ms + write_ms);
    row->still_ms = CAPACITY_STEP_RATE * row->asleep.step_ms + CAPACITY_REST_RATE * (row->asleep.frame_ms + write_ms);
    for (int k = 0; k < CAPACITY_SHARES; k++) {
        const double share = CAPACITY_MOVING[k];
        row->heads[k] = 1e3 / (share * row->moving_ms + (1 - share) * row->still_ms);
    }
}

/* ---- measuring ---- */

static awt_status grow(const capacity_plan *plan, const awt_style *style, awt_groom **groom, awt_error *error)
{
    awt_strands strands = {0};
    awt_status status = awt_style_grow(style, plan->strands, 1, &strands, error);
    if (status == AWT_OK) {
        awt_groom_def def = awt_groom_def_of_style(style);
        status = awt_groom_build(&strands, &def, NULL, NULL, groom, error);
    }
    awt_strands_fini(&strands);
    return status;
}

static bool clip_of(const char *name, motion *clip, awt_error *error)
{
    if (motion_builtin(name, clip)) {
        return true;
    }
    snprintf(error->text, sizeof error->text, "not enough memory for the clip");
    return false;
}

/* While it bows, begun a second before without a rest; and the last second of the lean, which is sleep. */
static bool measure_heads(const capacity_plan *plan, const awt_groom *groom, capacity_row *row, awt_error *error)
{
    static const struct {
        const char *clip;
        int64_t begin_us, end_us;
    } passes[] = {{"lean-forever", 1500000, 4500000}, {"lean", 9000000, 10000000}};
    capacity_head *const found[] = {&row->awake, &row->asleep};
    for (int k = 0; k < 2; k++) {
        motion clip;
        if (!clip_of(passes[k].clip, &clip, error)) {
            return false;
        }
        const capacity_pass pass = {.groom = groom,
                                    .params = row->style->params,
                                    .heads = plan->heads,
                                    .clip = &clip,
                                    .begin_us = passes[k].begin_us,
                                    .end_us = passes[k].end_us,
                                    .kind = plan->kind,
                                    .level = plan->level};
        awt_status status = capacity_measure_heads(&pass, found[k], error);
        motion_fini(&clip);
        if (status != AWT_OK) {
            return false;
        }
    }
    return true;
}

static bool measure_sections(const awt_groom *groom, capacity_row *row, awt_error *error)
{
    motion clip;
    bench_figures figures = {0};
    awt_groom_info info;
    if (!clip_of("lean-forever", &clip, error)) {
        return false;
    }
    bench_pass pass = {row->style->name, groom, row->style->params, &clip, 2000000, 1};
    awt_status status = bench_run(&pass, &figures, error);
    motion_fini(&clip);
    awt_groom_get_info(groom, &info);
    row->guides_ms = figures.guide_ns * info.finest_nodes * 1e-6;
    return status == AWT_OK;
}

static bool measure_frames(const capacity_plan *plan, capacity_row *row, awt_error *error)
{
    awt_groom_def def = awt_groom_def_of_style(row->style);
    size_t binding_bytes;
    encode_plan frames = {.style = row->style,
                          .motion_name = "lean",
                          .strands = plan->strands,
                          .points = def.points_per_strand,
                          .frames = plan->frames,
                          .stride = 6,
                          .begin_us = 1000000};
    if (!clip_of("lean", &frames.clip, error)) {
        return false;
    }
    bool done = encode_measure(&frames, row->rows, row->guides, &binding_bytes);
    motion_fini(&frames.clip);
    for (size_t k = 0; k < ENCODE_SUBJECTS && done; k++) {
        const encode_row *frame = &row->rows[k * ENCODE_MOVINGS];
        row->write_ms[k] = capacity_write_ms((size_t)(frame->bytes_per_point * (double)frame->points));
        done = row->write_ms[k] >= 0;
    }
    snprintf(error->text, sizeof error->text, "%s's frames could not be measured", row->style->name);
    return done;
}

static bool measure(const capacity_plan *plan, const awt_style *style, capacity_row *row)
{
    awt_error error = {0};
    awt_groom *groom = NULL;
    *row = (capacity_row){.style = style};
    bool done = grow(plan, style, &groom, &error) == AWT_OK && measure_heads(plan, groom, row, &error) &&
                measure_sections(groom, row, &error) && measure_frames(plan, row, &error);
    awt_groom_destroy(groom);
    if (done) {
        capacity_sum_up(plan, row);
    } else {
        fprintf(stderr, "awt-bench capacity: %s\n", error.text);
    }
    return done;
}

/* ---- the command line ---- */

/* The place of `name` in `names`; -1: not there, which has been said. */
static int choice(const char *of, const char *name, const char *const *names, int count)
{
    for (int k = 0; k < count; k++) {
        if (strcmp(names[k], name) == 0) {
            return k;
        }
    }
    fprintf(stderr, "awt-bench capacity: --%s takes %s or %s, not \"%s\"\n", of, names[0], names[count - 1], name);
    return -1;
}

/* All styles, or the one of that name. */
static bool choose_styles(const char *name, capacity_plan *plan)
{
    plan->end = CAPACITY_STYLES;
    while (name && plan->first < CAPACITY_STYLES && strcmp(awt_style_at(plan->first)->name, name) != 0) {
        plan->first++;
    }
    if (plan->first == CAPACITY_STYLES) {
        fprintf(stderr, "awt-bench capacity: there is no built-in style \"%s\"\n", name);
    } else if (name) {
        plan->end = plan->first + 1;
    }
    return plan->first < CAPACITY_STYLES;
}

static bool plan_read(int argc, char *const *argv, capacity_plan *plan, int *code)
{
    static const char *const levels[] = {"full", "fifth", "guides"}, *const kinds[] = {"ribbon", "strands"};
    const char *kind = "strands", *level = "fifth";
    const char *style = NULL;
    long long strands = AWT_DEFAULT_STRANDS, frames = 10, viewers = 1, heads = 8;
    *plan = (capacity_plan){0};
    const option options[] = {
        {"style", OPTION_TEXT, "NAME", &style, 0, 0, "one style alone"},
        {"heads", OPTION_INTEGER, "N", &heads, 1, CAPACITY_MAX_HEADS, "that a worker takes by turns"},
        {"strands", OPTION_INTEGER, "N", &strands, 1, AWT_MAX_STRANDS, "strands of each style"},
        {"frames", OPTION_INTEGER, "N", &frames, 1, ENCODE_MAX_FRAMES, "frames to encode for each median"},
        {"kind", OPTION_TEXT, "KIND", &kind, 0, 0, "of the frames that heads are counted with: ribbon or strands"},
        {"level", OPTION_TEXT, "LEVEL", &level, 0, 0, "of them: full, fifth or guides"},
        {"viewers", OPTION_INTEGER, "N", &viewers, 0, 10000, "that each frame is written to"},
        {"json", OPTION_OPTIONAL_TEXT, "FILE", &plan->json, 0, 0, "all figures as JSON, to FILE or stdout"},
    };
    const option_program program = {"awt-bench capacity",
                                    "What a head of hair costs a core, and how many heads a core holds.", NULL, options,
                                    sizeof options / sizeof options[0]};
    size_t operands;
    if (!options_begin(&program, argc, argv, NULL, 0, &operands, code)) {
        return false;
    }
    *code = 2;
    int kind_at = choice("kind", kind, kinds, 2), level_at = choice("level", level, levels, 3);
    plan->kind = kind_at == 1 ? GEOM_STRANDS : GEOM_RIBBON;
    plan->level = (geom_level)level_at;
    plan->strands = (uint32_t)strands;
    plan->heads = (uint32_t)heads;
    plan->frames = (uint32_t)frames;
    plan->viewers = (uint32_t)viewers;
    return kind_at >= 0 && level_at >= 0 && choose_styles(style, plan);
}

int bench_capacity(int argc, char *const *argv)
{
    static capacity_row rows[CAPACITY_STYLES];
    capacity_plan plan;
    int code;
    if (!plan_read(argc, argv, &plan, &code)) {
        return code;
    }
    for (size_t k = plan.first; k < plan.end; k++) {
        if (!measure(&plan, awt_style_at(k), &rows[k])) {
            return 1;
        }
    }
    return capacity_report(&plan, rows) ? 0 : 1;
}
