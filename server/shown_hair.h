/* shown_hair.h: the hair of one forest as it is shown: guides and strands, brought up to date where they moved, at the
 * forest's last sub-step or at an instant between its last two.
 *
 * Arrays are made where they are first wanted and used again from then on. One thread at a time. */
#ifndef SHOWN_HAIR_H
#define SHOWN_HAIR_H

#include "form.h"
#include "geom/encode.h"

typedef struct shown_hair shown_hair;

/* The groom must outlive it. AWT_LIMIT (too many points), AWT_NO_MEMORY. */
awt_status shown_hair_create(const awt_groom *groom, shown_hair **out, awt_error *error);
/* Accepts NULL. */
void shown_hair_destroy(shown_hair *h);
/* Bytes that it holds. */
uint64_t shown_hair_bytes(const shown_hair *h);

/* drawing_hold and drawing_show, which see. */
void shown_hair_hold(shown_hair *h, const awt_forest *forest);
int64_t shown_hair_show(shown_hair *h, const awt_forest *forest, int64_t time_us);

/* Pose, time, and the sub-step since which what has not moved is shown as it is now. */
awt_pose shown_hair_head(const shown_hair *h, const awt_forest *forest);
int64_t shown_hair_time_us(const shown_hair *h, const awt_forest *forest);
uint64_t shown_hair_made_at(const shown_hair *h, const awt_forest *forest);

/* Which top-level wisps moved since that sub-step, [wisp_count[0]]; true until the next call. */
const bool *shown_hair_moved(shown_hair *h, const awt_forest *forest, uint64_t since);
/* The guides: centres [finest_nodes][3] and, in *frames, [finest_nodes][4]; they are its own. */
const float *shown_hair_guides(shown_hair *h, const awt_forest *forest, const float **frames);
/* The strands of one level, [geom_layout_strands][points_per_strand][3], its own; `layout` is of ribbons or strands at
 * that level. NULL: no memory. */
const float *shown_hair_strands(shown_hair *h, const awt_forest *forest, const geom_layout *layout, uint8_t level);
/* The active nodes as the forest stands, for a step is when they come and go: *count of them, its own. NULL: no memory.
 */
const awt_node *shown_hair_nodes(shown_hair *h, const awt_forest *forest, uint32_t *count);

#endif
