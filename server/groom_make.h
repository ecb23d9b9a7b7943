/* groom_make.h: the groom of a recipe: one that is there already, or a new one from the style or the file. */
#ifndef GROOM_MAKE_H
#define GROOM_MAKE_H

#include "groom_cache.h"
#include "recipe.h"

/* In use until groom_cache_release; the recipe learns what was taken where it left something open. `progress` as in
 * awt_groom_build. *build_us: what it took to build the wisps; 0: they were there. NULL: `error` says why. */
const made_groom *groom_make(groom_cache *cache, recipe *r, void (*progress)(void *context, double share),
                             void *context, uint32_t *build_us, awt_error *error);

#endif
