/* snapshot.h: the parts of a snapshot that have files of their own. */
#ifndef SIM_SNAPSHOT_H
#define SIM_SNAPSHOT_H

#include "base/codec.h"
#include "sim/state.h"

/* Far beyond what hair does, near enough that no square of it overflows a float. */
#define SNAPSHOT_FARTHEST_M 1e6

/* Parameters by name and value, so that a list that grew or shrank still reads; for snapshots and recordings. */
void snapshot_write_params(codec *to, const awt_params *params);
/* All that is left in `from`. `out` is written on success only; what is not named has its default. AWT_BAD_VALUE;
 * AWT_NO_PARAM for an unknown name unless `skip_unknown`. */
awt_status snapshot_read_params(codec *from, bool skip_unknown, awt_params *out, awt_error *error);

/* AWT_BAD_VALUE, with the section's name. */
awt_status snapshot_damaged(const char *section, awt_error *error);

/* Before any memory is taken: sizes that a groom may have. AWT_BAD_VALUE, AWT_LIMIT. */
awt_status snapshot_check_sizes(const groom_plan *plan, awt_error *error);
/* AWT_BAD_VALUE, as what follows. */
awt_status snapshot_check_measures(const awt_groom *groom, awt_error *error);
awt_status snapshot_check_look(const awt_groom *groom, awt_error *error);
/* Poses finite and their times in order: the latest reached, now, those that wait. */
awt_status snapshot_check_motion(const awt_forest *f, awt_error *error);
/* 1 <= first_split[super] <= first_split[sub] <= M, and M at the finest level: then what is active makes trees. */
awt_status snapshot_check_splits(const awt_forest *f, awt_error *error);
/* With the slots made: only what is merged sleeps. */
awt_status snapshot_check_trees(const awt_forest *f, awt_error *error);

#endif
