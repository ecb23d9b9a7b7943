/* snapshot_walks.h: what a snapshot holds, in lists that writer and reader walk alike: SNAPSHOT_WALKS for the handful
 * of single values, snapshot_groom_spans and snapshot_forest_spans for the arrays. What a walk passes is written, read
 * or counted, as its codec says. */
#ifndef SIM_SNAPSHOT_WALKS_H
#define SIM_SNAPSHOT_WALKS_H

#include "base/codec.h"
#include "sim/span.h"
#include "sim/state.h"

enum { SNAPSHOT_GROOM_SPANS = 6, SNAPSHOT_FOREST_SPANS = 12 };

/* The arrays of a groom, of a forest: section, kind, array, count, least, most. Of the structure only its sizes have to
 * be there (and a forest's time). */
void snapshot_groom_spans(const awt_groom *g, span out[SNAPSHOT_GROOM_SPANS]);
void snapshot_forest_spans(const awt_forest *f, span out[SNAPSHOT_FOREST_SPANS]);

/* Section, walk. Reading needs the earlier ones for the later. */
#define SNAPSHOT_WALKS(X)              \
    X("SIZE", snapshot_walk_sizes)     \
    X("MEAS", snapshot_walk_measures)  \
    X("LOOK", snapshot_walk_look)      \
    X("PARA", snapshot_walk_params)    \
    X("COLL", snapshot_walk_colliders) \
    X("MOTN", snapshot_walk_motion)    \
    X("TREE", snapshot_walk_trees)

/* What the walks are about; each uses its part. */
typedef struct snapshot {
    groom_plan plan;
    awt_groom *groom;
    awt_forest_def def; /* params, colliders; the start stays at rest */
    awt_forest *forest;
    bool skip_unknown; /* parameters that this version has not */
    awt_error *error;
} snapshot;

/* In reading, AWT_LIMIT or AWT_BAD_VALUE; in writing they do not write into what they walk (codec.h). */
#define SNAPSHOT_DECLARE(section, walk) awt_status walk(codec *c, snapshot *s);
SNAPSHOT_WALKS(SNAPSHOT_DECLARE)
#undef SNAPSHOT_DECLARE

#define SNAPSHOT_COUNT(section, walk) +1
enum { SNAPSHOT_WALK_COUNT = 0 SNAPSHOT_WALKS(SNAPSHOT_COUNT) };
#undef SNAPSHOT_COUNT
enum { SNAPSHOT_SECTIONS = SNAPSHOT_WALK_COUNT + SNAPSHOT_GROOM_SPANS + SNAPSHOT_FOREST_SPANS };

#endif
