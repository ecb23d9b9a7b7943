/* picture.c: see picture.h. */
#include "picture.h"

#include <stdlib.h>

enum { FRAME_STALE = 1 /* bit of FRAME.flags */ };

picture *picture_create(void)
{
    picture *p = calloc(1, sizeof *p);
    if (p) {
        atomic_init(&p->references, 1);
    }
    return p;
}

picture *picture_of_bytes(int form, size_t size)
{
    picture *p = picture_create();
    view *v = p ? picture_add(p, (view_name){.form = form}) : NULL;
    if (!v) {
        return NULL;
    }
    v->glb.bytes = malloc(size);
    if (!v->glb.bytes) {
        picture_release(p);
        return NULL;
    }
    v->glb.capacity = v->glb.size = size;
    return p;
}

picture *picture_hold(picture *p)
{
    atomic_fetch_add(&p->references, 1);
    return p;
}

void picture_release(picture *p)
{
    while (p && atomic_fetch_sub(&p->references, 1) == 1) {
        picture *earlier = p->earlier;
        for (int i = 0; i < LIMIT_PICTURE_VIEWS; i++) {
            geom_buffer_fini(&p->views[i].glb);
        }
        free(p);
        p = earlier;
    }
}

bool picture_renew(picture *p)
{
    if (atomic_load(&p->references) != 1) {
        return false;
    }
    picture_release(p->earlier);
    p->earlier = NULL;
    p->view_count = 0;
    return true;
}

view *picture_add(picture *p, view_name name)
{
    if (p->view_count == LIMIT_PICTURE_VIEWS) {
        return NULL;
    }
    view *v = &p->views[p->view_count++];
    *v = (view){.name = name, .glb = v->glb};
    v->glb.size = 0;
    return v;
}

void picture_drop(picture *p)
{
    p->view_count--;
}

const view *picture_view(const picture *p, view_name name)
{
    for (; p; p = p->earlier) {
        for (uint32_t i = 0; i < p->view_count; i++) {
            const view *v = &p->views[i];
            if (v->name.form == name.form && v->name.base == name.base) {
                return v;
            }
        }
    }
    return NULL;
}

void picture_message(const picture *p, const view *v, const delivery *to, proto_message *out)
{
    const proto_blob bytes = {.bytes = v->glb.bytes, .length = (uint32_t)v->glb.size};
    const int type = v->name.form == PICTURE_BINDING ? PROTO_BINDING_REPLY
                     : v->name.form == PICTURE_STATE ? PROTO_SNAPSHOT_REPLY
                                                     : PROTO_FRAME;
    proto_begin(out, (uint16_t)type);
    out->request = to->request;
    if (type == PROTO_BINDING_REPLY) {
        out->as.binding_reply = (struct proto_binding_reply){.forest = p->figures.forest, .binding = bytes};
        return;
    }
    if (type == PROTO_SNAPSHOT_REPLY) {
        out->as.snapshot_reply = (struct proto_snapshot_reply){
            .forest = p->figures.forest, .time_us = p->figures.time_us, .hash = p->state_hash, .state = bytes};
        return;
    }
    const frame_form *f = form_at(v->name.form);
    out->as.frame = p->figures;
    out->as.frame.kind = f->kind;
    out->as.frame.level = f->level;
    out->as.frame.flags = to->stale ? FRAME_STALE : 0;
    out->as.frame.skipped = to->skipped;
    out->as.frame.base = v->name.base;
    out->as.frame.clamped_points = v->clamped_points;
    out->as.frame.encode_us = v->encode_us;
    out->as.frame.glb = bytes;
}
