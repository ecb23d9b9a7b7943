/* forest_state.h: the part of a worker's job that takes the forest's whole state: as bytes for whoever asked
 * (SNAPSHOT), and for the state directory. */
#ifndef FOREST_STATE_H
#define FOREST_STATE_H

#include "forest_work.h"

/* The state as work->state, a picture with the one view PICTURE_STATE. AWT_LIMIT (longer than a message),
 * AWT_NO_MEMORY. */
awt_status forest_state_show(forest_work *work, awt_error *error);

/* Hands the state, with what stands in work->saving, to the keeper. False: that failed and is logged; the next round is
 * to try again. */
bool forest_state_keep(forest_work *work);

/* Makes groom and forest of the recipe's state, and sets what the recipe left open as it is there. As
 * awt_snapshot_restore. */
awt_status forest_state_restore(forest_work *work, awt_error *error);

#endif
