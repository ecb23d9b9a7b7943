/* groom_make.c: see groom_make.h. */
#include "groom_make.h"
#include "base/assert.h"
#include "base/error.h"
#include "clock.h"
#include "metrics.h"

#include <stdarg.h>
#include <stdio.h>

/* ---- the key ----------------------------------------------------------------------------------------------------- */

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static void
add(char *key, const char *format, ...)
{
    size_t used = 0;
    while (key[used]) {
        used++;
    }
    va_list arguments;
    va_start(arguments, format);
    const int size = vsnprintf(key + used, GROOM_KEY - used, format, arguments);
    va_end(arguments);
    ASSERT(size >= 0 && (size_t)size < GROOM_KEY - used);
}

/* A file is known by its hash, which was found to be right. */
static void add_file(char *key, const char *name, const upload *file)
{
    add(key, " %s=%llu:", name, file ? (unsigned long long)file->total : 0);
    for (size_t i = 0; file && i < sizeof file->expected; i++) {
        add(key, "%02x", file->expected[i]);
    }
}

/* Everything that the groom depends on; numbers to the bit. */
static void write_key(const recipe *r, char *key)
{
    const awt_groom_def *g = &r->groom;
    const awt_placement *p = &r->placement;
    key[0] = '\0';
    add(key, "style=%s seed=%llu strands=%lu", r->style ? r->style->name : "", (unsigned long long)r->seed,
        (unsigned long)r->strands);
    add_file(key, "file", r->file);
    add_file(key, "hierarchy", r->hierarchy);
    add(key, " def=%lu,%lu,%lu,%lu,%lu,%a", (unsigned long)g->levels, (unsigned long)g->sections,
        (unsigned long)g->finest_wisps, (unsigned long)g->top_wisps, (unsigned long)g->points_per_strand,
        g->head_radius_m);
    add(key, " place=%a,%d,%a,%a,%a,%a", p->scale, (int)p->up, p->head_centre[0], p->head_centre[1], p->head_centre[2],
        p->head_radius);
}

/* ---- making ------------------------------------------------------------------------------------------------------ */

/* Strands in the head frame, from the style or the file. */
static awt_status make_strands(recipe *r, awt_strands *strands, awt_error *error)
{
    if (r->style) {
        return awt_style_grow(r->style, r->strands, r->seed, strands, error);
    }
    awt_status status = awt_strands_read(r->file->bytes, (size_t)r->file->total, strands, error);
    return status == AWT_OK ? awt_strands_place(strands, &r->placement, error) : status;
}

static awt_status build(const recipe *r, const awt_strands *strands, void (*progress)(void *context, double share),
                        void *context, awt_groom **out, awt_error *error)
{
    const upload *file = r->hierarchy;
    awt_groom_def def = r->groom;
    awt_hierarchy hierarchy = {0};
    awt_status status = AWT_OK;
    if (!r->style) {
        def.head_radius_m = r->placement.head_radius_m;
    }
    if (file) {
        status = awt_hierarchy_read(file->bytes, (size_t)file->total, &hierarchy, error);
        def.hierarchy = &hierarchy;
    }
    if (status == AWT_OK) {
        status = awt_groom_build(strands, &def, progress, context, out, error);
    }
    awt_hierarchy_fini(&hierarchy);
    return status;
}

/* One that was made for somebody else may be more than this one may have. */
static awt_status check_made(const recipe *r, const made_groom *made, awt_error *error)
{
    awt_groom_info info;
    awt_groom_get_info(made->groom, &info);
    return recipe_check_points(r, info.strand_count, info.points_per_strand, error);
}

const made_groom *groom_make(groom_cache *cache, recipe *r, void (*progress)(void *context, double share),
                             void *context, uint32_t *build_us, awt_error *error)
{
    char key[GROOM_KEY];
    write_key(r, key);
    *build_us = 0;
    const made_groom *found = groom_cache_find(cache, key);
    awt_strands strands = {0};
    made_groom made = {0};
    awt_status status = found ? check_made(r, found, error) : make_strands(r, &strands, error);
    if (!found && status == AWT_OK) {
        status = recipe_check_points(r, strands.strand_count, r->groom.points_per_strand, error);
    }
    if (!found && status == AWT_OK) {
        const int64_t begun_us = clock_monotonic_us();
        status = build(r, &strands, progress, context, &made.groom, error);
        *build_us = clock_between_us(begun_us, clock_monotonic_us());
        metrics_observe(METRIC_BUILD, *build_us);
    }
    if (!found && status == AWT_OK) {
        awt_groom_info info;
        awt_groom_get_info(made.groom, &info);
        made.rebuilt = awt_groom_rebuilt(made.groom);
        made.skipped_strands = strands.skipped_count;
        made.placement = r->placement;
        made.bytes = info.bytes;
        found = groom_cache_add(cache, key, &made);
        status = found ? AWT_OK : error_set(error, AWT_NO_MEMORY, NULL);
    }
    awt_strands_fini(&strands);
    if (found && status != AWT_OK) {
        groom_cache_release(cache, found);
    }
    if (status == AWT_OK) {
        r->placement = found->placement;
    }
    return status == AWT_OK ? found : NULL;
}
