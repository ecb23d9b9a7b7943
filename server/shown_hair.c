/* shown_hair.c: see shown_hair.h. */
#include "shown_hair.h"
#include "base/error.h"
#include "between.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEVELS = FORM_LEVEL_GREATEST + 1 };

/* The strands of one level, which ribbons and strands are made of. */
typedef struct shown_level {
    float *points; /* [geom_layout_strands][points_per_strand][3] */
    bool made;
    uint64_t made_at; /* sub-steps that the forest had made when they were brought up to date */
} shown_level;

/* An instant between two sub-steps. */
typedef struct shown_between {
    float *centres, *frames; /* of the first, as in shown_hair */
    float *mixed_centres, *mixed_frames;
    awt_pose head;
    int64_t time_us;
    bool holds;       /* something was held */
    uint64_t held_at; /* sub-steps that the forest had made then */
    double share;     /* of the way to the second; 1: the forest is shown as it stands */
    uint64_t mixed_at;
    double mixed_share; /* what the mixed ones are of */
} shown_between;

struct shown_hair {
    const awt_groom *groom;
    awt_groom_info info;
    float *centres, *frames; /* [finest_nodes][3], [finest_nodes][4] */
    bool guides_made;
    uint64_t guides_at; /* likewise */
    shown_level levels[LEVELS];
    bool *moved; /* [wisp_count[0]]: working memory */
    float *strand_scratch;
    awt_node *nodes; /* [finest_nodes] */
    shown_between between;
    uint64_t held; /* bytes of the arrays */
};

/* ---- life -------------------------------------------------------------------------------------------------------- */

static void *take_memory(shown_hair *h, uint64_t count, size_t size)
{
    if (count > SIZE_MAX / size) {
        return NULL;
    }
    void *taken = malloc(count > 0 ? (size_t)count * size : 1);
    h->held += taken ? count * size : 0;
    return taken;
}

awt_status shown_hair_create(const awt_groom *groom, shown_hair **out, awt_error *error)
{
    *out = NULL;
    shown_hair *h = calloc(1, sizeof *h);
    if (!h) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    h->groom = groom;
    h->between.share = 1;
    awt_groom_get_info(groom, &h->info);
    uint64_t points = (uint64_t)h->info.strand_count * h->info.points_per_strand;
    awt_status status = AWT_OK;
    if (points > AWT_MAX_POINTS) {
        status =
            error_set(error, AWT_LIMIT, "%lu strands of %lu points are more than %d points together",
                      (unsigned long)h->info.strand_count, (unsigned long)h->info.points_per_strand, AWT_MAX_POINTS);
    }
    if (status == AWT_OK) {
        h->centres = take_memory(h, h->info.finest_nodes, 3 * sizeof(float));
        h->frames = take_memory(h, h->info.finest_nodes, 4 * sizeof(float));
        h->moved = take_memory(h, h->info.wisp_count[0], sizeof *h->moved);
        status = h->centres && h->frames && h->moved ? AWT_OK : error_set(error, AWT_NO_MEMORY, NULL);
    }
    if (status != AWT_OK) {
        shown_hair_destroy(h);
        return status;
    }
    *out = h;
    return AWT_OK;
}

void shown_hair_destroy(shown_hair *h)
{
    if (!h) {
        return;
    }
    free(h->centres);
    free(h->frames);
    free(h->between.centres);
    free(h->between.frames);
    free(h->between.mixed_centres);
    free(h->between.mixed_frames);
    for (int i = 0; i < LEVELS; i++) {
        free(h->levels[i].points);
    }
    free(h->moved);
    free(h->strand_scratch);
    free(h->nodes);
    free(h);
}

uint64_t shown_hair_bytes(const shown_hair *h)
{
    return sizeof *h + h->held;
}

/* ---- between two sub-steps --------------------------------------------------------------------------------------- */

/* For so many numbers of every node; those that are there stay. False: no memory. */
static bool take_numbers(shown_hair *h, float **at, size_t components)
{
    *at = *at ? *at : take_memory(h, h->info.finest_nodes, components * sizeof **at);
    return *at != NULL;
}

static bool take_between(shown_hair *h)
{
    shown_between *b = &h->between;
    return take_numbers(h, &b->centres, 3) && take_numbers(h, &b->frames, 4) && take_numbers(h, &b->mixed_centres, 3) &&
           take_numbers(h, &b->mixed_frames, 4);
}

/* Which top-level wisps moved since then; NULL: none did. */
static const bool *find_moved(shown_hair *h, const awt_forest *forest, uint64_t since)
{
    return awt_forest_moved(forest, since, h->moved) > 0 ? h->moved : NULL;
}

/* Brings the guides up to date with the forest as it stands. */
static void take_guides(shown_hair *h, const awt_forest *forest)
{
    const bool *moved = NULL;
    if (!h->guides_made) {
        awt_forest_guides(forest, h->centres, h->frames);
    } else if ((moved = find_moved(h, forest, h->guides_at)) != NULL) {
        awt_forest_guides_of(forest, moved, h->centres, h->frames);
    }
    h->guides_made = true;
    h->guides_at = awt_forest_sub_steps(forest);
}

void shown_hair_hold(shown_hair *h, const awt_forest *forest)
{
    shown_between *b = &h->between;
    if (!take_between(h)) {
        return;
    }
    take_guides(h, forest);
    memcpy(b->centres, h->centres, (size_t)h->info.finest_nodes * 3 * sizeof(float));
    memcpy(b->frames, h->frames, (size_t)h->info.finest_nodes * 4 * sizeof(float));
    b->holds = true;
    b->head = awt_forest_head(forest);
    b->time_us = awt_forest_time(forest);
    b->held_at = awt_forest_sub_steps(forest);
}

int64_t shown_hair_show(shown_hair *h, const awt_forest *forest, int64_t time_us)
{
    shown_between *b = &h->between;
    const int64_t now_us = awt_forest_time(forest);
    const bool is_between =
        b->holds && b->held_at + 1 == awt_forest_sub_steps(forest) && time_us >= b->time_us && time_us < now_us;
    b->share = is_between ? (double)(time_us - b->time_us) / (double)(now_us - b->time_us) : 1;
    return is_between ? time_us : now_us;
}

/* ---- what is shown ----------------------------------------------------------------------------------------------- */

awt_pose shown_hair_head(const shown_hair *h, const awt_forest *forest)
{
    const awt_pose now = awt_forest_head(forest);
    return h->between.share < 1 ? between_pose(&h->between.head, &now, h->between.share) : now;
}

int64_t shown_hair_time_us(const shown_hair *h, const awt_forest *forest)
{
    const shown_between *b = &h->between;
    const int64_t now_us = awt_forest_time(forest);
    return b->share < 1 ? b->time_us + llround((double)(now_us - b->time_us) * b->share) : now_us;
}

uint64_t shown_hair_made_at(const shown_hair *h, const awt_forest *forest)
{
    return awt_forest_sub_steps(forest) - (h->between.share < 1 ? 1 : 0);
}

const bool *shown_hair_moved(shown_hair *h, const awt_forest *forest, uint64_t since)
{
    awt_forest_moved(forest, since, h->moved);
    return h->moved;
}

const float *shown_hair_guides(shown_hair *h, const awt_forest *forest, const float **frames)
{
    shown_between *b = &h->between;
    take_guides(h, forest);
    if (b->share == 1) {
        *frames = h->frames;
        return h->centres;
    }
    if (b->mixed_at != h->guides_at || b->mixed_share != b->share) {
        between_mix(b->centres, h->centres, b->share, 3, h->info.finest_nodes, b->mixed_centres);
        between_mix(b->frames, h->frames, b->share, 4, h->info.finest_nodes, b->mixed_frames);
        b->mixed_at = h->guides_at;
        b->mixed_share = b->share;
    }
    *frames = b->mixed_frames;
    return b->mixed_centres;
}

const float *shown_hair_strands(shown_hair *h, const awt_forest *forest, const geom_layout *layout, uint8_t number)
{
    shown_level *level = &h->levels[number];
    const bool *moved = NULL;
    if (!h->strand_scratch) {
        h->strand_scratch = take_memory(h, awt_groom_strand_scratch(h->groom), sizeof(float));
    }
    if (!level->points) {
        const uint64_t points = (uint64_t)geom_layout_strands(layout) * h->info.points_per_strand;
        level->points = take_memory(h, points, 3 * sizeof(float));
    }
    if (!h->strand_scratch || !level->points) {
        return NULL;
    }
    const float *frames = NULL, *centres = shown_hair_guides(h, forest, &frames);
    if (!level->made || (moved = find_moved(h, forest, level->made_at)) != NULL) {
        geom_layout_evaluate(layout, h->groom, moved, centres, frames, h->strand_scratch, level->points);
    }
    level->made = true;
    level->made_at = shown_hair_made_at(h, forest);
    return level->points;
}

const awt_node *shown_hair_nodes(shown_hair *h, const awt_forest *forest, uint32_t *count)
{
    if (!h->nodes) {
        h->nodes = take_memory(h, h->info.finest_nodes, sizeof *h->nodes);
    }
    *count = h->nodes ? awt_forest_nodes(forest, h->nodes) : 0;
    return h->nodes;
}
