/* draco_read.c: see draco_read.h. */
#include "geom/draco_read.h"

#include "base/error.h"
#include "geom/draco_format.h"
#include "geom/quantise.h"
#include "geom/symbols.h"
#include "geom/varint.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { INDEX_ALPHABET = 256 };
#define BOX_REACH_M 1e6f /* no hair is farther away; what is nearer cannot add up to a number that is not finite */

struct draco_reader {
    uint16_t *symbols; /* [3][most of vertices and triangles] */
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
    uint16_t *symbols = malloc(3 * most * sizeof *symbols);
    *out = NULL;
    if (!reader || !symbols) {
        free(reader);
        free(symbols);
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    reader->symbols = symbols;
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
    uint32_t count;
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

static bool take_box(cursor *c, draco_box *box)
{
    if (c->end - c->at < DRACO_TAIL_BYTES) {
        return false;
    }
    uint32_t least = take_u32(c), greatest = take_u32(c);
    for (int k = 0; k < 3; k++) {
        box->origin[k] = take_f32(c);
    }
    box->range = take_f32(c);
    box->bits = *c->at++;
    bool sound = box->range >= 0 && box->range <= BOX_REACH_M;
    for (int k = 0; k < 3; k++) {
        sound = sound && fabsf(box->origin[k]) <= BOX_REACH_M;
    }
    return sound && least == 0 && box->bits >= 1 && box->bits <= QUANTISE_MAX_BITS && greatest == (1u << box->bits) - 1;
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

bool draco_read(draco_reader *reader, const void *bytes, size_t size, const uint16_t *indices, uint32_t vertices,
                uint32_t triangles, float *positions)
{
    cursor c = {.at = bytes, .end = (const unsigned char *)bytes + size};
    draco_box box;
    if (!take_exactly(&c, DRACO_HEADER, sizeof DRACO_HEADER) || !take_count(&c, triangles) ||
        !take_count(&c, vertices)) {
        return false;
    }
    const unsigned char *after_counts = c.at;
    return take_indices(reader, &c, indices, triangles) && take_exactly(&c, DRACO_POSITION, sizeof DRACO_POSITION) &&
           take_exactly(&c, DRACO_DIFFERENCES, sizeof DRACO_DIFFERENCES) &&
           symbols_read(&c.at, c.end, SYMBOLS_MAX_ALPHABET, &reader->tables, reader->symbols, 3 * (size_t)vertices) &&
           take_box(&c, &box) && take_zeros(&c, after_counts, triangles) &&
           fill_positions(&box, reader->symbols, vertices, positions);
}
