/* plan.c: see plan.h. Everything is checked, and the motion read, before anything is measured. */
#include "bench/plan.h"

#include "base/options.h"
#include "motion/load.h"
#include "motion/timeunit.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { PLAN_MAX_SECONDS = 3600, PLAN_DEFAULT_POINTS = 16 };

/* What the command line says before it is checked. */
typedef struct paper_words {
    const char *styles, *links, *up, *time_unit;
    option_list params;
    motion_options motion;
    long long strands, points, workers;
    double seconds;
} paper_words;

static bool plan_wrong(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fputs("awt-bench paper: ", stderr);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    va_end(arguments);
    return false;
}

static bool plan_add_style(paper_plan *plan, const awt_style *style)
{
    if (plan->style_count == PAPER_MAX_STYLES) {
        return plan_wrong("%d styles are the most", PAPER_MAX_STYLES);
    }
    plan->styles[plan->style_count++] = style;
    return true;
}

/* "short,long"; NULL: all there are. */
static bool plan_styles(const char *list, paper_plan *plan)
{
    for (size_t s = 0; !list && s < awt_style_count(); s++) {
        if (!plan_add_style(plan, awt_style_at(s))) {
            return false;
        }
    }
    while (list) {
        char name[33] = "";
        size_t length = strcspn(list, ",");
        memcpy(name, list, length < sizeof name ? length : sizeof name - 1);
        const awt_style *style = length < sizeof name ? awt_style_find(name) : NULL;
        if (!style) {
            return plan_wrong("there is no style \"%s\"; awtctl styles lists them", name);
        }
        if (!plan_add_style(plan, style)) {
            return false;
        }
        list = list[length] == ',' ? list + length + 1 : NULL;
    }
    return true;
}

static bool plan_links(const char *name, paper_plan *plan)
{
    awt_params params = awt_params_default();
    plan->links = -1;
    if (!name) {
        return true;
    }
    if (strcmp(name, "rigid") != 0 && strcmp(name, "springs") != 0) {
        return plan_wrong("--links takes rigid or springs, not \"%s\"", name);
    }
    bool springs = strcmp(name, "springs") == 0;
    if (awt_params_set(&params, "links", springs ? 1.0f : 0.0f, NULL) == AWT_OK) {
        plan->links = springs ? 1 : 0;
    } else if (springs) {
        return plan_wrong("this build has only rigid links");
    }
    return true;
}

/* "name=number", over the styles' own. */
static bool plan_params(const option_list *list, paper_plan *plan)
{
    awt_params checked = awt_params_default();
    for (size_t i = 0; i < list->count; i++) {
        paper_param *p = &plan->params[i];
        double value;
        awt_error error;
        if (!options_split_assignment(list->items[i], p->name, sizeof p->name, &value)) {
            return plan_wrong("--param takes name=number, not \"%s\" (awtctl styles lists the names)", list->items[i]);
        }
        p->value = (float)value;
        if (awt_params_set(&checked, p->name, p->value, &error) != AWT_OK) {
            return plan_wrong("%s", error.text);
        }
    }
    plan->param_count = list->count;
    return true;
}

static bool plan_motion_words(paper_words *words)
{
    if (words->up && strcmp(words->up, "y") != 0 && strcmp(words->up, "z") != 0) {
        return plan_wrong("--motion-up takes y or z, not \"%s\"", words->up);
    }
    words->motion.up = !words->up ? AWT_UP_GUESS : words->up[0] == 'z' ? AWT_UP_Z : AWT_UP_Y;
    words->motion.time_unit_s = words->time_unit ? timeunit_find(words->time_unit) : 0;
    if (words->time_unit && words->motion.time_unit_s <= 0) {
        return plan_wrong("--time-unit takes s, ms, us, 100ns or ns, not \"%s\"", words->time_unit);
    }
    return true;
}

static bool plan_motion(const motion_options *options, paper_plan *plan)
{
    char text[512];
    return motion_load(plan->motion_name, options, &plan->clip, text, sizeof text) || plan_wrong("%s", text);
}

/* The whole clip, or as long as asked for. */
static bool plan_length(double seconds, paper_plan *plan)
{
    plan->length_us = seconds > 0 ? (int64_t)(seconds * 1e6) : plan->clip.samples[plan->clip.sample_count - 1].time_us;
    if (plan->length_us < AWT_STEP_US || plan->length_us > PLAN_MAX_SECONDS * INT64_C(1000000)) {
        return plan_wrong("the motion lasts %.3f s: give --seconds, from 0.01 to %d", (double)plan->length_us * 1e-6,
                          PLAN_MAX_SECONDS);
    }
    return true;
}

/* The table of options, read. False: *code says how the program ends. */
static bool plan_options(int argc, char *const *argv, paper_words *words, paper_plan *plan, int *code)
{
    const option options[] = {
        {"styles", OPTION_TEXT, "A,B", &words->styles, 0, 0, "which styles; without it all four"},
        {"strands", OPTION_INTEGER, "N", &words->strands, 1, AWT_MAX_STRANDS, "strands of each style"},
        {"points", OPTION_INTEGER, "N", &words->points, 2, AWT_MAX_POINTS_PER_STRAND, "points of each strand"},
        {"motion", OPTION_TEXT, "CLIP", &plan->motion_name, 0, 0,
         "lean, lean-forever, jump, run, shake, or a BVH or head-pose CSV file"},
        {"joint", OPTION_TEXT, "NAME", &words->motion.joint, 0, 0, "the head's joint in a BVH; else the one named so"},
        {"body-joint", OPTION_TEXT, "NAME", &words->motion.body_joint, 0, 0, "the body's; else 3 above the head's"},
        {"motion-scale", OPTION_REAL, "S", &words->motion.scale, 0, 1e9,
         "metres per unit of the motion file; 0: guess"},
        {"motion-up", OPTION_TEXT, "y|z", &words->up, 0, 0, "the motion file's up axis; else y"},
        {"time-unit", OPTION_TEXT, "U", &words->time_unit, 0, 0, "of a CSV: s, ms, us, 100ns, ns; else guessed"},
        {"seconds", OPTION_REAL, "S", &words->seconds, 0, PLAN_MAX_SECONDS, "simulated time; 0: the whole clip"},
        {"theta", OPTION_REAL, "T", &plan->theta, -1, 1e9, "split threshold of all styles, m2/s2; -1: each its own"},
        {"param", OPTION_LIST, "NAME=VALUE", &words->params, 0, 0, "a parameter of all styles; may be given again"},
        {"links", OPTION_TEXT, "KIND", &words->links, 0, 0, "rigid or springs; without it as each style has them"},
        {"workers", OPTION_INTEGER, "N", &words->workers, 1, BENCH_MAX_WORKERS, "heads stepped at once, a thread each"},
        {"json", OPTION_OPTIONAL_TEXT, "FILE", &plan->json, 0, 0, "all figures as JSON, to FILE or stdout"},
    };
    const option_program program = {
        "awt-bench paper",
        "The table of the paper's §5.2: ms a 10 ms step, all finest wisps (single level) against the AWT.", NULL,
        options, sizeof options / sizeof options[0]};
    size_t operands;
    return options_begin(&program, argc, argv, NULL, 0, &operands, code);
}

bool paper_plan_read(int argc, char *const *argv, paper_plan *plan, int *code)
{
    paper_words words = {.strands = AWT_DEFAULT_STRANDS, .points = PLAN_DEFAULT_POINTS, .workers = 1};
    *plan = (paper_plan){.motion_name = "lean", .theta = -1};
    if (!plan_options(argc, argv, &words, plan, code)) {
        return false;
    }
    *code = 2;
    plan->strands = (uint32_t)words.strands;
    plan->points = (uint32_t)words.points;
    plan->workers = (uint32_t)words.workers;
    if (plan_styles(words.styles, plan) && plan_links(words.links, plan) && plan_params(&words.params, plan) &&
        plan_motion_words(&words) && plan_motion(&words.motion, plan) && plan_length(words.seconds, plan)) {
        return true;
    }
    paper_plan_fini(plan);
    return false;
}

void paper_plan_fini(paper_plan *plan)
{
    motion_fini(&plan->clip);
}

awt_params paper_plan_params(const paper_plan *plan, const awt_style *style)
{
    awt_params params = style->params;
    if (plan->theta >= 0) {
        params.split_threshold = (float)plan->theta;
    }
    if (plan->links >= 0) {
        awt_params_set(&params, "links", (float)plan->links, NULL);
    }
    for (size_t i = 0; i < plan->param_count; i++) {
        awt_params_set(&params, plan->params[i].name, plan->params[i].value, NULL);
    }
    return params;
}
