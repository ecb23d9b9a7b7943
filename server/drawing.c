/* drawing.c: see drawing.h. */
#include "drawing.h"
#include "base/error.h"
#include "clock.h"
#include "between.h"
#include "drawn_form.h"
#include "metrics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The strands of one level, which ribbons and strands are made of. */
typedef struct drawn_level {
    float *points; /* [geom_layout_strands][points_per_strand][3] */
    bool made;
    uint64_t made_at; /* sub-steps that the forest had made when they were brought up to date */
} drawn_level;

enum { LEVELS = FORM_LEVEL_GREATEST + 1 };

/* An instant between two sub-steps. */
typedef struct drawn_between {
    float *centres, *frames; /* of the first, as in drawing; NULL: nothing was ever held */
    float *mixed_centres, *mixed_frames;
    awt_pose head;
    int64_t time_us;
    uint64_t held_at; /* sub-steps that the forest had made then */
    double share;     /* of the way to the second; 1: the forest is shown as it stands */
    uint64_t mixed_at;
    double mixed_share; /* what the mixed ones are of */
} drawn_between;

struct drawing {
    const awt_groom *groom;
    const spread *helpers;
    awt_groom_info info;
    float *centres, *frames; /* [finest_nodes][3], [finest_nodes][4] */
    bool guides_made;
    uint64_t guides_at; /* likewise */
    drawn_level levels[LEVELS];
    bool *moved; /* [wisp_count[0]]: working memory */
    float *strand_scratch;
    awt_node *nodes; /* [finest_nodes] */
    drawn_between between;
    uint64_t held; /* bytes of the arrays */
    drawn_form forms[FORM_COUNT];
};

/* What one job draws. */
typedef struct drawing_job {
    drawing *d;
    const awt_forest *forest;
    uint64_t sequence;
    const wishes *wanted;
    picture *out;
    awt_error *error;
} drawing_job;

/* ---- life -------------------------------------------------------------------------------------------------------- */

static void *take_memory(drawing *d, uint64_t count, size_t size)
{
    if (count > SIZE_MAX / size) {
        return NULL;
    }
    void *taken = malloc(count > 0 ? (size_t)count * size : 1);
    d->held += taken ? count * size : 0;
    return taken;
}

awt_status drawing_create(const awt_groom *groom, const spread *helpers, drawing **out, awt_error *error)
{
    *out = NULL;
    drawing *d = calloc(1, sizeof *d);
    if (!d) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    d->groom = groom;
    d->helpers = helpers;
    awt_groom_get_info(groom, &d->info);
    uint64_t points = (uint64_t)d->info.strand_count * d->info.points_per_strand;
    awt_status status = AWT_OK;
    if (points > AWT_MAX_POINTS) {
        status =
            error_set(error, AWT_LIMIT, "%lu strands of %lu points are more than %d points together",
                      (unsigned long)d->info.strand_count, (unsigned long)d->info.points_per_strand, AWT_MAX_POINTS);
    }
    if (status == AWT_OK) {
        d->centres = take_memory(d, d->info.finest_nodes, 3 * sizeof(float));
        d->frames = take_memory(d, d->info.finest_nodes, 4 * sizeof(float));
        d->moved = take_memory(d, d->info.wisp_count[0], sizeof *d->moved);
        status = d->centres && d->frames && d->moved ? AWT_OK : error_set(error, AWT_NO_MEMORY, NULL);
    }
    d->between.share = 1;
    if (status != AWT_OK) {
        drawing_destroy(d);
        return status;
    }
    *out = d;
    return AWT_OK;
}

void drawing_destroy(drawing *d)
{
    if (!d) {
        return;
    }
    for (int i = 0; i < FORM_COUNT; i++) {
        drawn_form_fini(&d->forms[i]);
    }
    free(d->centres);
    free(d->frames);
    free(d->between.centres);
    free(d->between.frames);
    free(d->between.mixed_centres);
    free(d->between.mixed_frames);
    for (int i = 0; i < LEVELS; i++) {
        free(d->levels[i].points);
    }
    free(d->moved);
    free(d->strand_scratch);
    free(d->nodes);
    free(d);
}

uint64_t drawing_form_bytes(const drawing *d, int form)
{
    return drawn_form_bytes(&d->forms[form]);
}

uint64_t drawing_bytes(const drawing *d)
{
    uint64_t bytes = sizeof *d + d->held;
    for (int i = 0; i < FORM_COUNT; i++) {
        bytes += drawing_form_bytes(d, i);
    }
    return bytes;
}

/* ---- the state --------------------------------------------------------------------------------------------------- */

/* Which top-level wisps moved since then; NULL: none did. */
static const bool *find_moved(drawing *d, const awt_forest *forest, uint64_t since)
{
    return awt_forest_moved(forest, since, d->moved) > 0 ? d->moved : NULL;
}

/* What has not moved after this sub-step is shown as it is now. */
static uint64_t shown_at(const drawing_job *j)
{
    return awt_forest_sub_steps(j->forest) - (j->d->between.share < 1 ? 1 : 0);
}

/* Brings the guides up to date. */
static void take_guides(drawing *d, const awt_forest *forest)
{
    const bool *moved = NULL;
    if (!d->guides_made) {
        awt_forest_guides(forest, d->centres, d->frames);
    } else if ((moved = find_moved(d, forest, d->guides_at)) != NULL) {
        awt_forest_guides_of(forest, moved, d->centres, d->frames);
    }
    d->guides_made = true;
    d->guides_at = awt_forest_sub_steps(forest);
}

/* The guides as they are shown: *frames too. */
static const float *show_guides(const drawing_job *j, const float **frames)
{
    drawing *d = j->d;
    drawn_between *b = &d->between;
    take_guides(d, j->forest);
    if (b->share == 1) {
        *frames = d->frames;
        return d->centres;
    }
    if (b->mixed_at != d->guides_at || b->mixed_share != b->share) {
        between_mix(b->centres, d->centres, b->share, 3, d->info.finest_nodes, b->mixed_centres);
        between_mix(b->frames, d->frames, b->share, 4, d->info.finest_nodes, b->mixed_frames);
        b->mixed_at = d->guides_at;
        b->mixed_share = b->share;
    }
    *frames = b->mixed_frames;
    return b->mixed_centres;
}

static bool take_between(drawing *d)
{
    drawn_between *b = &d->between;
    if (!b->centres) {
        b->centres = take_memory(d, d->info.finest_nodes, 3 * sizeof(float));
        b->frames = take_memory(d, d->info.finest_nodes, 4 * sizeof(float));
        b->mixed_centres = take_memory(d, d->info.finest_nodes, 3 * sizeof(float));
        b->mixed_frames = take_memory(d, d->info.finest_nodes, 4 * sizeof(float));
    }
    return b->centres && b->frames && b->mixed_centres && b->mixed_frames;
}

void drawing_hold(drawing *d, const awt_forest *forest)
{
    drawn_between *b = &d->between;
    if (!take_between(d)) {
        return;
    }
    take_guides(d, forest);
    memcpy(b->centres, d->centres, (size_t)d->info.finest_nodes * 3 * sizeof(float));
    memcpy(b->frames, d->frames, (size_t)d->info.finest_nodes * 4 * sizeof(float));
    b->head = awt_forest_head(forest);
    b->time_us = awt_forest_time(forest);
    b->held_at = awt_forest_sub_steps(forest);
}

int64_t drawing_show(drawing *d, const awt_forest *forest, int64_t time_us)
{
    drawn_between *b = &d->between;
    const int64_t now_us = awt_forest_time(forest);
    const bool is_between =
        b->mixed_frames && b->held_at + 1 == awt_forest_sub_steps(forest) && time_us >= b->time_us && time_us < now_us;
    b->share = is_between ? (double)(time_us - b->time_us) / (double)(now_us - b->time_us) : 1;
    return is_between ? time_us : now_us;
}

/* Pose and time that are shown. */
static awt_pose show_head(const drawing_job *j)
{
    const awt_pose now = awt_forest_head(j->forest);
    return j->d->between.share < 1 ? between_pose(&j->d->between.head, &now, j->d->between.share) : now;
}

static int64_t show_time_us(const drawing_job *j)
{
    const drawn_between *b = &j->d->between;
    const int64_t now_us = awt_forest_time(j->forest);
    return b->share < 1 ? b->time_us + llround((double)(now_us - b->time_us) * b->share) : now_us;
}

/* Brings guides, and the strands of the form's level, up to date. */
static awt_status take_strands(const drawing_job *j, int form)
{
    drawing *d = j->d;
    const geom_layout *layout = d->forms[form].layout;
    drawn_level *level = &d->levels[form_at(form)->level];
    const bool *moved = NULL;
    if (!d->strand_scratch) {
        d->strand_scratch = take_memory(d, awt_groom_strand_scratch(d->groom), sizeof(float));
    }
    if (!level->points) {
        const uint64_t points = (uint64_t)geom_layout_strands(layout) * d->info.points_per_strand;
        level->points = take_memory(d, points, 3 * sizeof(float));
    }
    if (!d->strand_scratch || !level->points) {
        return error_set(j->error, AWT_NO_MEMORY, NULL);
    }
    const float *frames = NULL, *centres = show_guides(j, &frames);
    if (!level->made || (moved = find_moved(d, j->forest, level->made_at)) != NULL) {
        geom_layout_evaluate(layout, d->groom, moved, centres, frames, d->strand_scratch, level->points);
    }
    level->made = true;
    level->made_at = shown_at(j);
    return AWT_OK;
}

/* The form's patches that did not move since then. */
static const bool *find_unchanged(const drawing_job *j, int form, uint64_t since)
{
    const drawn_form *f = &j->d->forms[form];
    awt_forest_moved(j->forest, since, j->d->moved);
    geom_layout_unchanged(f->layout, j->d->moved, f->unchanged);
    return f->unchanged;
}

/* ---- one view ---------------------------------------------------------------------------------------------------- */

static awt_status draw_nodes(const drawing_job *j, view *v)
{
    drawing *d = j->d;
    if (!d->nodes) {
        d->nodes = take_memory(d, d->info.finest_nodes, sizeof *d->nodes);
    }
    if (!d->nodes) {
        return error_set(j->error, AWT_NO_MEMORY, NULL);
    }
    const awt_pose head = awt_forest_head(j->forest); /* nodes come and go with a step: none lies between two */
    return geom_encode_nodes(d->nodes, awt_forest_nodes(j->forest, d->nodes), &head, awt_forest_time(j->forest),
                             &v->glb, j->error);
}

/* What the form's frames are made of: the strands' points, or, of guides, centres and *frames; else that is NULL. */
static const float *show_points(const drawing_job *j, int form, const float **frames)
{
    *frames = NULL;
    return form_at(form)->kind == GEOM_GUIDES ? show_guides(j, frames) : j->d->levels[form_at(form)->level].points;
}

/* The present frame in whole numbers. NULL: j->error says why. */
static const kept_frame *keep_frame(const drawing_job *j, int form)
{
    drawn_form *f = &j->d->forms[form];
    const kept_frame *before = &f->ring[f->newest];
    if (before->sequence == j->sequence) {
        return before;
    }
    kept_frame *now = drawn_form_oldest(f, j->error);
    const float *frames = NULL, *points = show_points(j, form, &frames);
    const geom_quantise_def def = {.points = points,
                                   .frames = frames,
                                   .unchanged = before->sequence ? find_unchanged(j, form, before->made_at) : NULL,
                                   .previous = before->numbers};
    if (!now || geom_quantise(f->layout, &def, now->numbers, &now->clamped_points, j->error) != AWT_OK) {
        return NULL;
    }
    drawn_form_keep(f, j->sequence, shown_at(j));
    return now;
}

static awt_status draw_whole(const drawing_job *j, const kept_frame *kept, view *v)
{
    drawn_form *f = &j->d->forms[v->name.form];
    const float *frames = NULL, *points = show_points(j, v->name.form, &frames);
    const geom_frame_def def = {.points = points,
                                .frames = frames,
                                .quantised = kept ? kept->numbers : NULL,
                                .head = show_head(j),
                                .time_us = show_time_us(j),
                                .unchanged = f->frame ? find_unchanged(j, v->name.form, f->made_at) : NULL,
                                .previous = f->frame ? &f->frame->glb : NULL,
                                .helpers = j->d->helpers};
    geom_frame_stats stats = {0};
    awt_status status = geom_encode(f->layout, f->scratch, &def, &v->glb, &stats, j->error);
    if (status == AWT_OK) {
        v->clamped_points = kept ? kept->clamped_points : stats.clamped_points;
        drawn_form_remember(f, j->out, v, shown_at(j));
    }
    return status;
}

/* `base` NULL, of a bare form: whole. */
static awt_status draw_delta(const drawing_job *j, const kept_frame *base, const kept_frame *kept, view *v)
{
    const drawn_form *f = &j->d->forms[v->name.form];
    const geom_delta_def def = {.base = base ? base->numbers : NULL,
                                .now = kept->numbers,
                                .base_sequence = base ? base->sequence : 0,
                                .sequence = kept->sequence,
                                .head = show_head(j),
                                .time_us = show_time_us(j)};
    v->clamped_points = kept->clamped_points;
    return geom_encode_delta(f->layout, f->scratch, &def, &v->glb, NULL, j->error);
}

static awt_status use_form(const drawing_job *j, int form)
{
    const frame_form *what = form_at(form);
    drawn_form *forms = j->d->forms, *lender = NULL;
    awt_status status = AWT_OK;
    if (what->bare) {
        const int meshes = form_find(what->kind, what->level, false);
        lender = &forms[meshes];
        status = drawn_form_use(lender, NULL, j->d->groom, meshes, j->error);
    }
    if (status == AWT_OK) {
        status = drawn_form_use(&forms[form], lender, j->d->groom, form, j->error);
    }
    if (status == AWT_OK && !what->bare && j->d->helpers) {
        status = geom_scratch_widen(forms[form].scratch, forms[form].layout, j->d->helpers->hands, j->error);
    }
    return status;
}

/* The state, and what the form needs; of a form that is kept, the present frame in whole numbers is in the ring then.
 */
static awt_status prepare(const drawing_job *j, int form, const kept_frame **kept)
{
    const frame_form *what = form_at(form);
    awt_status status = use_form(j, form);
    *kept = NULL;
    if (status == AWT_OK && what->kind == GEOM_GUIDES) {
        take_guides(j->d, j->forest);
    } else if (status == AWT_OK) {
        status = take_strands(j, form);
    }
    if (status == AWT_OK && what->has_deltas && (what->bare || j->wanted->keeps[form])) {
        *kept = keep_frame(j, form);
        status = *kept ? AWT_OK : j->error->status;
    }
    return status;
}

static awt_status draw_view(const drawing_job *j, view_name name)
{
    const int64_t begun_us = clock_monotonic_us();
    const bool nodes = form_at(name.form)->kind == GEOM_NODES, bare = form_at(name.form)->bare;
    const kept_frame *kept = NULL, *base = NULL;
    awt_status status = nodes ? AWT_OK : prepare(j, name.form, &kept);
    if (status != AWT_OK) {
        return status;
    }
    const int64_t evaluated_us = clock_monotonic_us();
    base = kept && name.base != 0 ? drawn_form_find(&j->d->forms[name.form], name.base) : NULL;
    name.base = base ? name.base : 0;
    if (picture_view(j->out, name)) {
        return AWT_OK;
    }
    view *v = picture_add(j->out, name);
    if (!v) {
        return error_set(j->error, AWT_LIMIT, "a picture has %d views at most", LIMIT_PICTURE_VIEWS);
    }
    status = nodes ? draw_nodes(j, v) : base || bare ? draw_delta(j, base, kept, v) : draw_whole(j, kept, v);
    if (status != AWT_OK) {
        picture_drop(j->out);
    }
    const int64_t ended_us = clock_monotonic_us();
    v->encode_us = clock_between_us(begun_us, ended_us);
    metrics_observe(METRIC_EVALUATE, clock_between_us(begun_us, evaluated_us));
    metrics_observe(METRIC_ENCODE, clock_between_us(evaluated_us, ended_us));
    return status;
}

awt_status drawing_draw(drawing *d, const awt_forest *forest, uint64_t sequence, const wishes *wanted, picture *out,
                        awt_error *error)
{
    awt_error why = {0};
    const drawing_job job = {d, forest, sequence, wanted, out, &why};
    awt_status first = AWT_OK;
    for (uint32_t i = 0; i < wanted->count; i++) {
        awt_status status = draw_view(&job, wanted->names[i]);
        if (status != AWT_OK && first == AWT_OK) {
            first = status;
            *error = why;
            error->status = status;
        }
    }
    return first;
}
