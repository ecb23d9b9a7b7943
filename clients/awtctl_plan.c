/* awtctl_plan.c: the options of awtctl play, checked before anything is opened. */
#include "awtctl_play.h"

#include "motion/timeunit.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What the command line says before it is checked. */
typedef struct play_words {
    const char *up, *head, *motion_up, *time_unit, *kind, *level;
    option_list params;
} play_words;

static bool read_up(const char *text, awt_up_axis *up)
{
    if (!text) {
        *up = AWT_UP_GUESS;
        return true;
    }
    *up = strcmp(text, "z") == 0 || strcmp(text, "Z") == 0 ? AWT_UP_Z : AWT_UP_Y;
    return *up == AWT_UP_Z || strcmp(text, "y") == 0 || strcmp(text, "Y") == 0;
}

/* A finite number and what ends it; `*text` goes behind that. */
static bool read_number(const char **text, char end, double *value)
{
    char *stop;
    errno = 0;
    *value = strtod(*text, &stop);
    if (stop == *text || errno != 0 || !isfinite(*value) || *stop != end) {
        return false;
    }
    *text = stop + 1;
    return true;
}

static bool read_head(const char *text, double head[4])
{
    if (!text) {
        return true;
    }
    return read_number(&text, ',', &head[0]) && read_number(&text, ',', &head[1]) &&
           read_number(&text, ',', &head[2]) && read_number(&text, '\0', &head[3]) && head[3] > 0;
}

static bool read_time_unit(const char *text, double *unit_s)
{
    if (!text) {
        return true;
    }
    *unit_s = timeunit_find(text);
    return *unit_s > 0 || (read_number(&text, '\0', unit_s) && *unit_s > 0);
}

/* The number of the name among `count`. */
static bool read_name(const char *text, const char *const *names, uint8_t count, uint8_t *number)
{
    for (*number = 0; *number < count; (*number)++) {
        if (strcmp(names[*number], text) == 0) {
            return true;
        }
    }
    return false;
}

static bool read_kind(const char *text, uint8_t *kind)
{
    static const char *const names[] = {"ribbon", "strands", "guides", "nodes"};
    return read_name(text, names, sizeof names / sizeof names[0], kind);
}

static bool read_level(const char *text, uint8_t *level)
{
    static const char *const names[] = {"full", "fifth", "guides"};
    return read_name(text, names, sizeof names / sizeof names[0], level);
}

static bool read_param(const char *text, play_plan *plan)
{
    play_param *param = &plan->params[plan->param_count];
    double value;
    if (!options_split_assignment(text, param->name, sizeof param->name, &value) || fabs(value) > 1e30) {
        return false;
    }
    param->value = (float)value;
    plan->param_count++;
    return true;
}

/* NULL, or what is wrong, in `text`. */
static const char *plan_words(const play_words *words, play_plan *plan, char *text, size_t size)
{
    if (!read_up(words->up, &plan->up) || !read_up(words->motion_up, &plan->motion_options.up)) {
        return "--up and --motion-up take y or z";
    }
    if (!read_head(words->head, plan->head)) {
        return "--head takes the head's centre and radius in the file's units: x,y,z,r";
    }
    if (!read_time_unit(words->time_unit, &plan->motion_options.time_unit_s)) {
        return "--time-unit takes s, ms, us, 100ns, ns or a number of seconds";
    }
    if (!read_kind(words->kind, &plan->kind)) {
        return "--kind takes ribbon, strands, guides or nodes";
    }
    if (!read_level(words->level, &plan->level)) {
        return "--level takes full, fifth or guides";
    }
    for (size_t i = 0; i < words->params.count; i++) {
        if (!read_param(words->params.items[i], plan)) {
            snprintf(text, size, "--param takes name=number, not \"%s\" (awtctl styles lists the names)",
                     words->params.items[i]);
            return text;
        }
    }
    return NULL;
}

/* NULL, or which options do not go together. */
static const char *plan_whole(const play_words *words, play_plan *plan)
{
    if (plan->style && plan->groom) {
        return "either --style or --groom, not both";
    }
    if (plan->groom && (plan->strands > 0 || plan->seed > 0)) {
        return "--strands and --seed are for --style; a file has the strands that it has";
    }
    if (!plan->groom && (plan->scale > 0 || words->up || words->head || plan->hierarchy)) {
        return "--scale, --up, --head and --hierarchy are about a strand file: they go with --groom";
    }
    if (!plan->style && !plan->groom) {
        plan->style = "long";
    }
    if (plan->deltas && plan->kind != GEOM_STRANDS && plan->kind != GEOM_GUIDES) {
        return "--deltas goes with --kind strands or guides: other kinds have none";
    }
    const bool has_levels = plan->kind == GEOM_RIBBON || plan->kind == GEOM_STRANDS;
    if (!has_levels && (plan->budget > 0 || plan->attributes)) {
        return "--budget and --attributes go with --kind ribbon or strands: other kinds have one level, and no "
               "attributes";
    }
    if (plan->deltas && plan->attributes) {
        return "either --deltas or --attributes: frames with attributes are whole";
    }
    if (plan->every > 0 && !plan->out) {
        return "--every is about the files that --out DIR asks for";
    }
    return NULL;
}

bool play_plan_read(int argc, char *const *argv, play_plan *plan, awtctl_exit *code)
{
    play_words words = {.kind = "ribbon", .level = "full"};
    *plan = (play_plan){.connection = {.address = AWTCTL_ADDRESS}, .motion = "lean", .fps = 60};
    motion_options *clip = &plan->motion_options;
    const option options[] = {
        AWTCTL_CONNECTION_OPTIONS(plan->connection),
        {"style", OPTION_TEXT, "NAME", &plan->style, 0, 0, "built-in style (awtctl styles); without --groom: long"},
        {"groom", OPTION_TEXT, "FILE", &plan->groom, 0, 0, "strand file: TressFX .tfx or cyHair .hair"},
        {"scale", OPTION_REAL, "S", &plan->scale, 0, 1e9, "metres per unit of the strand file; 0: guess"},
        {"up", OPTION_TEXT, "y|z", &words.up, 0, 0, "the strand file's up axis; else guessed"},
        {"head", OPTION_TEXT, "X,Y,Z,R", &words.head, 0, 0, "head's centre and radius, file units; else guessed"},
        {"hierarchy", OPTION_TEXT, "FILE", &plan->hierarchy, 0, 0, "its wisps: a line a strand, a number a level"},
        {"strands", OPTION_INTEGER, "N", &plan->strands, 0, AWT_MAX_STRANDS, "of a style; 0: the daemon's default"},
        {"seed", OPTION_INTEGER, "N", &plan->seed, 0, 9e15, "of a style: other seeds, other hair"},
        {"param", OPTION_LIST, "NAME=VALUE", &words.params, 0, 0, "a simulation parameter; may be given again"},
        {"motion", OPTION_TEXT, "CLIP", &plan->motion, 0, 0,
         "lean, lean-forever, jump, run, shake, or a BVH or head-pose CSV file"},
        {"joint", OPTION_TEXT, "NAME", &clip->joint, 0, 0, "the head's joint in a BVH; else the one named so"},
        {"body-joint", OPTION_TEXT, "NAME", &clip->body_joint, 0, 0, "the body's; else 3 above the head's"},
        {"motion-scale", OPTION_REAL, "S", &clip->scale, 0, 1e9, "metres per unit of the motion file; 0: guess"},
        {"motion-up", OPTION_TEXT, "y|z", &words.motion_up, 0, 0, "the motion file's up axis; else y"},
        {"time-unit", OPTION_TEXT, "U", &words.time_unit, 0, 0, "of a CSV: s, ms, us, 100ns, ns; else guessed"},
        {"fps", OPTION_REAL, "F", &plan->fps, 0.1, 1000, "frames a second"},
        {"frames", OPTION_INTEGER, "N", &plan->frames, 0, 1e6, "how many; 0: the whole clip"},
        {"out", OPTION_TEXT, "DIR", &plan->out, 0, 0, "folder for GLB files; without it none is written"},
        {"every", OPTION_INTEGER, "K", &plan->every, 0, 1e6, "a file every K frames; 0: about 20 files in all"},
        {"kind", OPTION_TEXT, "KIND", &words.kind, 0, 0, "geometry: ribbon, strands, guides, nodes"},
        {"level", OPTION_TEXT, "LEVEL", &words.level, 0, 0, "share of the hair: full, fifth, guides"},
        {"deltas", OPTION_FLAG, NULL, &plan->deltas, 0, 0,
         "strands or guides against the frame before; files of these are of no use alone"},
        {"budget", OPTION_INTEGER, "BYTES", &plan->budget, 0, UINT32_MAX,
         "of a frame: the daemon picks the richest level, up to --level, that keeps within; 0: none"},
        {"attributes", OPTION_FLAG, NULL, &plan->attributes, 0, 0,
         "of vertices beside their position: number of the strand, place of its root, width"},
        {"check", OPTION_FLAG, NULL, &plan->check, 0, 0, "decode and measure every frame, not only those written"},
        {"json", OPTION_OPTIONAL_TEXT, "FILE", &plan->json, 0, 0, "all figures as JSON, to FILE or stdout"},
        {"quiet", OPTION_FLAG, NULL, &plan->quiet, 0, 0, "no progress and no table, only the summary"},
    };
    const option_program program = {"awtctl play", "Moves a head of hair through a clip, frame by frame in lock-step.",
                                    NULL, options, sizeof options / sizeof options[0]};
    size_t operands;
    if (!awtctl_options(&program, argc, argv, NULL, 0, &operands, code)) {
        return false;
    }
    char text[256];
    const char *wrong = plan_words(&words, plan, text, sizeof text);
    wrong = wrong ? wrong : plan_whole(&words, plan);
    if (wrong) {
        *code = awtctl_wrong_usage(&program, "%s", wrong);
    }
    return !wrong;
}
