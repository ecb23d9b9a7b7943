/* wishes.h: what is to be drawn of a forest's next step: the views that somebody wants, each once. */
#ifndef WISHES_H
#define WISHES_H

#include "picture.h"

typedef struct wishes {
    uint32_t count;
    view_name names[LIMIT_PICTURE_VIEWS];
    bool keeps[FORM_COUNT]; /* frames of this form may become bases of deltas */
} wishes;

/* Adds a view that is not among them yet. Deltas beyond their share of the places become the whole frame, for which
 * there is always a place. */
void wishes_add(wishes *w, view_name name);

#endif
