/* embed.h: the nodes that are not active (AWT §3.3).
 *
 * Below an active node, everything is rigid: offsets taken in the head frame when the wisp had its reference direction
 * there, turned by the shortest way from that direction to the present one. Working in the head frame, a head that
 * turns right round twists nothing. Taking the offsets anew (embed_bake) at every event that changes a segment is what
 * keeps the hair from jumping there.
 *
 * The direction is that of a chord towards the root, as long as the wisp is wide: a segment that is shorter than its
 * wisp is wide says nothing about how the wisp lies, and strands on the rim would be torn about by its smallest turn.
 * Where root and section are nearer than that, the section turns with the head by as much as the chord falls short. For
 * segments longer than their radius this is the paper's rule, the tangent of the active segment. */
#ifndef SIM_EMBED_H
#define SIM_EMBED_H

#include "sim/state.h"

/* Sets offsets, frames and references of the whole forest to the groom's rest shape. */
void embed_rest(awt_forest *f);

/* Takes all offsets and frames of the tree anew at its present directions, by the slots as they are. Nothing moves. */
void embed_bake(awt_forest *f, const tree *t);

/* Sets the chords of the tree's slots; when these have been made anew. */
void embed_measure(awt_forest *f, const tree *t);

/* Gives every active node of the tree the present direction of its chord as reference; after embed_bake and
 * tree_rebuild. */
void embed_refer(awt_forest *f, const tree *t);

/* Offsets, frames and radii of a loose tree go towards rest (params.offset_relaxation; PHYSICS.md: frozen offsets
 * flatten the style), and what has come nearer than EMBED_SETTLED arrives: the tree is not loose any more. It is much
 * work for a slow process: done once in two or three steps (at 60 frames a second, once a frame), and of a sleeping
 * tree more seldom still: a twentieth of what is left of the way at a time, which nobody sees. */
void embed_relax(awt_forest *f, tree *t, float dt_s);

/* Times between two relaxations, at least. */
#define EMBED_RELAX_S 0.015f
#define EMBED_RELAX_ASLEEP_S 0.065f
#define EMBED_SETTLED_M 1e-5f
#define EMBED_SETTLED_TURN 1e-4f /* of a quaternion's components: 0.01 degrees */

#endif
