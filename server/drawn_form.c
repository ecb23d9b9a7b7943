/* drawn_form.c: see drawn_form.h. */
#include "drawn_form.h"
#include "base/error.h"

#include <stdlib.h>

enum { PLACES = LIMIT_DELTA_BASES + 1 };

awt_status drawn_form_use(drawn_form *f, const drawn_form *lender, const awt_groom *groom, int number, awt_error *error)
{
    const frame_form *form = form_at(number);
    const geom_layout_def def = {
        .kind = form->kind, .level = form->level, .attributes = form->attributed ? GEOM_ATTRIBUTES_ALL : 0};
    if (form->bare && !f->layout) {
        f->layout = lender->layout;
        f->scratch = lender->scratch;
        f->borrowed = true;
    }
    awt_status status = f->layout ? AWT_OK : geom_layout_create(groom, &def, &f->layout, error);
    if (status == AWT_OK && !f->scratch) {
        status = geom_scratch_create(f->layout, &f->scratch, error);
    }
    if (status == AWT_OK && !f->unchanged) {
        const uint32_t patches = geom_layout_patches(f->layout);
        f->unchanged = calloc(patches > 0 ? patches : 1, sizeof *f->unchanged);
        status = f->unchanged ? AWT_OK : error_set(error, AWT_NO_MEMORY, NULL);
    }
    return status;
}

void drawn_form_fini(drawn_form *f)
{
    if (!f->borrowed) {
        geom_scratch_destroy(f->scratch);
        geom_layout_destroy(f->layout);
    }
    free(f->unchanged);
    picture_release(f->previous);
    for (int i = 0; i < PLACES; i++) {
        geom_quantised_destroy(f->ring[i].numbers);
    }
    *f = (drawn_form){0};
}

uint64_t drawn_form_bytes(const drawn_form *f)
{
    uint64_t bytes = f->scratch && !f->borrowed ? geom_scratch_bytes(f->scratch) : 0;
    bytes += f->unchanged ? geom_layout_patches(f->layout) * sizeof *f->unchanged : 0;
    bytes += f->frame ? f->frame->glb.capacity : 0;
    for (int i = 0; i < PLACES; i++) {
        bytes += f->ring[i].numbers ? geom_quantised_bytes(f->ring[i].numbers) : 0;
    }
    return bytes;
}

void drawn_form_remember(drawn_form *f, picture *shown, const view *v, uint64_t made_at)
{
    picture_hold(shown);
    picture_release(f->previous);
    f->previous = shown;
    f->frame = v;
    f->made_at = made_at;
}

const kept_frame *drawn_form_find(const drawn_form *f, uint64_t sequence)
{
    for (int i = 0; i < PLACES; i++) {
        if (f->ring[i].sequence == sequence) {
            return &f->ring[i];
        }
    }
    return NULL;
}

kept_frame *drawn_form_oldest(drawn_form *f, awt_error *error)
{
    kept_frame *oldest = &f->ring[(f->newest + 1) % PLACES];
    oldest->sequence = 0;
    oldest->clamped_points = 0;
    if (!oldest->numbers && geom_quantised_create(f->layout, &oldest->numbers, error) != AWT_OK) {
        return NULL;
    }
    return oldest;
}

void drawn_form_keep(drawn_form *f, uint64_t sequence, uint64_t made_at)
{
    f->newest = (f->newest + 1) % PLACES;
    f->ring[f->newest].sequence = sequence;
    f->ring[f->newest].made_at = made_at;
}
