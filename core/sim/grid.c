/* grid.c: see grid.h. A counting sort of boxes into cells. */
#include "sim/grid.h"

/* Capacities per box; a box of mean extent reaches (1 + 1 / 1.3)^3 = 5.5 cells. */
enum { GRID_CELLS_PER_BOX = 8, GRID_ENTRIES_PER_BOX = 12, GRID_LEAST_CELLS = 64 };

/* Boxes of a cell that one is compared with before its pairs are taken. */
enum { GRID_PLACES = 512 };

#define GRID_LEAST_CELL_M 1e-4f
#define GRID_GROWTH 1.4f

void grid_lay_out(grid *g, arena *a, size_t boxes)
{
    g->cell_capacity = (uint32_t)(boxes * GRID_CELLS_PER_BOX + GRID_LEAST_CELLS);
    g->entry_capacity = (uint32_t)(boxes * GRID_ENTRIES_PER_BOX);
    g->cell_first = ARENA_PUSH(a, uint32_t, (size_t)g->cell_capacity + 1);
    g->entry = ARENA_PUSH(a, uint32_t, g->entry_capacity);
    g->span = ARENA_PUSH(a, grid_span, boxes);
    for (int k = 0; k < 6; k++) {
        g->side[k] = ARENA_PUSH(a, float, boxes + LANES);
    }
    g->starts = ARENA_PUSH(a, int32_t, boxes + LANES);
}

/* The box around all of them. */
static grid_box grid_bounds(const grid_box *boxes, uint32_t count)
{
    grid_box all = boxes[0];
    for (uint32_t i = 1; i < count; i++) {
        const grid_box *b = &boxes[i];
        all.least = vec3_make(grid_least(all.least.x, b->least.x), grid_least(all.least.y, b->least.y),
                              grid_least(all.least.z, b->least.z));
        all.most = vec3_make(grid_most(all.most.x, b->most.x), grid_most(all.most.y, b->most.y),
                             grid_most(all.most.z, b->most.z));
    }
    return all;
}

static float grid_mean_extent(const grid_box *boxes, uint32_t count)
{
    float sum = 0.0f;
    for (uint32_t i = 0; i < count; i++) {
        vec3 extent = vec3_sub(boxes[i].most, boxes[i].least);
        sum += extent.x + extent.y + extent.z;
    }
    return sum / (3.0f * (float)count);
}

/* Divides `bounds` into cells of this size. False: more cells than there is room for. */
static bool grid_divide(grid *g, const grid_box *bounds, float cell_m)
{
    vec3 extent = vec3_scale(vec3_sub(bounds->most, bounds->least), 1.0f / cell_m);
    float most = (float)UINT16_MAX - 2.0f;
    if (!(extent.x < most && extent.y < most && extent.z < most)) {
        return false;
    }
    g->origin = bounds->least;
    g->cells_per_m = 1.0f / cell_m;
    g->size[0] = (uint32_t)extent.x + 1;
    g->size[1] = (uint32_t)extent.y + 1;
    g->size[2] = (uint32_t)extent.z + 1;
    return (uint64_t)g->size[0] * g->size[1] * g->size[2] <= g->cell_capacity;
}

/* Cells that least .. most reaches along one axis of `size` cells from `origin`; monotone in both ends, so that boxes
 * that overlap share a cell. */
static void grid_span_axis(grid_span *span, int axis, float least, float most, float cells_per_m, uint32_t size)
{
    float first = least * cells_per_m, last = most * cells_per_m, end = (float)size;
    if (!(last >= 0.0f && first < end)) {
        span->least[axis] = 1;
        span->most[axis] = 0;
        return;
    }
    span->least[axis] = (uint16_t)(first > 0.0f ? first : 0.0f);
    span->most[axis] = (uint16_t)(last < end ? last : end - 1.0f);
}

static bool span_empty(const grid_span *s)
{
    return s->least[0] > s->most[0] || s->least[1] > s->most[1] || s->least[2] > s->most[2];
}

/* Spans of all boxes. False: more entries than there is room for. */
static bool grid_measure(grid *g, const grid_box *boxes, uint32_t count)
{
    uint64_t entries = 0;
    for (uint32_t i = 0; i < count; i++) {
        grid_span *s = &g->span[i];
        vec3 least = vec3_sub(boxes[i].least, g->origin), most = vec3_sub(boxes[i].most, g->origin);
        grid_span_axis(s, 0, least.x, most.x, g->cells_per_m, g->size[0]);
        grid_span_axis(s, 1, least.y, most.y, g->cells_per_m, g->size[1]);
        grid_span_axis(s, 2, least.z, most.z, g->cells_per_m, g->size[2]);
        if (!span_empty(s)) {
            entries += (uint64_t)(s->most[0] - s->least[0] + 1) * (uint64_t)(s->most[1] - s->least[1] + 1) *
                       (uint64_t)(s->most[2] - s->least[2] + 1);
        }
    }
    return entries <= g->entry_capacity;
}

/* cell_first[c] = entries of cell c. */
static void grid_count(grid *g, uint32_t count)
{
    const uint32_t cells = grid_cell_count(g);
    for (uint32_t c = 0; c < cells; c++) {
        g->cell_first[c] = 0;
    }
    for (uint32_t i = 0; i < count; i++) {
        const grid_span s = g->span[i];
        if (span_empty(&s)) {
            continue;
        }
        for (uint32_t z = s.least[2]; z <= s.most[2]; z++) {
            for (uint32_t y = s.least[1]; y <= s.most[1]; y++) {
                uint32_t *row = g->cell_first + (z * g->size[1] + y) * g->size[0];
                for (uint32_t x = s.least[0]; x <= s.most[0]; x++) {
                    row[x]++;
                }
            }
        }
    }
}

/* Counts become ends, and ends become beginnings as the cells fill from behind: boxes are entered from the last to the
 * first. */
static void grid_fill(grid *g, uint32_t count)
{
    const uint32_t cells = grid_cell_count(g);
    for (uint32_t c = 1; c < cells; c++) {
        g->cell_first[c] += g->cell_first[c - 1];
    }
    g->cell_first[cells] = g->cell_first[cells - 1];
    for (uint32_t i = count; i-- > 0;) {
        const grid_span s = g->span[i];
        if (span_empty(&s)) {
            continue;
        }
        for (uint32_t z = s.least[2]; z <= s.most[2]; z++) {
            for (uint32_t y = s.least[1]; y <= s.most[1]; y++) {
                uint32_t *row = g->cell_first + (z * g->size[1] + y) * g->size[0];
                for (uint32_t x = s.least[0]; x <= s.most[0]; x++) {
                    g->entry[--row[x]] = i;
                }
            }
        }
    }
}

void grid_build(grid *g, const grid_box *boxes, uint32_t moving, uint32_t count, float cell_extents)
{
    grid_box bounds = grid_bounds(boxes, moving);
    float cell_m = grid_most(cell_extents * grid_mean_extent(boxes, moving), GRID_LEAST_CELL_M);
    while (!grid_divide(g, &bounds, cell_m) || !grid_measure(g, boxes, count)) {
        cell_m *= GRID_GROWTH;
    }
    grid_count(g, count);
    grid_fill(g, count);
}

/* Puts the boxes of one cell side by side; returns how many. */
static uint32_t grid_open_cell(grid *g, const grid_box *boxes, const uint32_t cell[3], uint32_t index)
{
    const uint32_t *entry = g->entry + g->cell_first[index];
    const uint32_t count = g->cell_first[index + 1] - g->cell_first[index];
    for (uint32_t k = 0; k < count; k++) {
        const grid_box *box = &boxes[entry[k]];
        const grid_span *span = &g->span[entry[k]];
        g->side[0][k] = box->least.x, g->side[1][k] = box->least.y, g->side[2][k] = box->least.z;
        g->side[3][k] = box->most.x, g->side[4][k] = box->most.y, g->side[5][k] = box->most.z;
        g->starts[k] =
            (span->least[0] == cell[0]) | (span->least[1] == cell[1]) << 1 | (span->least[2] == cell[2]) << 2;
    }
    return count;
}

/* One box of the open cell, in all lanes. */
typedef struct grid_asker {
    lanes least[3], most[3];
    lanes_mask starts;
} grid_asker;

static inline grid_asker grid_asker_of(const grid *g, uint32_t i)
{
    return (grid_asker){
        .least = {lanes_of(g->side[0][i]), lanes_of(g->side[1][i]), lanes_of(g->side[2][i])},
        .most = {lanes_of(g->side[3][i]), lanes_of(g->side[4][i]), lanes_of(g->side[5][i])},
        .starts = (lanes_mask){0} + g->starts[i],
    };
}

/* Bit k: it overlaps box j + k, and the pair belongs to this cell. */
static inline uint32_t grid_overlaps(const grid *g, const grid_asker *i, uint32_t j)
{
    lanes_mask starts;
    memcpy(&starts, g->starts + j, sizeof starts);
    lanes_mask x = (lanes_load(g->side[0] + j) <= i->most[0]) & (lanes_load(g->side[3] + j) >= i->least[0]);
    lanes_mask y = (lanes_load(g->side[1] + j) <= i->most[1]) & (lanes_load(g->side[4] + j) >= i->least[1]);
    lanes_mask z = (lanes_load(g->side[2] + j) <= i->most[2]) & (lanes_load(g->side[5] + j) >= i->least[2]);
    return lanes_bits(((starts | i->starts) == 7) & x & y & z);
}

typedef struct grid_visitor {
    void (*visit)(void *context, const grid_pair *pairs, uint32_t count);
    void *context;
    uint32_t count;
    grid_pair pairs[GRID_PAIRS];
} grid_visitor;

/* Pairs of box `a` with the boxes at these places of the cell. */
static void grid_take(grid_visitor *v, uint32_t a, const uint32_t *entry, const uint16_t *places, uint32_t count)
{
    if (v->count + count > GRID_PAIRS) {
        v->visit(v->context, v->pairs, v->count);
        v->count = 0;
    }
    for (uint32_t n = 0; n < count; n++) {
        v->pairs[v->count + n] = (grid_pair){a, entry[places[n]]};
    }
    v->count += count;
}

static void grid_visit_cell(const grid *g, const uint32_t *entry, uint32_t count, uint32_t moving, grid_visitor *v)
{
    uint16_t places[GRID_PLACES + LANES];
    for (uint32_t i = 0; i < count && entry[i] < moving; i++) {
        const grid_asker asker = grid_asker_of(g, i);
        for (uint32_t begin = i + 1; begin < count; begin += GRID_PLACES) {
            const uint32_t end = count - begin < GRID_PLACES ? count - begin : GRID_PLACES;
            uint32_t met = 0;
            for (uint32_t j = 0; j < end; j += LANES) {
                met += lanes_list(grid_overlaps(g, &asker, begin + j), j, places + met);
            }
            while (met > 0 && places[met - 1] >= end) { /* what stands behind the cell's boxes is none */
                met--;
            }
            grid_take(v, entry[i], entry + begin, places, met);
        }
    }
}

void grid_visit_pairs(grid *g, const grid_box *boxes, uint32_t moving,
                      void (*visit)(void *context, const grid_pair *pairs, uint32_t count), void *context)
{
    grid_visitor v = {.visit = visit, .context = context};
    uint32_t index = 0, cell[3];
    for (cell[2] = 0; cell[2] < g->size[2]; cell[2]++) {
        for (cell[1] = 0; cell[1] < g->size[1]; cell[1]++) {
            for (cell[0] = 0; cell[0] < g->size[0]; cell[0]++, index++) {
                const uint32_t *entry = g->entry + g->cell_first[index];
                if (g->cell_first[index + 1] - g->cell_first[index] > 1 && entry[0] < moving) {
                    grid_visit_cell(g, entry, grid_open_cell(g, boxes, cell, index), moving, &v);
                }
            }
        }
    }
    if (v.count > 0) {
        visit(context, v.pairs, v.count);
    }
}
