/* pack.c: see pack.h. A level's segments are entered into the voxel grid with some space around them, first a little,
 * then twice as much for those that have not found their neighbours in it, until it is as wide as their own radii let
 * neighbours matter. In a cell each meets the next ones in number, which are its own neighbours, and not all of a heap:
 * a groom of coincident strands costs no more than another. */
#include "groom/pack.h"

#include "base/nearest.h"
#include "sim/grid.h"

enum {
    PACK_NEIGHBOURS = 6, /* of a cylinder among its like */
    PACK_MEETS = 128     /* others that a segment is measured against in one cell */
};

/* The first space, of the level's mean radius. */
#define PACK_FIRST_SPACE 0.125f

/* Of a cell of the grid: small, for PACK_MEETS bounds what is compared in one. */
#define PACK_CELL_EXTENTS 1.3f

/* A segment's nearest other GCs. */
typedef struct neighbours {
    float distance[PACK_NEIGHBOURS]; /* ascending */
    uint32_t gc[PACK_NEIGHBOURS];
} neighbours;

/* One level at work. Segment n of it: (first_gc + n / (sections - 1)), from section n % (sections - 1) on. */
typedef struct packing {
    awt_groom *groom;
    uint32_t first_gc, count; /* segments */
    grid grid;
    grid_box *boxes;
    neighbours *near;
    bool *known;
} packing;

static uint32_t packing_gc(const packing *p, uint32_t n)
{
    return p->first_gc + n / (p->groom->info.sections - 1);
}

/* Node at the root's side of segment n; the other end is the next. */
static uint32_t packing_node(const packing *p, uint32_t n)
{
    const uint32_t segments = p->groom->info.sections - 1;
    return packing_gc(p, n) * p->groom->info.sections + n % segments;
}

/* Takes GC `gc` at `distance` into the list. */
static void neighbours_take(neighbours *near, uint32_t gc, float distance)
{
    int last = PACK_NEIGHBOURS - 1;
    for (int k = 0; k < PACK_NEIGHBOURS; k++) { /* nearer than before, or no news */
        last = near->gc[k] == gc ? k : last;
    }
    if (!(distance < near->distance[last])) {
        return;
    }
    for (; last > 0 && near->distance[last - 1] > distance; last--) {
        near->distance[last] = near->distance[last - 1];
        near->gc[last] = near->gc[last - 1];
    }
    near->distance[last] = distance;
    near->gc[last] = gc;
}

/* Does segment n know its neighbours, when all within `space_m` have been met? */
static bool packing_knows(const packing *p, uint32_t n, float space_m)
{
    return p->near[n].distance[PACK_NEIGHBOURS - 1] <= space_m ||
           2.0f * p->groom->rest_radius[packing_node(p, n) + 1] <= space_m;
}

static void packing_meet(packing *p, uint32_t a, uint32_t b)
{
    uint32_t gc_a = packing_gc(p, a), gc_b = packing_gc(p, b);
    if (gc_a == gc_b || !grid_overlap(&p->boxes[a], &p->boxes[b])) {
        return;
    }
    const vec3 *rest_a = p->groom->rest_position + packing_node(p, a);
    const vec3 *rest_b = p->groom->rest_position + packing_node(p, b);
    float distance =
        nearest_distance(rest_a[0], vec3_sub(rest_a[1], rest_a[0]), rest_b[0], vec3_sub(rest_b[1], rest_b[0]));
    neighbours_take(&p->near[a], gc_b, distance);
    neighbours_take(&p->near[b], gc_a, distance);
}

/* One round: those that do not know their neighbours get `space_m` around them. */
static void packing_round(packing *p, float space_m)
{
    for (uint32_t n = 0; n < p->count; n++) {
        const vec3 *rest = p->groom->rest_position + packing_node(p, n);
        float around = p->known[n] ? 0.0f : space_m;
        p->boxes[n] = grid_box_of(rest[0], rest[1], around);
    }
    grid_build(&p->grid, p->boxes, p->count, p->count, PACK_CELL_EXTENTS);
    for (uint32_t cell = 0; cell < grid_cell_count(&p->grid); cell++) {
        const uint32_t end = p->grid.cell_first[cell + 1];
        for (uint32_t i = p->grid.cell_first[cell]; i < end; i++) {
            for (uint32_t j = i + 1; j < end && j <= i + PACK_MEETS; j++) {
                packing_meet(p, p->grid.entry[i], p->grid.entry[j]);
            }
        }
    }
}

static void pack_level(packing *p, uint32_t level)
{
    awt_groom *groom = p->groom;
    p->first_gc = groom->level_first[level];
    p->count = groom->info.wisp_count[level] * (groom->info.sections - 1);
    double radii = 0.0;
    for (uint32_t n = 0; n < p->count; n++) {
        radii += (double)groom->rest_radius[packing_node(p, n) + 1];
        p->known[n] = false;
        for (int k = 0; k < PACK_NEIGHBOURS; k++) {
            p->near[n].distance[k] = INFINITY;
            p->near[n].gc[k] = UINT32_MAX;
        }
    }
    float space_m = PACK_FIRST_SPACE * (float)(radii / p->count);
    for (uint32_t unknown = p->count; unknown > 0 && space_m > 0.0f; space_m *= 2.0f) {
        packing_round(p, space_m);
        unknown = 0;
        for (uint32_t n = 0; n < p->count; n++) {
            p->known[n] = packing_knows(p, n, space_m);
            unknown += !p->known[n];
        }
    }
    for (uint32_t n = 0; n < p->count; n++) {
        uint32_t node = packing_node(p, n) + 1;
        float room = 0.5f * p->near[n].distance[PACK_NEIGHBOURS - 1], radius = groom->rest_radius[node];
        groom->rest_room[node] = room < radius ? room : radius;
    }
}

static void packing_lay_out(packing *p, arena *memory)
{
    const size_t most = (size_t)p->groom->info.wisp_count[p->groom->info.levels - 1] * (p->groom->info.sections - 1);
    p->boxes = ARENA_PUSH(memory, grid_box, most);
    p->near = ARENA_PUSH(memory, neighbours, most);
    p->known = ARENA_PUSH(memory, bool, most);
    grid_lay_out(&p->grid, memory, most);
}

bool pack_wisps(awt_groom *groom)
{
    packing p = {.groom = groom};
    arena counting = arena_counting(), memory = {0};
    packing_lay_out(&p, &counting);
    if (counting.overflowed || !arena_init(&memory, counting.used)) {
        return false;
    }
    packing_lay_out(&p, &memory);
    for (uint32_t level = 0; level < groom->info.levels; level++) {
        pack_level(&p, level);
    }
    arena_fini(&memory);
    return true;
}
