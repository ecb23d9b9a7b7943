/* drawing.c: see drawing.h. */
#include "drawing.h"
#include "base/error.h"
#include "clock.h"
#include "drawn_form.h"

#include <stdlib.h>
#include <string.h>

/* Guides or strands of a state; [0] is the latest evaluated, [1] the one before. */
typedef struct drawn_guides {
    float *centres, *frames; /* [finest_nodes][3], [finest_nodes][4] */
    uint64_t sequence;
} drawn_guides;

typedef struct drawn_strands {
    float *points; /* [strand_count][points_per_strand][3] */
    uint64_t sequence;
} drawn_strands;

struct drawing {
    const awt_groom *groom;
    awt_groom_info info;
    drawn_guides guides[2];
    drawn_strands strands[2];
    float *strand_scratch;
    awt_node *nodes; /* [finest_nodes] */
    uint64_t held;   /* bytes of the arrays */
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

awt_status drawing_create(const awt_groom *groom, drawing **out, awt_error *error)
{
    *out = NULL;
    drawing *d = calloc(1, sizeof *d);
    if (!d) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    d->groom = groom;
    awt_groom_get_info(groom, &d->info);
    uint64_t points = (uint64_t)d->info.strand_count * d->info.points_per_strand;
    awt_status status = AWT_OK;
    if (points > AWT_MAX_POINTS) {
        status =
            error_set(error, AWT_LIMIT, "%lu strands of %lu points are more than %d points together",
                      (unsigned long)d->info.strand_count, (unsigned long)d->info.points_per_strand, AWT_MAX_POINTS);
    }
    for (int k = 0; k < 2 && status == AWT_OK; k++) {
        d->guides[k].centres = take_memory(d, d->info.finest_nodes, 3 * sizeof(float));
        d->guides[k].frames = take_memory(d, d->info.finest_nodes, 4 * sizeof(float));
        if (!d->guides[k].centres || !d->guides[k].frames) {
            status = error_set(error, AWT_NO_MEMORY, NULL);
        }
    }
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
    for (int k = 0; k < 2; k++) {
        free(d->guides[k].centres);
        free(d->guides[k].frames);
        free(d->strands[k].points);
    }
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

static void take_guides(const drawing_job *j)
{
    drawing *d = j->d;
    if (d->guides[0].sequence == j->sequence) {
        return;
    }
    const drawn_guides before = d->guides[0];
    d->guides[0] = d->guides[1];
    d->guides[1] = before;
    awt_forest_guides(j->forest, d->guides[0].centres, d->guides[0].frames);
    d->guides[0].sequence = j->sequence;
}

static awt_status take_strands(const drawing_job *j)
{
    drawing *d = j->d;
    if (!d->strand_scratch) {
        d->strand_scratch = take_memory(d, awt_groom_strand_scratch(d->groom), sizeof(float));
    }
    for (int k = 0; k < 2; k++) {
        if (!d->strands[k].points) {
            const uint64_t points = (uint64_t)d->info.strand_count * d->info.points_per_strand;
            d->strands[k].points = take_memory(d, points, 3 * sizeof(float));
        }
    }
    if (!d->strand_scratch || !d->strands[0].points || !d->strands[1].points) {
        return error_set(j->error, AWT_NO_MEMORY, NULL);
    }
    if (d->strands[0].sequence != j->sequence) {
        take_guides(j);
        const drawn_strands before = d->strands[0];
        d->strands[0] = d->strands[1];
        d->strands[1] = before;
        awt_groom_strands(d->groom, d->guides[0].centres, d->guides[0].frames, d->strand_scratch, d->strands[0].points);
        d->strands[0].sequence = j->sequence;
    }
    return AWT_OK;
}

/* ---- patches that did not move ----------------------------------------------------------------------------------- */

static bool same_floats(const float *a, const float *b, size_t begin, size_t count)
{
    return memcmp(a + begin, b + begin, count * sizeof *a) == 0;
}

static bool patch_is_same(const drawing *d, bool guides, geom_patch patch)
{
    if (guides) {
        const drawn_guides *now = &d->guides[0], *before = &d->guides[1];
        const size_t first = (size_t)patch.first_strand * d->info.sections;
        const size_t count = (size_t)patch.strands * d->info.sections;
        return same_floats(now->centres, before->centres, 3 * first, 3 * count) &&
               same_floats(now->frames, before->frames, 4 * first, 4 * count);
    }
    const size_t points = (size_t)d->info.points_per_strand * 3;
    return same_floats(d->strands[0].points, d->strands[1].points, patch.first_strand * points, patch.strands * points);
}

/* Which patches are to the bit as they were in the state of `made_of`; NULL: that is not known. */
static const bool *find_unchanged(const drawing_job *j, int form, uint64_t made_of)
{
    const drawing *d = j->d;
    const drawn_form *f = &d->forms[form];
    const bool guides = form_at(form)->kind == GEOM_GUIDES, same = made_of == j->sequence;
    if (made_of == 0 || (!same && made_of != (guides ? d->guides[1].sequence : d->strands[1].sequence))) {
        return NULL;
    }
    for (uint32_t i = 0; i < geom_layout_patches(f->layout); i++) {
        f->unchanged[i] = same || patch_is_same(d, guides, geom_layout_patch(f->layout, i));
    }
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
    const awt_pose head = awt_forest_head(j->forest);
    return geom_encode_nodes(d->nodes, awt_forest_nodes(j->forest, d->nodes), &head, awt_forest_time(j->forest),
                             &v->glb, j->error);
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
    const geom_quantise_def def = {.points = j->d->strands[0].points,
                                   .unchanged = find_unchanged(j, form, before->sequence),
                                   .previous = before->numbers};
    if (!now || geom_quantise(f->layout, &def, now->numbers, &now->clamped_points, j->error) != AWT_OK) {
        return NULL;
    }
    drawn_form_keep(f, now, j->sequence);
    return now;
}

static awt_status draw_whole(const drawing_job *j, const kept_frame *kept, view *v)
{
    const drawing *d = j->d;
    drawn_form *f = &j->d->forms[v->name.form];
    const bool guides = form_at(v->name.form)->kind == GEOM_GUIDES;
    const geom_frame_def def = {.points = guides ? d->guides[0].centres : d->strands[0].points,
                                .frames = guides ? d->guides[0].frames : NULL,
                                .quantised = kept ? kept->numbers : NULL,
                                .head = awt_forest_head(j->forest),
                                .time_us = awt_forest_time(j->forest),
                                .unchanged = find_unchanged(j, v->name.form, f->made_of),
                                .previous = f->frame ? &f->frame->glb : NULL};
    geom_frame_stats stats = {0};
    awt_status status = geom_encode(f->layout, f->scratch, &def, &v->glb, &stats, j->error);
    if (status == AWT_OK) {
        v->clamped_points = kept ? kept->clamped_points : stats.clamped_points;
        drawn_form_remember(f, j->out, v, j->sequence);
    }
    return status;
}

static awt_status draw_delta(const drawing_job *j, const kept_frame *base, const kept_frame *kept, view *v)
{
    const drawn_form *f = &j->d->forms[v->name.form];
    const geom_delta_def def = {.base = base->numbers,
                                .now = kept->numbers,
                                .base_sequence = base->sequence,
                                .sequence = kept->sequence,
                                .head = awt_forest_head(j->forest),
                                .time_us = awt_forest_time(j->forest)};
    v->clamped_points = kept->clamped_points;
    return geom_encode_delta(f->layout, f->scratch, &def, &v->glb, NULL, j->error);
}

/* The state, and what the form needs; of a form that is kept, the present frame in whole numbers is in the ring then.
 */
static awt_status prepare(const drawing_job *j, int form, const kept_frame **kept)
{
    awt_status status = AWT_OK;
    *kept = NULL;
    if (form_at(form)->kind == GEOM_GUIDES) {
        take_guides(j);
    } else {
        status = take_strands(j);
    }
    status = status == AWT_OK ? drawn_form_use(&j->d->forms[form], j->d->groom, form, j->error) : status;
    if (status == AWT_OK && form_at(form)->has_deltas && j->wanted->keeps[form]) {
        *kept = keep_frame(j, form);
        status = *kept ? AWT_OK : j->error->status;
    }
    return status;
}

static awt_status draw_view(const drawing_job *j, view_name name)
{
    const int64_t begun_us = clock_monotonic_us();
    const bool nodes = form_at(name.form)->kind == GEOM_NODES;
    const kept_frame *kept = NULL, *base = NULL;
    awt_status status = nodes ? AWT_OK : prepare(j, name.form, &kept);
    if (status != AWT_OK) {
        return status;
    }
    base = kept && name.base != 0 ? drawn_form_find(&j->d->forms[name.form], name.base) : NULL;
    name.base = base ? name.base : 0;
    if (picture_view(j->out, name)) {
        return AWT_OK;
    }
    view *v = picture_add(j->out, name);
    if (!v) {
        return error_set(j->error, AWT_LIMIT, "a picture has %d views at most", LIMIT_PICTURE_VIEWS);
    }
    status = nodes ? draw_nodes(j, v) : base ? draw_delta(j, base, kept, v) : draw_whole(j, kept, v);
    if (status != AWT_OK) {
        picture_drop(j->out);
    }
    v->encode_us = clock_between_us(begun_us, clock_monotonic_us());
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
