/* guides.h: cross-sections of the finest wisps to the 16-bit numbers that frames of guides hold, and back.
 *
 * A section's frame is said as its turn t from the frame that it has at rest, in the head frame: frame = t rest. All
 * wisps below one active node of the AWT turn alike (AWT 3.3), so that their turns are the same numbers; said as an
 * angle against its own chord, each would be another. t is the quaternion (v, w), w >= 0, as v / (1 + w), the tangent
 * of a quarter of the angle along the axis: it has no pole up to half a turn and is made by rational arithmetic alone.
 * Each coordinate, within -1 .. 1, is a whole number by 2^(bits-1) - 1.
 *
 * Centres are whole numbers of the quantisation box (quantise.h) in frames that any viewer shows. Between those who
 * have the binding (proto/DELTAS.md) every section is bound: predicted from a neighbour that the reader knows already,
 * the same section of the wisp before it, where that is of the same tree and patch, else the section before it on its
 * own wisp:
 *
 *   turn = t,   centre = c + t (rest - r)
 *
 * with the neighbour's turn t and centre c as the reader has them, and r, its centre at rest; along one's own wisp the
 * section's own turn takes t's place for the centre, for that is how the segment between them turned. What is written
 * is the difference: of the centre in steps of the binding's position_step_m, of the turn in its own numbers. A merged
 * wisp rides rigidly with the wisps around it: its differences are zero but for offsets that have not come to rest yet.
 * Of the first section of a patch's first wisp of a tree the centre at rest is the prediction, and no turn. */
#ifndef GEOM_GUIDES_H
#define GEOM_GUIDES_H

#include "geom/binding.h"

/* Bound sections are six numbers each, three of the centre and three of the turn, modulo 2^GUIDES_BITS: either way no
 * more than GUIDES_MOST. */
enum { GUIDES_COMPONENTS = 6, GUIDES_BITS = 15, GUIDES_MOST = (1 << (GUIDES_BITS - 1)) - 1 };

/* Radians from one turn to the next, at small angles. */
static inline float guides_turn_step(uint32_t bits)
{
    return 4.0f / (float)((1 << (bits - 1)) - 1);
}

/* Wisps in a row, the patch that is spoken of. */
typedef struct guides_part {
    uint32_t first_wisp, wisps;
} guides_part;

/* How many wisps from number `first` on, where a tree begins or is cut, are bound together: the tree, or of one that
 * has more than GEOM_PATCH_POINTS sections as many whole wisps as have no more (layout.c: no patch ends among them). */
uint32_t guides_together(const geom_binding *binding, uint32_t first);

/* Turns [nodes of the part][3] from frames [nodes of the part]. False: a frame is not finite. */
bool guides_turns(const geom_binding *binding, guides_part part, const quat *frames, int16_t *turns);
/* The way back, whatever the turns. */
void guides_frames(const geom_binding *binding, guides_part part, const int16_t *turns, quat *frames);

/* Makes of the part's centres and turns the numbers [nodes of the part][GUIDES_COMPONENTS]; `rebuilt` [nodes of the
 * part] becomes the centres as a reader will have them. Returns how many sections are too far from their prediction for
 * a number. Centres are finite. */
uint32_t guides_bind(const geom_binding *binding, guides_part part, const vec3 *centres, const int16_t *turns,
                     uint16_t *numbers, vec3 *rebuilt);
/* The way back, whatever the numbers: turns and centres. */
void guides_unbind(const geom_binding *binding, guides_part part, const uint16_t *numbers, int16_t *turns,
                   vec3 *centres);

#endif
