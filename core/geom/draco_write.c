/* draco_write.c: see draco_write.h. */
#include "geom/draco_write.h"

#include "base/error.h"
#include "geom/numbers.h"
#include "geom/varint.h"

#include <stdlib.h>
#include <string.h>

/* ---- what never changes */

/* Each index's difference to the one before, with its sign in the lowest bit. */
static uint16_t *make_index_symbols(const uint16_t *indices, size_t count)
{
    uint16_t *symbols = malloc(count * sizeof *symbols);
    int before = 0;
    for (size_t i = 0; symbols && i < count; i++) {
        int difference = indices[i] - before;
        symbols[i] = (uint16_t)(difference < 0 ? -2 * difference + 1 : 2 * difference);
        before = indices[i];
    }
    return symbols;
}

static unsigned char *put_bytes(unsigned char *at, const void *bytes, size_t size)
{
    memcpy(at, bytes, size);
    return at + size;
}

/* Header and counts; decoders count the bytes after it. */
static unsigned char *put_counts(unsigned char *at, const draco_mesh *mesh)
{
    at = put_bytes(at, DRACO_HEADER, sizeof DRACO_HEADER);
    return varint_put(varint_put(at, mesh->triangles), mesh->vertices);
}

/* Which attributes there are, and how the first one is predicted. */
static unsigned char *put_attributes(unsigned char *at, draco_form form)
{
    if (form == DRACO_OFFSETS_TURNS) {
        return put_bytes(put_bytes(at, DRACO_OFFSET_TURN, sizeof DRACO_OFFSET_TURN), DRACO_PLAIN, sizeof DRACO_PLAIN);
    }
    at = form == DRACO_POSITIONS ? put_bytes(at, DRACO_POSITION, sizeof DRACO_POSITION)
                                 : put_bytes(at, DRACO_POSITION_TURN, sizeof DRACO_POSITION_TURN);
    return put_bytes(at, DRACO_DIFFERENCES, sizeof DRACO_DIFFERENCES);
}

awt_status draco_mesh_make(uint32_t vertices, const uint16_t *indices, uint32_t triangles,
                           const draco_attributes *attributes, draco_mesh *out, awt_error *error)
{
    enum { ALPHABET = 2 * DRACO_MESH_REACH + 2 };
    const size_t count = 3 * (size_t)triangles, bound = symbols_bound(ALPHABET, count);
    uint32_t counts[2 * ALPHABET];
    uint16_t used[ALPHABET];
    rans_entry entries[ALPHABET];
    uint16_t *symbols = make_index_symbols(indices, count);
    unsigned char *coded = malloc(bound);
    draco_mesh mesh = {.vertices = vertices, .triangles = triangles};
    mesh.attributes = attributes ? *attributes : (draco_attributes){.form = DRACO_POSITIONS};
    mesh.head = malloc(bound + DRACO_AROUND_BYTES);
    if (!symbols || !coded || !mesh.head) {
        free(symbols);
        free(coded);
        free(mesh.head);
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    symbols_run runs[RANS_LANES] = {{.scheme = SYMBOLS_RAW,
                                     .symbols = symbols,
                                     .count = count,
                                     .alphabet = ALPHABET,
                                     .counts = counts,
                                     .used = used,
                                     .entries = entries,
                                     .bytes = coded}};
    symbols_write(runs);
    unsigned char *at = put_counts(mesh.head, &mesh);
    mesh.least_size = (size_t)(at - mesh.head) + (size_t)triangles * DRACO_BYTES_A_TRIANGLE;
    *at++ = DRACO_INDICES_COMPRESSED;
    at = put_bytes(at, coded, runs[0].size);
    at = put_attributes(at, mesh.attributes.form);
    mesh.head_size = (size_t)(at - mesh.head);
    free(symbols);
    free(coded);
    unsigned char *fitting = realloc(mesh.head, mesh.head_size);
    mesh.head = fitting ? fitting : mesh.head;
    *out = mesh;
    return AWT_OK;
}

void draco_mesh_fini(draco_mesh *mesh)
{
    free(mesh->head);
    *mesh = (draco_mesh){0};
}

/* ---- what does */

enum { NUMBER_BITS = 15 }; /* of the symbols of 16-bit numbers */

typedef struct writer_lane {
    uint16_t *symbols;    /* [quantise_room(most_vertices)] */
    uint16_t *tags;       /* [most_vertices] */
    uint32_t *counts;     /* [2][2^bits] */
    uint16_t *used;       /* [2^bits] */
    rans_entry *entries;  /* [2^bits] */
    unsigned char *bytes; /* [symbols_bound] */
    unsigned char *bits;  /* [symbols_bits_bound] */
    symbols_run run;      /* the last one */
} writer_lane;

struct draco_writer {
    symbols_scheme scheme;
    size_t held;
    writer_lane lanes[RANS_LANES];
    writer_lane turns[RANS_LANES]; /* of the second attribute, where there is one */
};

static void *hold(draco_writer *writer, size_t size)
{
    writer->held += size;
    return malloc(size);
}

static bool make_lane(draco_writer *writer, uint32_t most_vertices, int bits, symbols_scheme scheme, writer_lane *lane)
{
    const uint32_t alphabet = UINT32_C(1) << bits;
    const size_t coordinates = 3 * (size_t)most_vertices;
    const bool tagged = scheme == SYMBOLS_TAGGED;
    lane->symbols = hold(writer, quantise_room(most_vertices) * sizeof *lane->symbols);
    lane->tags = hold(writer, tagged ? most_vertices * sizeof *lane->tags : 1);
    lane->counts = hold(writer, 2 * alphabet * sizeof *lane->counts);
    lane->used = hold(writer, alphabet * sizeof *lane->used);
    lane->entries = hold(writer, alphabet * sizeof *lane->entries);
    lane->bytes = hold(writer, symbols_bound(alphabet, coordinates));
    lane->bits = hold(writer, tagged ? symbols_bits_bound(coordinates) : 1);
    return lane->symbols && lane->tags && lane->counts && lane->used && lane->entries && lane->bytes && lane->bits;
}

static void free_lane(writer_lane *lane)
{
    free(lane->symbols);
    free(lane->tags);
    free(lane->counts);
    free(lane->used);
    free(lane->entries);
    free(lane->bytes);
    free(lane->bits);
}

awt_status draco_writer_create(uint32_t most_vertices, int bits, symbols_scheme scheme, draco_form form,
                               draco_writer **out, awt_error *error)
{
    draco_writer *writer = calloc(1, sizeof *writer);
    bool made = writer != NULL;
    if (writer) {
        writer->scheme = scheme;
        writer->held = sizeof *writer;
    }
    for (int k = 0; made && k < RANS_LANES; k++) {
        made =
            make_lane(writer, most_vertices, form == DRACO_OFFSETS_TURNS ? NUMBER_BITS : bits, scheme,
                      &writer->lanes[k]) &&
            (form == DRACO_POSITIONS || make_lane(writer, most_vertices, NUMBER_BITS, SYMBOLS_RAW, &writer->turns[k]));
    }
    if (!made) {
        draco_writer_destroy(writer);
        *out = NULL;
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    *out = writer;
    return AWT_OK;
}

void draco_writer_destroy(draco_writer *writer)
{
    for (int k = 0; writer && k < RANS_LANES; k++) {
        free_lane(&writer->lanes[k]);
        free_lane(&writer->turns[k]);
    }
    free(writer);
}

size_t draco_writer_bytes(const draco_writer *writer)
{
    return writer->held;
}

static size_t size_of(const draco_mesh *mesh, size_t symbols_size)
{
    size_t size = mesh->head_size + symbols_size;
    switch (mesh->attributes.form) {
    case DRACO_POSITIONS:
        size += DRACO_BOUNDS_BYTES + DRACO_BOX_BYTES;
        break;
    case DRACO_POSITIONS_TURNS:
        size += 2 * DRACO_BOUNDS_BYTES + DRACO_BOX_BYTES + sizeof DRACO_DIFFERENCES;
        break;
    case DRACO_OFFSETS_TURNS:
        size += sizeof DRACO_PLAIN;
        break;
    }
    return size > mesh->least_size ? size : mesh->least_size;
}

static symbols_run run_of(const writer_lane *lane, symbols_scheme scheme, uint32_t vertices, uint32_t alphabet,
                          bool measure)
{
    return (symbols_run){.scheme = scheme,
                         .symbols = lane->symbols,
                         .count = 3 * (size_t)vertices,
                         .alphabet = alphabet,
                         .counts = lane->counts,
                         .used = lane->used,
                         .entries = lane->entries,
                         .tags = lane->tags,
                         .bytes = lane->bytes,
                         .bits = lane->bits,
                         .measure = measure};
}

/* No larger than these symbols need, for a large alphabet takes its time. */
static uint32_t alphabet_of(uint16_t greatest)
{
    enum { LEAST_ALPHABET = 32 };
    return greatest < LEAST_ALPHABET ? LEAST_ALPHABET : greatest + 1u;
}

static void run_turns(draco_writer *writer, draco_job jobs[RANS_LANES], bool measure)
{
    symbols_run runs[RANS_LANES] = {{0}};
    for (int k = 0; k < RANS_LANES; k++) {
        const draco_mesh *mesh = jobs[k].mesh;
        writer_lane *lane = &writer->turns[k];
        if (mesh && mesh->attributes.form != DRACO_POSITIONS) {
            uint16_t greatest =
                mesh->attributes.form == DRACO_OFFSETS_TURNS
                    ? numbers_plain(jobs[k].turns, mesh->vertices, lane->symbols)
                    : numbers_differences(mesh->attributes.turn_bits, jobs[k].turns, mesh->vertices, lane->symbols);
            runs[k] = run_of(lane, SYMBOLS_RAW, mesh->vertices, alphabet_of(greatest), measure);
        }
    }
    symbols_write(runs);
    for (int k = 0; k < RANS_LANES; k++) {
        writer->turns[k].run = runs[k];
    }
}

void draco_writer_run(draco_writer *writer, const draco_box *box, const quantise_bounds *bounds,
                      draco_job jobs[RANS_LANES], bool measure)
{
    symbols_run runs[RANS_LANES] = {{0}};
    for (int k = 0; k < RANS_LANES; k++) {
        const draco_mesh *mesh = jobs[k].mesh;
        writer_lane *lane = &writer->lanes[k];
        uint32_t alphabet = UINT32_C(1) << box->bits;
        if (mesh && mesh->attributes.form == DRACO_OFFSETS_TURNS) {
            alphabet = alphabet_of(numbers_plain(jobs[k].offsets, mesh->vertices, lane->symbols));
        } else if (mesh) {
            jobs[k].found = quantise_differences(box, bounds, jobs[k].positions, mesh->vertices, lane->symbols);
        }
        if (mesh) {
            runs[k] = run_of(lane, writer->scheme, mesh->vertices, alphabet, measure);
        }
    }
    symbols_write(runs);
    run_turns(writer, jobs, measure);
    for (int k = 0; k < RANS_LANES; k++) {
        if (jobs[k].mesh) {
            const symbols_run *turns = &writer->turns[k].run;
            writer->lanes[k].run = runs[k];
            jobs[k].size = size_of(jobs[k].mesh, runs[k].size + runs[k].bits_size + turns->size);
            jobs[k].entropy_bits = runs[k].entropy_bits + turns->entropy_bits;
        }
    }
}

static unsigned char *put_u32(unsigned char *at, uint32_t value)
{
    for (int k = 0; k < 4; k++) {
        *at++ = (unsigned char)(value >> (8 * k));
    }
    return at;
}

static unsigned char *put_f32(unsigned char *at, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return put_u32(at, bits);
}

static unsigned char *put_bounds(unsigned char *at, int32_t least, int32_t greatest)
{
    return put_u32(put_u32(at, (uint32_t)least), (uint32_t)greatest);
}

static unsigned char *put_turns(unsigned char *at, const draco_attributes *attributes, const symbols_run *run)
{
    if (attributes->form == DRACO_OFFSETS_TURNS) {
        return put_bytes(put_bytes(at, DRACO_PLAIN, sizeof DRACO_PLAIN), run->bytes, run->size);
    }
    const int32_t reach = 1 << (attributes->turn_bits - 1);
    at = put_bytes(put_bytes(at, DRACO_DIFFERENCES, sizeof DRACO_DIFFERENCES), run->bytes, run->size);
    return put_bounds(at, -reach, reach - 1);
}

void draco_writer_put(const draco_writer *writer, const draco_box *box, const draco_job *job, int lane,
                      unsigned char *out)
{
    const draco_attributes *attributes = &job->mesh->attributes;
    unsigned char *at = put_bytes(out, job->mesh->head, job->mesh->head_size);
    const symbols_run *run = &writer->lanes[lane].run;
    at = put_bytes(put_bytes(at, run->bytes, run->size), run->bits, run->bits_size);
    if (attributes->form != DRACO_OFFSETS_TURNS) {
        at = put_bounds(at, 0, (1 << box->bits) - 1);
    }
    if (attributes->form != DRACO_POSITIONS) {
        at = put_turns(at, attributes, &writer->turns[lane].run);
    }
    if (attributes->form != DRACO_OFFSETS_TURNS) {
        for (int k = 0; k < 3; k++) {
            at = put_f32(at, box->origin[k]);
        }
        at = put_f32(at, box->range);
        *at++ = (unsigned char)box->bits;
    }
    memset(at, 0, job->size - (size_t)(at - out));
}
