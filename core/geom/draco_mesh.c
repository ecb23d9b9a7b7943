/* draco_mesh.c: of a mesh what never changes (draco_write.h): header, counts, triangles, and which attributes follow.
 */
#include "geom/draco_write.h"

#include "base/bytes.h"
#include "base/error.h"
#include "geom/varint.h"

#include <stdlib.h>
#include <string.h>

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

/* Header and counts; decoders count the bytes after it. */
static unsigned char *put_counts(unsigned char *at, const draco_mesh *mesh)
{
    at = store_bytes(at, DRACO_HEADER, sizeof DRACO_HEADER);
    return varint_put(varint_put(at, mesh->triangles), mesh->vertices);
}

/* Which attributes there are, and how the first one is predicted. */
static unsigned char *put_attributes(unsigned char *at, draco_form form)
{
    at = form == DRACO_POSITIONS ? store_bytes(at, DRACO_POSITION, sizeof DRACO_POSITION)
                                 : store_bytes(at, DRACO_POSITION_TURN, sizeof DRACO_POSITION_TURN);
    return store_bytes(at, DRACO_DIFFERENCES, sizeof DRACO_DIFFERENCES);
}

awt_status draco_mesh_make(uint32_t vertices, const uint16_t *indices, uint32_t triangles,
                           const draco_attributes *attributes, draco_mesh *out, awt_error *error)
{
    enum { ALPHABET = 2 * DRACO_MESH_REACH + 2 };
    const size_t count = 3 * (size_t)triangles, bound = symbols_bound(ALPHABET, count);
    uint32_t counts[4 * ALPHABET];
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
    at = store_bytes(at, coded, runs[0].size);
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
    free(mesh->tail);
    *mesh = (draco_mesh){0};
}
