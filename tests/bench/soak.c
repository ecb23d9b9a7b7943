/* soak.c: awt-bench soak: every style through the most violent of some motions, for minutes, then the stop.
 *
 * The clip is played there and back again and again: both of its ends are reached with no velocity (motion.c), so the
 * way back begins without a jerk, and backwards a motion is as violent as forwards. It ends at an end of the clip. */
#include "bench/bench.h"

#include "base/options.h"
#include "base/vec.h"
#include "motion/load.h"
#include "progress.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SOAK_MAX_CLIPS = 64, SOAK_LOOK_STEPS = 100 };

#define SOAK_LINK_ERROR 1e-5f           /* of the target length; springs: beyond their strain limit (awt.h) */
#define SOAK_FIRST_US INT64_C(60000000) /* what hair does in this time, it may do later, too */
#define SOAK_GROWTH 2.0                 /* kinetic energy later than that: so many times as much at most */
#define SOAK_REST_US INT64_C(60000000)  /* after the stop, until all sleeps */

typedef struct soak_plan {
    const char *style; /* NULL: all */
    motion clip;       /* heap */
    int64_t length_us; /* of the violence */
    uint32_t strands;
} soak_plan;

/* Room for what is looked at: the strands of one forest. */
typedef struct soak_strands {
    float *centres, *frames, *scratch, *points; /* heap */
    size_t count;                               /* points */
} soak_strands;

typedef struct soak_figures {
    double first_j, later_j; /* greatest kinetic energy */
    float link_error;
    uint32_t active_max, clamped_speeds;
    uint64_t splits, outside; /* outside: strand points seen out of the groom's box */
    int64_t slept_us;         /* from the stop until all slept; < 0: not */
    double end_j;
    bool finite;
} soak_figures;

/* ---- the motion ---- */

/* There and back without end; time_us >= 0. */
static motion_sample there_and_back(const motion *clip, int64_t time_us)
{
    const int64_t end_us = clip->samples[clip->sample_count - 1].time_us, at_us = time_us % (2 * end_us);
    return motion_at(clip, at_us <= end_us ? at_us : 2 * end_us - at_us);
}

/* Where a head's surface is at six places. */
static dvec3 surface_at(const awt_pose *head, int place)
{
    const double r = place % 2 ? AWT_HEAD_RADIUS_M : -AWT_HEAD_RADIUS_M;
    const dvec3 local = {place / 2 == 0 ? r : 0, place / 2 == 1 ? r : 0, place / 2 == 2 ? r : 0};
    const double *q = head->orientation, *p = head->position;
    return dvec3_add((dvec3){p[0], p[1], p[2]}, dquat_rotate((dquat){q[0], q[1], q[2], q[3]}, local));
}

/* Greatest acceleration of the head's surface from sub-step to sub-step, m/s2. */
static double violence_of(const motion *clip)
{
    const double dt_s = (double)AWT_STEP_US * 1e-6;
    const int64_t end_us = clip->samples[clip->sample_count - 1].time_us;
    double greatest = 0;
    for (int64_t t = AWT_STEP_US; t + AWT_STEP_US <= end_us; t += AWT_STEP_US) {
        const motion_sample a = motion_at(clip, t - AWT_STEP_US), b = motion_at(clip, t);
        const motion_sample c = motion_at(clip, t + AWT_STEP_US);
        for (int place = 0; place < 6; place++) {
            const dvec3 ahead = dvec3_sub(surface_at(&c.head, place), surface_at(&b.head, place));
            const dvec3 behind = dvec3_sub(surface_at(&b.head, place), surface_at(&a.head, place));
            greatest = fmax(greatest, dvec3_length(dvec3_sub(ahead, behind)) / (dt_s * dt_s));
        }
    }
    return greatest;
}

/* The most violent of the motions named; one that cannot be read is passed over with a line. */
static bool choose_clip(const char *const *names, size_t count, motion *out)
{
    const motion_options as_guessed = {.up = AWT_UP_GUESS};
    double greatest = -1;
    for (size_t i = 0; i < count; i++) {
        motion clip = {0};
        char text[512];
        if (!motion_load(names[i], &as_guessed, &clip, text, sizeof text)) {
            printf("passed over: %s\n", text);
            continue;
        }
        const double violence = violence_of(&clip);
        printf("%7.1f m/s2 at most: %s\n", violence, names[i]);
        if (violence > greatest) {
            motion_fini(out);
            *out = clip;
            greatest = violence;
        } else {
            motion_fini(&clip);
        }
    }
    if (greatest >= 0) {
        printf("played there and back: %s\n", out->description);
    }
    return greatest >= 0;
}

/* ---- what is looked at ---- */

static bool strands_init(const awt_groom *groom, soak_strands *s)
{
    awt_groom_info info;
    awt_groom_get_info(groom, &info);
    *s = (soak_strands){.count = (size_t)info.strand_count * info.points_per_strand};
    s->centres = malloc((size_t)info.finest_nodes * 3 * sizeof(float));
    s->frames = malloc((size_t)info.finest_nodes * 4 * sizeof(float));
    s->scratch = malloc((awt_groom_strand_scratch(groom) + 1) * sizeof(float));
    s->points = malloc(s->count * 3 * sizeof(float));
    return s->centres && s->frames && s->scratch && s->points;
}

static void strands_fini(soak_strands *s)
{
    free(s->centres);
    free(s->frames);
    free(s->scratch);
    free(s->points);
}

static void look_at_strands(const awt_forest *forest, soak_strands *s, soak_figures *out)
{
    awt_groom_info info;
    awt_groom_get_info(awt_forest_groom(forest), &info);
    awt_forest_guides(forest, s->centres, s->frames);
    awt_groom_strands(awt_forest_groom(forest), s->centres, s->frames, s->scratch, s->points);
    for (size_t i = 0; i < s->count; i++) {
        bool inside = true;
        for (size_t axis = 0; axis < 3; axis++) {
            const float x = s->points[3 * i + axis];
            out->finite = out->finite && isfinite(x);
            inside = inside && x >= info.box_min[axis] && x <= info.box_max[axis];
        }
        out->outside += inside ? 0 : 1;
    }
}

static void look_at_step(const awt_step_stats *stats, int64_t time_us, soak_figures *out)
{
    double *greatest = time_us <= SOAK_FIRST_US ? &out->first_j : &out->later_j;
    out->finite = out->finite && isfinite(stats->kinetic_energy_j) && isfinite(stats->link_error);
    *greatest = fmax(*greatest, (double)stats->kinetic_energy_j);
    out->link_error = fmaxf(out->link_error, stats->link_error);
    out->active_max = stats->active_nodes > out->active_max ? stats->active_nodes : out->active_max;
    out->clamped_speeds += stats->clamped_speeds;
    out->splits += stats->splits;
}

/* ---- one style ---- */

static awt_status step_to(awt_forest *f, const motion *clip, int64_t pose_us, int64_t time_us, awt_step_stats *stats,
                          awt_error *error)
{
    const motion_sample pose = there_and_back(clip, pose_us);
    const awt_motion m = {.time_us = time_us, .head = pose.head, .body = pose.body};
    awt_status status = awt_forest_move(f, &m, error);
    return status == AWT_OK ? awt_forest_advance(f, time_us, stats, error) : status;
}

/* The motion, to the first end of the clip after its length, and then the rest. */
static awt_status run(const soak_plan *plan, awt_forest *f, soak_strands *s, progress *bar, soak_figures *out,
                      awt_error *error)
{
    awt_groom_info info;
    awt_groom_get_info(awt_forest_groom(f), &info);
    const int64_t pass_us = plan->clip.samples[plan->clip.sample_count - 1].time_us;
    const int64_t stop_us = (plan->length_us + pass_us - 1) / pass_us * pass_us;
    awt_status status = AWT_OK;
    awt_step_stats stats = {0};
    char text[64];
    *out = (soak_figures){.slept_us = -1, .finite = true};
    for (int64_t t = 0, n = 0; t < stop_us + SOAK_REST_US && status == AWT_OK && out->slept_us < 0; n++) {
        t = t < stop_us && t + AWT_STEP_US > stop_us ? stop_us : t + AWT_STEP_US;
        status = step_to(f, &plan->clip, t < stop_us ? t : stop_us, t, &stats, error);
        look_at_step(&stats, t, out);
        if (n % SOAK_LOOK_STEPS == 0) {
            look_at_strands(f, s, out);
        }
        if (t > stop_us && stats.asleep_trees == info.wisp_count[0]) {
            out->slept_us = t - stop_us;
        }
        snprintf(text, sizeof text, "%.0f s, %" PRIu32 " active, %.3f J", (double)t * 1e-6, stats.active_nodes,
                 (double)stats.kinetic_energy_j);
        progress_show(bar, fmin(1, (double)t / (double)stop_us), text);
    }
    out->end_j = (double)stats.kinetic_energy_j;
    look_at_strands(f, s, out);
    return status;
}

/* One line, and below it what does not hold. */
static bool tell(const awt_style *style, const soak_figures *f)
{
    printf("%-12s energy %.3f J in the first minute, %.3f J later; link error %.2g; %" PRIu32
           " active at most, %" PRIu64 " splits; %" PRIu32 " speeds clamped, %" PRIu64
           " points out of the box; asleep %.2f s after the stop\n",
           style->name, f->first_j, f->later_j, (double)f->link_error, f->active_max, f->splits, f->clamped_speeds,
           f->outside, (double)f->slept_us * 1e-6);
    const struct {
        bool holds;
        const char *text;
    } checks[] = {
        {f->finite, "a number is not finite"},
        {f->link_error <= SOAK_LINK_ERROR, "links are longer or shorter than they may be"},
        {f->later_j <= SOAK_GROWTH * f->first_j, "the energy grows"},
        {f->outside == 0, "strand points are out of the groom's box"},
        {f->splits > 0, "nothing ever split"},
        {f->slept_us >= 0, "not all trees sleep after the stop"},
        {f->end_j == 0, "there is energy left after the stop"},
    };
    bool good = true;
    for (size_t k = 0; k < sizeof checks / sizeof checks[0]; k++) {
        if (!checks[k].holds) {
            printf("FAIL %s: %s\n", style->name, checks[k].text);
            good = false;
        }
    }
    fflush(stdout);
    return good;
}

static bool soak_style(const soak_plan *plan, const awt_style *style)
{
    awt_error error = {0};
    awt_strands grown = {0};
    awt_groom *groom = NULL;
    awt_forest *forest = NULL;
    soak_strands strands = {0};
    soak_figures figures;
    progress bar = progress_begin(stderr, style->name, false);
    awt_groom_def def = awt_groom_def_of_style(style);
    awt_status status = awt_style_grow(style, plan->strands, 1, &grown, &error);
    status = status == AWT_OK ? awt_groom_build(&grown, &def, NULL, NULL, &groom, &error) : status;
    awt_strands_fini(&grown);
    if (status == AWT_OK) {
        awt_forest_def start = awt_forest_def_default(groom);
        const motion_sample pose = there_and_back(&plan->clip, 0);
        start.params = style->params;
        start.start.head = pose.head;
        start.start.body = pose.body;
        status = awt_forest_create(groom, &start, &forest, &error);
    }
    if (status == AWT_OK && !strands_init(groom, &strands)) {
        status = error.status = AWT_NO_MEMORY;
        snprintf(error.text, sizeof error.text, "%s", awt_status_text(status));
    }
    status = status == AWT_OK ? run(plan, forest, &strands, &bar, &figures, &error) : status;
    progress_hide(&bar);
    if (status != AWT_OK) {
        printf("FAIL %s: %s\n", style->name, error.text);
    }
    strands_fini(&strands);
    awt_forest_destroy(forest);
    awt_groom_destroy(groom);
    return status == AWT_OK && tell(style, &figures);
}

int bench_soak(int argc, char *const *argv)
{
    soak_plan plan = {0};
    const char *style = NULL, *clips[SOAK_MAX_CLIPS];
    long long strands = AWT_DEFAULT_STRANDS;
    double seconds = 600;
    const option options[] = {
        {"style", OPTION_TEXT, "NAME", &style, 0, 0, "a built-in style; without it all four, one after the other"},
        {"strands", OPTION_INTEGER, "N", &strands, 1, AWT_MAX_STRANDS, "strands of each style"},
        {"seconds", OPTION_REAL, "S", &seconds, 1, 36000, "simulated time of the motion, rounded up to whole passes"},
    };
    const option_program program = {
        "awt-bench soak",
        "Plays the most violent of some motions for minutes and checks what must hold; the exit code says whether.",
        "CLIP...", options, sizeof options / sizeof options[0]};
    size_t clip_count;
    int code;
    if (!options_begin(&program, argc, argv, clips, SOAK_MAX_CLIPS, &clip_count, &code)) {
        return code;
    }
    if (clip_count == 0 || (style && !awt_style_find(style))) {
        fprintf(stderr, "awt-bench soak: %s\n",
                clip_count == 0 ? "name a motion (lean, shake, FILE.bvh ...)" : "there is no style of that name");
        return 2;
    }
    plan = (soak_plan){.style = style, .length_us = (int64_t)(seconds * 1e6), .strands = (uint32_t)strands};
    if (!choose_clip(clips, clip_count, &plan.clip)) {
        return 2;
    }
    int passed = 0, failed = 0;
    for (size_t s = 0; s < awt_style_count(); s++) {
        if (!style || awt_style_find(style) == awt_style_at(s)) {
            *(soak_style(&plan, awt_style_at(s)) ? &passed : &failed) += 1;
        }
    }
    motion_fini(&plan.clip);
    printf("%d passed, %d failed, 0 skipped\n", passed, failed);
    return failed > 0;
}
