/* drawn_form.h: what drawing keeps for one form of one forest: layout and scratch, the last whole frame, whose patches
 * are taken over where they did not move, and the last frames in whole numbers, which deltas are made between. */
#ifndef DRAWN_FORM_H
#define DRAWN_FORM_H

#include "picture.h"

/* A frame in whole numbers. */
typedef struct kept_frame {
    geom_quantised *numbers;
    uint64_t sequence; /* 0: none */
    uint64_t made_at;  /* sub-steps that the forest had made */
    uint32_t clamped_points;
} kept_frame;

/* Zeroed: not in use. */
typedef struct drawn_form {
    geom_layout *layout;
    geom_scratch *scratch;
    bool borrowed;                          /* both: they are another form's, of the same kind and level */
    bool *unchanged;                        /* [patches]: working memory */
    picture *previous;                      /* a reference: the last whole frame's */
    const view *frame;                      /* in `previous`; NULL: there is none */
    uint64_t made_at;                       /* sub-steps that the forest had made then */
    kept_frame ring[LIMIT_DELTA_BASES + 1]; /* the bases, and the present frame */
    uint32_t newest;                        /* place in `ring` */
} drawn_form;

/* Takes what is missing, for a form of that number: of a bare form layout and scratch from `lender`, which is that of
 * the meshes, is in use, and outlives it; else `lender` is not looked at. */
awt_status drawn_form_use(drawn_form *f, const drawn_form *lender, const awt_groom *groom, int number,
                          awt_error *error);
/* Accepts a zeroed one. */
void drawn_form_fini(drawn_form *f);
/* Bytes that it holds, without the layout. */
uint64_t drawn_form_bytes(const drawn_form *f);

/* `v` of `shown`, of a forest that has made so many sub-steps, is the last whole frame from now on. */
void drawn_form_remember(drawn_form *f, picture *shown, const view *v, uint64_t made_at);

/* The frame of that sequence; NULL: it is not kept, or not any more. */
const kept_frame *drawn_form_find(const drawn_form *f, uint64_t sequence);
/* The place of the oldest, emptied. NULL: no memory. */
kept_frame *drawn_form_oldest(drawn_form *f, awt_error *error);
/* That place has been filled, and is the newest. */
void drawn_form_keep(drawn_form *f, uint64_t sequence, uint64_t made_at);

#endif
