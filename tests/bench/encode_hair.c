/* encode_hair.c: see encode_hair.h. */
#include "bench/encode_hair.h"

#include "base/error.h"
#include "files.h"

#include <stdlib.h>

enum { MOST_FILE = 1 << 30 };

static awt_status read_strands(const encode_plan *plan, awt_strands *strands, awt_groom_def *def, awt_error *error)
{
    char text[400];
    size_t size;
    awt_placement placement = {0};
    if (!plan->groom_file) {
        *def = awt_groom_def_of_style(plan->style);
        return awt_style_grow(plan->style, plan->strands, 1, strands, error);
    }
    *def = awt_groom_def_default();
    unsigned char *bytes = files_read(plan->groom_file, MOST_FILE, &size, text, sizeof text);
    if (!bytes) {
        return error_set(error, AWT_BAD_VALUE, "%s", text);
    }
    awt_status status = awt_strands_read(bytes, size, strands, error);
    free(bytes);
    if (status == AWT_OK) {
        status = awt_strands_place(strands, &placement, error);
        def->head_radius_m = placement.head_radius_m;
    }
    return status;
}

awt_status encode_hair_make(const encode_plan *plan, encode_hair *h, awt_error *error)
{
    awt_strands strands = {0};
    awt_groom_def def;
    awt_status status = read_strands(plan, &strands, &def, error);
    def.points_per_strand = plan->points;
    if (status == AWT_OK) {
        status = awt_groom_build(&strands, &def, NULL, NULL, &h->groom, error);
    }
    awt_strands_fini(&strands);
    if (status != AWT_OK) {
        return status;
    }
    awt_groom_get_info(h->groom, &h->info);
    const size_t points = (size_t)h->info.strand_count * h->info.points_per_strand;
    h->centres = malloc(3 * (size_t)h->info.finest_nodes * sizeof(float));
    h->frames = malloc(4 * (size_t)h->info.finest_nodes * sizeof(float));
    h->scratch = malloc((awt_groom_strand_scratch(h->groom) + 1) * sizeof(float));
    h->points = malloc(3 * points * sizeof(float));
    if (!h->centres || !h->frames || !h->scratch || !h->points) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    awt_forest_def forest = awt_forest_def_default(h->groom);
    motion_sample pose = motion_at(&plan->clip, 0);
    if (!plan->groom_file) {
        forest.params = plan->style->params;
    }
    forest.start.head = pose.head;
    forest.start.body = pose.body;
    return awt_forest_create(h->groom, &forest, &h->forest, error);
}

void encode_hair_free(encode_hair *h)
{
    awt_forest_destroy(h->forest);
    awt_groom_destroy(h->groom);
    free(h->centres);
    free(h->frames);
    free(h->scratch);
    free(h->points);
}

awt_status encode_hair_move(const encode_plan *plan, encode_hair *h, int64_t time_us, awt_error *error)
{
    motion_sample pose = motion_at(&plan->clip, time_us);
    const awt_motion to = {.time_us = time_us, .head = pose.head, .body = pose.body};
    awt_status status = awt_forest_move(h->forest, &to, error);
    return status == AWT_OK ? awt_forest_advance(h->forest, time_us, NULL, error) : status;
}
