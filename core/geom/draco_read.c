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

enum { INDEX_ALPHABET = 256 };
#define BOX_REACH_M 1e6f /* no hair is farther away; what is nearer cannot add up to a number that is not finite */

struct draco_reader {
    uint16_t *symbols; /* [3][most of vertices and triangles]; of triangles, then of positions */
    uint16_t *numbers; /* as many; of numbers */
    symbols_tables tables;
};

/* The bytes that are still to be read. */
typedef struct cursor {
    const unsigned char *at, *end;
} cursor;

awt_status draco_reader_create(uint32_t most_vertices, uint32_t most_triangles, draco_reader **out, awt_error *error)
{
    const size_t most = most_vertices > most_triangles ? most_vertices : most_triangles;
    draco_reader *reader = malloc(sizeof *reader);
    uint16_t *symbols = malloc(6 * most * sizeof *symbols);
    *out = NULL;
    if (!reader || !symbols) {
        free(reader);
        free(symbols);
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    reader->symbols = symbols;
    reader->numbers = symbols + 3 * most;
    *out = reader;
    return AWT_OK;
}

void draco_reader_destroy(draco_reader *reader)
{
    if (reader) {
        free(reader->symbols);
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

static bool take_indices(draco_reader *reader, cursor *c, const uint16_t *indices, uint32_t triangles)
{
    const unsigned char compressed = DRACO_INDICES_COMPRESSED;
    const size_t count = 3 * (size_t)triangles;
    if (!take_exactly(c, &compressed, 1) ||
        !symbols_read(&c->at, c->end, INDEX_ALPHABET, &reader->tables, reader->symbols, count)) {
        return false;
    }
    int index = 0, wrong = 0;
    for (size_t i = 0; i < count; i++) {
        int symbol = reader->symbols[i];
        index += symbol & 1 ? -(symbol >> 1) : symbol >> 1;
        wrong |= index ^ indices[i];
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

/* False: a symbol is none of numbers of so many bits. */
static bool fill_positions(const draco_box *box, uint16_t *symbols, size_t vertices, float *positions)
{
    const float step = draco_box_step(box);
    uint32_t all = 0;
    for (size_t i = 0; i < 3 * vertices; i++) {
        all |= symbols[i];
    }
    quantise_sum_up(box->bits, symbols, vertices, symbols);
    for (size_t i = 0; i < 3 * vertices; i += 3) {
        for (size_t k = 0; k < 3; k++) {
            positions[i + k] = (float)symbols[i + k] * step + box->origin[k];
        }
    }
    return all >> box->bits == 0;
}

static bool take_symbols(draco_reader *reader, cursor *c, uint16_t *symbols, uint32_t vertices)
{
    return symbols_read(&c->at, c->end, SYMBOLS_MAX_ALPHABET, &reader->tables, symbols, 3 * (size_t)vertices);
}

/* Header, counts and triangles; decoders count the bytes after the counts. */
static bool take_mesh(draco_reader *reader, cursor *c, const uint16_t *indices, uint32_t vertices, uint32_t triangles,
                      const unsigned char **after_counts)
{
    if (!take_exactly(c, DRACO_HEADER, sizeof DRACO_HEADER) || !take_count(c, triangles) || !take_count(c, vertices)) {
        return false;
    }
    *after_counts = c->at;
    return take_indices(reader, c, indices, triangles);
}

/* What describes positions and extra attributes. */
static bool take_description(cursor *c, uint32_t extra)
{
    unsigned char expected[sizeof DRACO_POSITION + DRACO_EXTRAS * DRACO_EXTRA_DESCRIPTION_BYTES];
    memcpy(expected, DRACO_POSITION, sizeof DRACO_POSITION);
    expected[0] = (unsigned char)(expected[0] + draco_extra_count(extra));
    const unsigned char *end = draco_extra_describe(extra, expected + sizeof DRACO_POSITION);
    return take_exactly(c, expected, (size_t)(end - expected));
}

bool draco_read(draco_reader *reader, uint32_t extra, const void *bytes, size_t size, const uint16_t *indices,
                uint32_t vertices, uint32_t triangles, float *positions)
{
    cursor c = {.at = bytes, .end = (const unsigned char *)bytes + size};
    const unsigned char *after_counts;
    draco_box box;
    int32_t least, greatest;
    return take_mesh(reader, &c, indices, vertices, triangles, &after_counts) && take_description(&c, extra) &&
           take_exactly(&c, DRACO_DIFFERENCES, sizeof DRACO_DIFFERENCES) &&
           take_symbols(reader, &c, reader->symbols, vertices) && take_bounds(&c, &least, &greatest) && least == 0 &&
           take_box(&c, greatest, &box) && (extra != 0 || take_zeros(&c, after_counts, triangles)) &&
           fill_positions(&box, reader->symbols, vertices, positions);
}

/* ---- turns */

/* Differences of `bits` bits. */
static bool take_turns(draco_reader *reader, cursor *c, int bits, uint32_t vertices, int16_t *turns)
{
    const int32_t reach = 1 << (bits - 1);
    int32_t least, greatest;
    return take_exactly(c, DRACO_DIFFERENCES, sizeof DRACO_DIFFERENCES) &&
           take_symbols(reader, c, reader->numbers, vertices) && take_bounds(c, &least, &greatest) && least == -reach &&
           greatest == reach - 1 && numbers_sum_up(bits, reader->numbers, vertices, turns);
}

bool draco_read_turns(draco_reader *reader, int turn_bits, const void *bytes, size_t size, const uint16_t *indices,
                      uint32_t vertices, uint32_t triangles, float *positions, int16_t *turns)
{
    cursor c = {.at = bytes, .end = (const unsigned char *)bytes + size};
    const unsigned char *after_counts;
    draco_box box;
    int32_t least, greatest;
    return take_mesh(reader, &c, indices, vertices, triangles, &after_counts) &&
           take_exactly(&c, DRACO_POSITION_TURN, sizeof DRACO_POSITION_TURN) &&
           take_exactly(&c, DRACO_DIFFERENCES, sizeof DRACO_DIFFERENCES) &&
           take_symbols(reader, &c, reader->symbols, vertices) && take_bounds(&c, &least, &greatest) && least == 0 &&
           take_turns(reader, &c, turn_bits, vertices, turns) && take_box(&c, greatest, &box) &&
           take_zeros(&c, after_counts, triangles) && fill_positions(&box, reader->symbols, vertices, positions);
}
