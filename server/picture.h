/* picture.h: one step of one forest as everything that was encoded of it: made by a worker, never changed once it is
 * published, sent to everyone who asked, freed with the last reference.
 *
 * A picture has a view for each form, and for each base of a delta, that somebody wanted when its job began. What is
 * wanted of the same step later is drawn into another picture, which stands on the one before it. */
#ifndef PICTURE_H
#define PICTURE_H

#include "form.h"
#include "geom/encode.h"
#include "limits.h"
#include "proto.h"

#include <stdatomic.h>

/* What a view is of. */
typedef struct view_name {
    int form;      /* number of the form; PICTURE_BINDING: what guides are evaluated with; PICTURE_STATE: a snapshot */
    uint64_t base; /* sequence of the frame that it is a delta against; 0: whole in itself */
} view_name;

/* What differs from receiver to receiver. */
typedef struct delivery {
    uint64_t request;
    uint32_t skipped; /* frames left out before it */
    bool stale;       /* older than was asked for */
} delivery;

enum { PICTURE_BINDING = FORM_COUNT, PICTURE_STATE };

typedef struct view {
    view_name name;
    uint32_t clamped_points, encode_us;
    geom_buffer glb; /* of PICTURE_BINDING and PICTURE_STATE these bytes themselves */
} view;

typedef struct picture {
    atomic_uint references;
    struct picture *earlier;    /* a reference to what was drawn of this step before; NULL: nothing */
    struct proto_frame figures; /* of FRAME all that does not depend on the view or on the receiver */
    int64_t stepped_us;         /* monotonic clock at the end of its step: its age counts from here */
    uint64_t state_hash;        /* of PICTURE_STATE */
    uint32_t view_count;
    view views[LIMIT_PICTURE_VIEWS];
} picture;

/* An empty picture with one reference; the maker fills it before anyone else sees it. NULL: no memory. */
picture *picture_create(void);
/* The same with one view already, `views[0]`, whose `size` bytes are still to be filled: a binding, or a state. */
picture *picture_of_bytes(int form, size_t size);
/* One reference more; returns `p`. Any thread. */
picture *picture_hold(picture *p);
/* One reference less. Any thread. Accepts NULL. */
void picture_release(picture *p);
/* Whoever holds the only reference empties the picture, which keeps its memory. False: others hold it too. */
bool picture_renew(picture *p);

/* A further view, whose buffer may hold memory of an earlier one. NULL: there are as many as may be. */
view *picture_add(picture *p, view_name name);
/* Takes back the view that was added last. */
void picture_drop(picture *p);

/* NULL: there is no such view of this step. */
const view *picture_view(const picture *p, view_name name);

/* FRAME, BINDING_REPLY or SNAPSHOT_REPLY with this view, as it is delivered; FRAME's times of sending are the
 * caller's. */
void picture_message(const picture *p, const view *v, const delivery *to, proto_message *out);

#endif
