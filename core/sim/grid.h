/* grid.h: a voxel grid over boxes (AWT §4.1), made anew in every sub-step: which boxes may touch, each pair once.
 *
 * A box is entered into every cell that it reaches, so that small boxes beside large ones cost nothing extra, and a
 * pair belongs to the first cell that both reach (along each axis, one of the two starts there): no pair is met twice
 * and no list of pairs met is needed. Only pairs
 * with at least one moving box matter; moving boxes have the lower numbers and stand first in every cell, and only
 * the room that they take is divided into cells. Where cells or entries would not fit their fixed capacities, the cells
 * grow until they do: nothing is ever left out. */
#ifndef SIM_GRID_H
#define SIM_GRID_H

#include "base/arena.h"
#include "base/lanes.h"

#include <stdint.h>

typedef struct grid_box {
    vec3 least, most;
} grid_box;

/* The cells that a box reaches: least .. most on each axis. */
typedef struct grid_span {
    uint16_t least[3], most[3];
} grid_span;

static inline bool grid_overlap(const grid_box *a, const grid_box *b)
{
    return a->least.x <= b->most.x && b->least.x <= a->most.x && a->least.y <= b->most.y && b->least.y <= a->most.y &&
           a->least.z <= b->most.z && b->least.z <= a->most.z;
}

typedef struct grid {
    uint32_t cell_capacity, entry_capacity;
    vec3 origin;
    float cells_per_m;
    uint32_t size[3];     /* cells along each axis */
    uint32_t *cell_first; /* [cell_capacity + 1]; entries of cell c: cell_first[c] .. cell_first[c + 1] - 1 */
    uint32_t *entry;      /* [entry_capacity]; boxes, ascending within a cell */
    grid_span *span;      /* [boxes]; least > most on an axis: outside of the grid */
    float *side[6];       /* [boxes + LANES] each: the boxes of the cell at hand, least x y z, most x y z */
    int32_t *starts;      /* [boxes + LANES]; bit k: the box reaches no cell before this one along axis k */
} grid;

/* Two boxes that overlap; the first one moves. */
typedef struct grid_pair {
    uint32_t a, b;
} grid_pair;

static inline float grid_least(float a, float b)
{
    return a < b ? a : b;
}

static inline float grid_most(float a, float b)
{
    return a > b ? a : b;
}

/* The box about a capsule from a to b. */
static inline grid_box grid_box_of(vec3 a, vec3 b, float radius)
{
    return (grid_box){
        {grid_least(a.x, b.x) - radius, grid_least(a.y, b.y) - radius, grid_least(a.z, b.z) - radius},
        {grid_most(a.x, b.x) + radius, grid_most(a.y, b.y) + radius, grid_most(a.z, b.z) + radius},
    };
}

/* Room for `boxes` boxes. */
void grid_lay_out(grid *g, arena *a, size_t boxes);

/* Enters `count` boxes, the first `moving` of which (at least one) move, into cells of `cell_extents` mean boxes. The
 * boxes are only read. */
void grid_build(grid *g, const grid_box *boxes, uint32_t moving, uint32_t count, float cell_extents);

static inline uint32_t grid_cell_count(const grid *g)
{
    return g->size[0] * g->size[1] * g->size[2];
}

/* Gives `visit` all pairs of boxes that overlap, at least one of them moving, each pair once and always in the same
 * order, GRID_PAIRS or fewer at a time. `boxes` are those of grid_build. */
void grid_visit_pairs(grid *g, const grid_box *boxes, uint32_t moving,
                      void (*visit)(void *context, const grid_pair *pairs, uint32_t count), void *context);

enum { GRID_PAIRS = 1024 };

#endif
