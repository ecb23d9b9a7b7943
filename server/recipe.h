/* recipe.h: what a CREATE asks for, checked, free of the message it came in; a worker makes hair of it. */
#ifndef RECIPE_H
#define RECIPE_H

#include "awt.h"
#include "proto.h"
#include "upload.h"

enum { RECIPE_NAME = 65, RECIPE_FROM_STYLE = 0, RECIPE_FROM_UPLOAD = 1 /* CREATE's `source` */ };

typedef struct recipe {
    char name[RECIPE_NAME];
    const awt_style *style; /* NULL: from the upload */
    upload *file;           /* NULL: from the style; a reference */
    upload *hierarchy;      /* NULL: wisps are made of the strands; a reference */
    upload *state;          /* not NULL: the forest is restored from the snapshot in it; a reference */
    size_t state_offset;    /* where that begins */
    uint64_t seed;
    uint32_t strands;
    awt_placement placement; /* of the file; after placing: what was taken */
    awt_groom_def groom;
    uint64_t greatest_points; /* of all strands together, as they are drawn */
    awt_params params;        /* after making: those in force */
    bool own_stiffness;       /* style_omega was named; an upload's is else chosen by its groom */
    bool tells;               /* PROGRESS is wanted */
    bool own_colliders;
    uint32_t collider_count; /* after making: those in force */
    awt_collider colliders[AWT_MAX_COLLIDERS];
    awt_motion start;
} recipe;

/* Makes a recipe of a CREATE; `file` and `hierarchy` are its complete uploads (references are taken), NULL where it has
 * none. The caller owns *out: recipe_destroy. AWT_NO_STYLE, AWT_NO_PARAM, AWT_BAD_VALUE, AWT_LIMIT, AWT_NO_MEMORY. */
awt_status recipe_create(const struct proto_create *message, upload *file, upload *hierarchy, recipe **out,
                         awt_error *error);
/* A recipe of a snapshot, which begins at `offset` of a complete upload (a reference is taken). Errors likewise. */
awt_status recipe_restore(upload *state, size_t offset, proto_str name, recipe **out, awt_error *error);
/* AWT_BAD_FORMAT where a file that came does not match its hash, else AWT_OK. Takes long; without the lock. */
awt_status recipe_check_files(const recipe *r, awt_error *error);
/* AWT_LIMIT where so many points are more than it may have, else AWT_OK. */
awt_status recipe_check_points(const recipe *r, uint64_t strands, uint64_t points_per_strand, awt_error *error);
/* Under the service's lock. Accepts NULL. */
void recipe_destroy(recipe *made);

#endif
