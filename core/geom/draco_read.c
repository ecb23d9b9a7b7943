/* draco_read.c: see draco_read.h. */
#include "geom/draco_read.h"

#include "base/error.h"
#include "geom/draco_extra.h"
#include "geom/numbers.h"
#include "geom/quantise.h"
#include "geom/symbols.h"
#include "geom/varint.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { INDEX_ALPHABET = 256, BLOCK = QUANTISE_BLOCK };
#define BOX_REACH_M 1e6f /* no hair is farther away; what is nearer cannot add up to a number that is not finite */

/* Where one mesh's symbols go. */
typedef struct reader_lane {
    uint16_t *symbols; /* [3][most of vertices and triangles]; of positions */
    uint16_t *numbers; /* as many; of triangles, then of turns */
} reader_lane;

struct draco_reader {
    reader_lane lanes[RANS_LANES];
    uint16_t *memory;                  /* of all lanes */
    symbols_tables tables[RANS_LANES]; /* of triangles, then of positions, then of turns */
};

/* The bytes that are still to be read. */
typedef struct cursor {
    const unsigned char *at, *end;
} cursor;

/* Where reading of one mesh stands. */
typedef struct reading {
    const draco_source *source;
    reader_lane *lane;
    cursor c;
    const unsigned char *after_counts; /* from where on decoders count bytes */
    symbols_waiting run;               /* that is decoded next, or was last */
    int32_t greatest;                  /* of the whole numbers that positions are */
} reading;

awt_status draco_reader_create(uint32_t most_vertices, uint32_t most_triangles, draco_reader **out, awt_error *error)
{
    const size_t most = most_vertices > most_triangles ? most_vertices : most_triangles;
    draco_reader *reader = malloc(sizeof *reader);
    uint16_t *memory = malloc(RANS_LANES * 6 * most * sizeof *memory);
    *out = NULL;
    if (!reader || !memory) {
        free(reader);
        free(memory);
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    reader->memory = memory;
    for (size_t k = 0; k < RANS_LANES; k++) {
        reader->lanes[k] = (reader_lane){memory + 6 * most * k, memory + 6 * most * k + 3 * most};
    }
    *out = reader;
    return AWT_OK;
}

void draco_reader_destroy(draco_reader *reader)
{
    if (reader) {
        free(reader->memory);
        free(reader);
    }
}

static bool take_exactly(cursor *c, const void *bytes, size_t size)
{
    if ((size_t)(c->end - c->at) < size || memcmp(c->at, bytes, size) != 0) {
        return false;
    }
    c->at += size;
    return true;
}

static bool take_count(cursor *c, uint32_t expected)
{
    uint32_t count = 0; /* gcc at -O1 does not see that varint_take sets it */
    return varint_take(&c->at, c->end, &count) && count == expected;
}

static bool begin_indices(reading *r, symbols_tables *tables)
{
    const unsigned char compressed = DRACO_INDICES_COMPRESSED;
    return take_exactly(&r->c, &compressed, 1) &&
           symbols_begin(&r->c.at, r->c.end, INDEX_ALPHABET, tables, r->lane->numbers, 3 * (size_t)r->source->triangles,
                         &r->run);
}

/* The step to the next index that a symbol means. */
static inline int32_t step_of(uint16_t symbol)
{
    const int32_t s = symbol, sign = s & 1;
    return ((s >> 1) ^ -sign) + sign;
}

/* Not 0: a step of a block is another. One index stands before those of the block. */
static int32_t compare_block(const uint16_t *restrict symbols, const uint16_t *restrict indices)
{
    int32_t wrong = 0;
    for (int k = 0; k < BLOCK; k++) {
        wrong |= step_of(symbols[k]) ^ (indices[k] - indices[k - 1]);
    }
    return wrong;
}

static bool indices_agree(const symbols_waiting *run, const uint16_t *indices)
{
    int32_t wrong = step_of(run->symbols[0]) ^ indices[0];
    size_t i = 1;
    for (; i + BLOCK <= run->count; i += BLOCK) {
        wrong |= compare_block(run->symbols + i, indices + i);
    }
    for (; i < run->count; i++) {
        wrong |= step_of(run->symbols[i]) ^ (indices[i] - indices[i - 1]);
    }
    return wrong == 0;
}

static uint32_t take_u32(cursor *c)
{
    uint32_t value = 0;
    for (int k = 0; k < 4; k++) {
        value |= (uint32_t)*c->at++ << (8 * k);
    }
    return value;
}

static float take_f32(cursor *c)
{
    uint32_t bits = take_u32(c);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* The bounds of differences that wrap round. */
static bool take_bounds(cursor *c, int32_t *least, int32_t *greatest)
{
    if (c->end - c->at < DRACO_BOUNDS_BYTES) {
        return false;
    }
    *least = (int32_t)take_u32(c);
    *greatest = (int32_t)take_u32(c);
    return true;
}

/* `greatest`: of the whole numbers that positions are. */
static bool take_box(cursor *c, int32_t greatest, draco_box *box)
{
    if (c->end - c->at < DRACO_BOX_BYTES) {
        return false;
    }
    for (int k = 0; k < 3; k++) {
        box->origin[k] = take_f32(c);
    }
    box->range = take_f32(c);
    box->bits = *c->at++;
    bool sound = box->range >= 0 && box->range <= BOX_REACH_M;
    for (int k = 0; k < 3; k++) {
        sound = sound && fabsf(box->origin[k]) <= BOX_REACH_M;
    }
    return sound && box->bits >= 1 && box->bits <= QUANTISE_MAX_BITS && greatest == (1 << box->bits) - 1;
}

/* What follows makes the mesh as large as decoders ask for, and no larger. */
static bool take_zeros(const cursor *c, const unsigned char *after_counts, uint32_t triangles)
{
    size_t asked = (size_t)triangles * DRACO_BYTES_A_TRIANGLE, have = (size_t)(c->at - after_counts);
    if ((size_t)(c->end - c->at) != (asked > have ? asked - have : 0)) {
        return false;
    }
    unsigned char all = 0;
    for (const unsigned char *at = c->at; at < c->end; at++) {
        all |= *at;
    }
    return all == 0;
}

/* What describes positions and turns or extra attributes. */
static bool take_description(cursor *c, const draco_kind *kind)
{
    if (kind->turn_bits > 0) {
        return take_exactly(c, DRACO_POSITION_TURN, sizeof DRACO_POSITION_TURN);
    }
    unsigned char expected[sizeof DRACO_POSITION + DRACO_EXTRAS * DRACO_EXTRA_DESCRIPTION_BYTES];
    memcpy(expected, DRACO_POSITION, sizeof DRACO_POSITION);
    expected[0] = (unsigned char)(expected[0] + draco_extra_count(kind->extra));
    const unsigned char *end = draco_extra_describe(kind->extra, expected + sizeof DRACO_POSITION);
    return take_exactly(c, expected, (size_t)(end - expected));
}

static bool begin_differences(reading *r, symbols_tables *tables, uint16_t *symbols)
{
    return take_exactly(&r->c, DRACO_DIFFERENCES, sizeof DRACO_DIFFERENCES) &&
           symbols_begin(&r->c.at, r->c.end, SYMBOLS_MAX_ALPHABET, tables, symbols, 3 * (size_t)r->source->vertices,
                         &r->run);
}

/* ---- meshes in step: each of these is done for all before the next, and between them the symbols are decoded */

/* Up to where triangles end. */
static bool begin_mesh(draco_reader *reader, int lane, const draco_source *source, reading *r)
{
    cursor *c = &r->c;
    *r = (reading){.source = source, .lane = &reader->lanes[lane], .c = {source->bytes, source->bytes + source->size}};
    if (!take_exactly(c, DRACO_HEADER, sizeof DRACO_HEADER) || !take_count(c, source->triangles) ||
        !take_count(c, source->vertices)) {
        return false;
    }
    r->after_counts = c->at;
    return begin_indices(r, &reader->tables[lane]);
}

/* Up to where positions or, of the tagged scheme, their tags end. */
static bool pass_triangles(draco_reader *reader, int lane, const draco_kind *kind, reading *r)
{
    return indices_agree(&r->run, kind->indices) && take_description(&r->c, kind) &&
           begin_differences(r, &reader->tables[lane], r->lane->symbols);
}

/* Up to where turns end, where there are any. */
static bool pass_positions(draco_reader *reader, int lane, const draco_kind *kind, reading *r)
{
    cursor *c = &r->c;
    int32_t least;
    return symbols_end(&c->at, c->end, &r->run) && take_bounds(c, &least, &r->greatest) && least == 0 &&
           (kind->turn_bits == 0 || begin_differences(r, &reader->tables[lane], r->lane->numbers));
}

/* The numbers that turns are, `bits` bits each. */
static bool take_turns(reading *r, int bits)
{
    const int32_t reach = 1 << (bits - 1);
    int32_t least, greatest;
    return symbols_end(&r->c.at, r->c.end, &r->run) && take_bounds(&r->c, &least, &greatest) && least == -reach &&
           greatest == reach - 1 && numbers_sum_up(bits, r->lane->numbers, r->source->vertices, r->source->turns);
}

static bool end_mesh(const draco_kind *kind, reading *r)
{
    draco_box box;
    return (kind->turn_bits == 0 || take_turns(r, kind->turn_bits)) && take_box(&r->c, r->greatest, &box) &&
           (kind->extra != 0 || take_zeros(&r->c, r->after_counts, r->source->triangles)) &&
           quantise_positions(&box, r->lane->symbols, r->source->vertices, r->source->positions);
}

static bool decode(const reading meshes[RANS_LANES], int count)
{
    rans_target targets[RANS_LANES] = {{.count = 0}};
    for (int k = 0; k < count; k++) {
        targets[k] = meshes[k].run.target;
    }
    return rans_decode_lanes(targets);
}

bool draco_read(draco_reader *reader, const draco_kind *kind, const draco_source sources[RANS_LANES])
{
    reading meshes[RANS_LANES];
    int count = 0;
    bool right = true;
    for (int k = 0; right && k < RANS_LANES; k++) {
        if (sources[k].vertices > 0) {
            right = begin_mesh(reader, count, &sources[k], &meshes[count]);
            count++;
        }
    }
    right = right && decode(meshes, count);
    for (int k = 0; right && k < count; k++) {
        right = pass_triangles(reader, k, kind, &meshes[k]);
    }
    right = right && decode(meshes, count);
    for (int k = 0; right && k < count; k++) {
        right = pass_positions(reader, k, kind, &meshes[k]);
    }
    right = right && (kind->turn_bits == 0 || decode(meshes, count));
    for (int k = 0; right && k < count; k++) {
        right = end_mesh(kind, &meshes[k]);
    }
    return right;
}
