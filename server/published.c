/* published.c: see published.h. */
#include "published.h"

picture *published_take_spare(resident *r)
{
    for (int i = 0; i < LIMIT_PICTURES_SPARE; i++) {
        picture *p = r->spare[i];
        if (p && picture_renew(p)) {
            r->spare[i] = NULL;
            return p;
        }
    }
    return NULL;
}

static void keep_spare(resident *r, picture *p)
{
    for (int i = 0; i < LIMIT_PICTURES_SPARE; i++) {
        if (!r->spare[i]) {
            r->spare[i] = p;
            return;
        }
    }
    picture_release(r->spare[0]); /* someone has had it for long */
    r->spare[0] = p;
}

static void note_sizes(resident *r, const picture *drawn)
{
    const uint64_t sequence = drawn->figures.sequence;
    for (uint32_t i = 0; i < drawn->view_count; i++) {
        const view *v = &drawn->views[i];
        form_size *last = v->name.base ? &r->delta[v->name.form] : &r->whole[v->name.form];
        const bool larger = last->sequence != sequence || v->glb.size > last->bytes;
        *last = (form_size){.sequence = sequence, .bytes = larger ? v->glb.size : last->bytes};
    }
}

static bool shows_more(const picture *drawn, const picture *before)
{
    for (uint32_t i = 0; i < drawn->view_count; i++) {
        if (!picture_view(before, drawn->views[i].name)) {
            return true;
        }
    }
    return false;
}

bool published_take(resident *r, picture *drawn)
{
    picture *before = r->latest;
    const bool again = before && before->figures.sequence == drawn->figures.sequence;
    note_sizes(r, drawn);
    if (again && !shows_more(drawn, before)) { /* else a client could pile up pictures of one step */
        keep_spare(r, drawn);
        return false;
    }
    r->latest = drawn;
    r->sequence = drawn->figures.sequence;
    if (again) {
        drawn->earlier = before;
    } else if (before) {
        keep_spare(r, before);
    }
    return true;
}
