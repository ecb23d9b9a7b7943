/* rest.h: trees at rest sleep (PHYSICS.md): otherwise their last millimetres a second never end, and cost as much as
 * motion. */
#ifndef SIM_REST_H
#define SIM_REST_H

#include "sim/state.h"

/* Is the world still around the head, so that trees may rest? Counts for how long. After step_pose has placed head and
 * obstacles. */
bool rest_world_is_still(awt_forest *f, float dt_s);

/* Drag towards the head, 1/s, that comes up while the world stays still: a wisp that goes on swinging over an
 * obstacle's edge, splitting and merging, would otherwise do so for ever. */
float rest_drag(const awt_forest *f);

/* True if the tree sleeps through this sub-step: it is carried with the head, and its offsets finish relaxing. Wakes it
 * where the world is not still. */
bool rest_sleeps_on(awt_forest *f, tree *t, bool world_is_still, const track_pose *head_before, float dt_s);

/* After the tree's dynamics: counts how long it has been quiet, and lets it fall asleep once all of it has merged. */
void rest_observe(awt_forest *f, tree *t, bool world_is_still, float dt_s);

/* Turns the tree's state with the head as one solid. */
void rest_carry(awt_forest *f, const tree *t, mat3 turn);

void rest_wake_all(awt_forest *f);

/* Has the tree been quiet for so long that what keeps its wisps apart is no motion? */
static inline bool rest_is_settled(const tree *t)
{
    return t->quiet_s >= 0.5f;
}

#endif
