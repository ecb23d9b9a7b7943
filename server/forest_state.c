/* forest_state.c: see forest_state.h. */
#include "forest_state.h"
#include "base/error.h"
#include "log.h"

#include <stdlib.h>
#include <string.h>

awt_status forest_state_show(forest_work *w, awt_error *error)
{
    size_t size = 0;
    awt_status status = awt_forest_snapshot(w->forest, NULL, 0, &size, error);
    if (status == AWT_OK && size > GEOM_MAX_GLB) {
        return error_set(error, AWT_LIMIT, "the snapshot has %zu bytes; a message takes %d", size, GEOM_MAX_GLB);
    }
    picture *out = status == AWT_OK ? picture_of_bytes(PICTURE_STATE, size) : NULL;
    if (!out) {
        return status == AWT_OK ? error_set(error, AWT_NO_MEMORY, NULL) : status;
    }
    out->figures.forest = w->handle;
    out->figures.time_us = awt_forest_time(w->forest);
    out->state_hash = awt_forest_hash(w->forest);
    status = awt_forest_snapshot(w->forest, out->views[0].glb.bytes, size, &size, error);
    if (status != AWT_OK) {
        picture_release(out);
        return status;
    }
    w->state = out;
    return AWT_OK;
}

/* The saved forest's bytes, heap; NULL: `error` says why. */
static unsigned char *save(const forest_work *w, size_t *size, awt_error *error)
{
    saved s = w->saving;
    size_t got = 0;
    if (awt_forest_snapshot(w->forest, NULL, 0, &s.state_size, error) != AWT_OK) {
        return NULL;
    }
    *size = saved_size(&s);
    unsigned char *bytes = malloc(*size);
    if (!bytes) {
        error_set(error, AWT_NO_MEMORY, NULL);
        return NULL;
    }
    if (awt_forest_snapshot(w->forest, saved_state(&s, bytes), s.state_size, &got, error) != AWT_OK) {
        free(bytes);
        return NULL;
    }
    s.sequence = w->sequence;
    s.hash = awt_forest_hash(w->forest);
    saved_write(&s, bytes);
    return bytes;
}

bool forest_state_keep(forest_work *w)
{
    awt_error error = {0};
    size_t size = 0;
    unsigned char *bytes = save(w, &size, &error);
    if (!bytes) {
        log_write(LOG_ERROR, "forest not saved", "forest=%016llx why=\"%s\"", (unsigned long long)w->handle,
                  error.text);
        return false;
    }
    const bool taken = keeper_write(w->keeper, w->handle, bytes, size);
    if (!taken) {
        log_write(LOG_WARN, "forest not saved yet", "forest=%016llx why=\"too much waits for the disk\"",
                  (unsigned long long)w->handle);
    }
    return taken;
}

awt_status forest_state_restore(forest_work *w, awt_error *error)
{
    recipe *r = w->making;
    const unsigned char *bytes = r->state->bytes + r->state_offset;
    const size_t size = (size_t)r->state->total - r->state_offset;
    awt_status status = awt_snapshot_restore(bytes, size, &w->groom, &w->forest, error);
    if (status == AWT_OK) {
        awt_groom_get_info(w->groom, &w->info);
        status = recipe_check_points(r, w->info.strand_count, w->info.points_per_strand, error);
    }
    if (status == AWT_OK) {
        r->params = awt_forest_params(w->forest);
        r->start.time_us = awt_forest_time(w->forest);
        r->collider_count = awt_forest_colliders(w->forest, r->colliders);
        r->placement.head_radius_m = r->placement.head_radius = w->info.head_radius_m;
    }
    return status;
}
