/* drawing.c: see drawing.h. */
#include "drawing.h"
#include "base/error.h"
#include "clock.h"
#include "drawn_form.h"
#include "metrics.h"
#include "shown_hair.h"

#include <stdlib.h>

struct drawing {
    const awt_groom *groom;
    const spread *helpers;
    shown_hair *hair;
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

/* What a form's frames are made of: strands' points, or, of guides, centres and frames; else `frames` is NULL. */
typedef struct drawn_points {
    const float *points, *frames;
} drawn_points;

/* ---- life -------------------------------------------------------------------------------------------------------- */

awt_status drawing_create(const awt_groom *groom, const spread *helpers, drawing **out, awt_error *error)
{
    *out = NULL;
    drawing *d = calloc(1, sizeof *d);
    if (!d) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    d->groom = groom;
    d->helpers = helpers;
    awt_status status = shown_hair_create(groom, &d->hair, error);
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
    shown_hair_destroy(d->hair);
    free(d);
}

uint64_t drawing_form_bytes(const drawing *d, int form)
{
    return drawn_form_bytes(&d->forms[form]);
}

uint64_t drawing_bytes(const drawing *d)
{
    uint64_t bytes = sizeof *d + shown_hair_bytes(d->hair);
    for (int i = 0; i < FORM_COUNT; i++) {
        bytes += drawing_form_bytes(d, i);
    }
    return bytes;
}

void drawing_hold(drawing *d, const awt_forest *forest)
{
    shown_hair_hold(d->hair, forest);
}

int64_t drawing_show(drawing *d, const awt_forest *forest, int64_t time_us)
{
    return shown_hair_show(d->hair, forest, time_us);
}

/* ---- one view ---------------------------------------------------------------------------------------------------- */

static awt_status draw_nodes(const drawing_job *j, view *v)
{
    uint32_t count = 0;
    const awt_node *nodes = shown_hair_nodes(j->d->hair, j->forest, &count);
    if (!nodes) {
        return error_set(j->error, AWT_NO_MEMORY, NULL);
    }
    const awt_pose head = awt_forest_head(j->forest);
    return geom_encode_nodes(nodes, count, &head, awt_forest_time(j->forest), &v->glb, j->error);
}

/* The form's patches that did not move since then. */
static const bool *find_unchanged(const drawing_job *j, int form, uint64_t since)
{
    const drawn_form *f = &j->d->forms[form];
    geom_layout_unchanged(f->layout, shown_hair_moved(j->d->hair, j->forest, since), f->unchanged);
    return f->unchanged;
}

/* The state that the form is made of, brought up to date. `points` NULL: no memory. */
static drawn_points take_points(const drawing_job *j, int form)
{
    drawn_points shown = {0};
    if (form_at(form)->kind == GEOM_GUIDES) {
        shown.points = shown_hair_guides(j->d->hair, j->forest, &shown.frames);
    } else {
        const geom_layout *layout = j->d->forms[form].layout;
        shown.points = shown_hair_strands(j->d->hair, j->forest, layout, form_at(form)->level);
    }
    return shown;
}

/* The present frame in whole numbers. NULL: j->error says why. */
static const kept_frame *keep_frame(const drawing_job *j, int form, const drawn_points *shown)
{
    drawn_form *f = &j->d->forms[form];
    const kept_frame *before = &f->ring[f->newest];
    if (before->sequence == j->sequence) {
        return before;
    }
    kept_frame *now = drawn_form_oldest(f, j->error);
    const geom_quantise_def def = {.points = shown->points,
                                   .frames = shown->frames,
                                   .unchanged = before->sequence ? find_unchanged(j, form, before->made_at) : NULL,
                                   .previous = before->numbers};
    if (!now || geom_quantise(f->layout, &def, now->numbers, &now->clamped_points, j->error) != AWT_OK) {
        return NULL;
    }
    drawn_form_keep(f, j->sequence, shown_hair_made_at(j->d->hair, j->forest));
    return now;
}

static awt_status draw_whole(const drawing_job *j, const drawn_points *shown, const kept_frame *kept, view *v)
{
    drawn_form *f = &j->d->forms[v->name.form];
    const geom_frame_def def = {.points = shown->points,
                                .frames = shown->frames,
                                .quantised = kept ? kept->numbers : NULL,
                                .head = shown_hair_head(j->d->hair, j->forest),
                                .time_us = shown_hair_time_us(j->d->hair, j->forest),
                                .unchanged = f->frame ? find_unchanged(j, v->name.form, f->made_at) : NULL,
                                .previous = f->frame ? &f->frame->glb : NULL,
                                .helpers = j->d->helpers};
    geom_frame_stats stats = {0};
    awt_status status = geom_encode(f->layout, f->scratch, &def, &v->glb, &stats, j->error);
    if (status == AWT_OK) {
        v->clamped_points = kept ? kept->clamped_points : stats.clamped_points;
        drawn_form_remember(f, j->out, v, shown_hair_made_at(j->d->hair, j->forest));
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
                                .head = shown_hair_head(j->d->hair, j->forest),
                                .time_us = shown_hair_time_us(j->d->hair, j->forest)};
    v->clamped_points = kept->clamped_points;
    return geom_encode_delta(f->layout, f->scratch, &def, &v->glb, NULL, j->error);
}

static awt_status use_form(const drawing_job *j, int form)
{
    const frame_form *what = form_at(form);
    drawn_form *forms = j->d->forms, *lender = NULL;
    awt_status status = AWT_OK;
    if (what->bare) {
        const int meshes = form_find(what->kind, what->level, 0);
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

/* What the form needs, and the state; of a form that is kept, the present frame in whole numbers is in the ring then.
 */
static awt_status prepare(const drawing_job *j, int form, drawn_points *shown, const kept_frame **kept)
{
    const frame_form *what = form_at(form);
    *shown = (drawn_points){0};
    *kept = NULL;
    awt_status status = use_form(j, form);
    if (status == AWT_OK) {
        *shown = take_points(j, form);
        status = shown->points ? AWT_OK : error_set(j->error, AWT_NO_MEMORY, NULL);
    }
    if (status == AWT_OK && what->has_deltas && (what->bare || j->wanted->keeps[form])) {
        *kept = keep_frame(j, form, shown);
        status = *kept ? AWT_OK : j->error->status;
    }
    return status;
}

static awt_status draw_view(const drawing_job *j, view_name name)
{
    const int64_t begun_us = clock_monotonic_us();
    const bool nodes = form_at(name.form)->kind == GEOM_NODES, bare = form_at(name.form)->bare;
    const kept_frame *kept = NULL, *base = NULL;
    drawn_points shown = {0};
    awt_status status = nodes ? AWT_OK : prepare(j, name.form, &shown, &kept);
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
    status = nodes ? draw_nodes(j, v) : base || bare ? draw_delta(j, base, kept, v) : draw_whole(j, &shown, kept, v);
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
