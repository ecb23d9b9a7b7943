/* draco_write.c: see draco_write.h. */
#include "geom/draco_write.h"

#include "base/bytes.h"
#include "base/error.h"
#include "geom/numbers.h"

#include <stdlib.h>
#include <string.h>

enum { NUMBER_BITS = 15 }; /* of the symbols of 16-bit numbers */

typedef struct writer_lane {
    uint16_t *symbols;    /* [quantise_room(most_vertices)] */
    uint16_t *tags;       /* [most_vertices] */
    uint32_t *counts;     /* [4][2^bits] */
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
    lane->counts = hold(writer, 4 * alphabet * sizeof *lane->counts);
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
            make_lane(writer, most_vertices, bits, scheme, &writer->lanes[k]) &&
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
    size_t size = mesh->head_size + symbols_size + mesh->tail_size + DRACO_BOUNDS_BYTES + DRACO_BOX_BYTES;
    if (mesh->attributes.form == DRACO_POSITIONS_TURNS) {
        size += DRACO_BOUNDS_BYTES + sizeof DRACO_DIFFERENCES;
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
            const uint16_t greatest =
                numbers_differences(mesh->attributes.turn_bits, jobs[k].turns, mesh->vertices, lane->symbols);
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
        if (mesh) {
            jobs[k].found = jobs[k].numbers
                                ? quantise_number_differences(box->bits, jobs[k].numbers, mesh->vertices, lane->symbols)
                                : quantise_differences(box, bounds, jobs[k].positions, mesh->vertices, lane->symbols);
            runs[k] = run_of(lane, writer->scheme, mesh->vertices, UINT32_C(1) << box->bits, measure);
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

static unsigned char *put_bounds(unsigned char *at, int32_t least, int32_t greatest)
{
    store_u32(at, (uint32_t)least);
    store_u32(at + 4, (uint32_t)greatest);
    return at + DRACO_BOUNDS_BYTES;
}

static unsigned char *put_turns(unsigned char *at, const draco_attributes *attributes, const symbols_run *run)
{
    const int32_t reach = 1 << (attributes->turn_bits - 1);
    at = store_bytes(store_bytes(at, DRACO_DIFFERENCES, sizeof DRACO_DIFFERENCES), run->bytes, run->size);
    return put_bounds(at, -reach, reach - 1);
}

void draco_writer_put(const draco_writer *writer, const draco_box *box, const draco_job *job, int lane,
                      unsigned char *out)
{
    const draco_attributes *attributes = &job->mesh->attributes;
    unsigned char *at = store_bytes(out, job->mesh->head, job->mesh->head_size);
    const symbols_run *run = &writer->lanes[lane].run;
    at = store_bytes(store_bytes(at, run->bytes, run->size), run->bits, run->bits_size);
    at = put_bounds(at, 0, (1 << box->bits) - 1);
    if (attributes->form != DRACO_POSITIONS) {
        at = put_turns(at, attributes, &writer->turns[lane].run);
    }
    for (int k = 0; k < 3; k++) {
        store_f32(at + 4 * k, box->origin[k]);
    }
    store_f32(at + 12, box->range);
    at[16] = (unsigned char)box->bits;
    at += DRACO_BOX_BYTES;
    at = job->mesh->tail ? store_bytes(at, job->mesh->tail, job->mesh->tail_size) : at;
    memset(at, 0, job->size - (size_t)(at - out));
}
