/* grid.h: a voxel grid over boxes (AWT §4.1), made anew in every sub-step: which boxes may touch, each pair once.
 *
 * A box is entered into every cell that it reaches, so that small boxes beside large ones cost nothing extra, and a
 * pair belongs to the first cell that both reach: no pair is met twice and no list of pairs met is needed. Only pairs
 * with at least one moving box matter; moving boxes have the lower numbers and stand first in every cell, and only
 * the room that they take is divided into cells. Where cells or entries would not fit their fixed capacities, the cells
 * grow until they do: nothing is ever left out. */
#ifndef SIM_GRID_H
#define SIM_GRID_H

#include "base/arena.h"
#include "base/vec.h"

#include <stdint.h>

typedef struct grid_box {
    vec3 least, most;
} grid_box;

/* The cells that a box reaches: least .. most on each axis. */
typedef struct grid_span {
    uint16_t least[3], most[3];
} grid_span;

typedef struct grid {
    uint32_t cell_capacity, entry_capacity;
    vec3 origin;
    float cells_per_m;
    uint32_t size[3];     /* cells along each axis */
    uint32_t *cell_first; /* [cell_capacity + 1]; entries of cell c: cell_first[c] .. cell_first[c + 1] - 1 */
    uint32_t *entry;      /* [entry_capacity]; boxes, ascending within a cell */
    grid_span *span;      /* [boxes]; least > most on an axis: outside of the grid */
} grid;

/* Room for `boxes` boxes. */
void grid_lay_out(grid *g, arena *a, size_t boxes);

/* Enters `count` boxes, the first `moving` of which (at least one) move. The boxes are only read. */
void grid_build(grid *g, const grid_box *boxes, uint32_t moving, uint32_t count);

static inline uint32_t grid_cell_count(const grid *g)
{
    return g->size[0] * g->size[1] * g->size[2];
}

/* The one cell in which a pair that meets anywhere is to be tested. */
static inline uint32_t grid_pair_cell(const grid *g, uint32_t a, uint32_t b)
{
    const uint16_t *p = g->span[a].least, *q = g->span[b].least;
    uint32_t x = p[0] > q[0] ? p[0] : q[0], y = p[1] > q[1] ? p[1] : q[1], z = p[2] > q[2] ? p[2] : q[2];
    return (z * g->size[1] + y) * g->size[0] + x;
}

#endif
