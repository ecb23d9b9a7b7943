/* rest.h: trees at rest sleep (PHYSICS.md): otherwise their last millimetres a second never end, and cost as much as
 * motion. */
#ifndef SIM_REST_H
#define SIM_REST_H

#include "sim/state.h"

/* Is the world still around the head, so that trees may rest? While the wind gusts it is not. Counts for how long.
 * After step_pose has placed head and obstacles, and the sub-step's wind is known. */
bool rest_world_is_still(awt_forest *f, float dt_s);

/* Drag towards the head, 1/s, that comes up while the world stays still: a wisp that goes on swinging over an
 * obstacle's edge, splitting and merging, would otherwise do so for ever. */
float rest_drag(const awt_forest *f);

/* What a still world lets sleep goes on sleeping, carried with the head from its orientation `from`; any other wakes.
 */
void rest_sleepers(awt_forest *f, bool world_is_still, dquat from);

/* After the tree's dynamics: counts how long it has been quiet, and lets it fall asleep once all of it has merged. */
void rest_observe(awt_forest *f, tree *t, bool world_is_still, float dt_s);

/* Turns the state of all trees, or of those that sleep, as one solid, as the head turns from `from` to `to`. */
void rest_carry(awt_forest *f, dquat from, dquat to, bool sleepers_only);

void rest_wake_all(awt_forest *f);

/* What moves faster than this against a sleeping tree wakes it: twice what would still be quiet. */
float rest_waking_speed(const awt_forest *f);

/* Wakes the tree of an active slot. */
void rest_wake(awt_forest *f, uint32_t slot);

/* Has the tree been quiet for so long that what keeps its wisps apart is no motion? */
static inline bool rest_is_settled(const tree *t)
{
    return t->quiet_s >= 0.5f;
}

#endif
