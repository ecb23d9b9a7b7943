/* draco_write.h: meshes of one topology into Draco's bitstream, fast: what never changes is made once and copied.
 *
 * Draco 2.2, triangular mesh, sequential (vertex order is strand order), one float position a vertex, quantised to a
 * box that the caller fixes, predicted by difference:
 *
 *   header | varint triangles | varint vertices | u8 0: compressed | the indices' differences as symbols
 *   | one attribute: position, float32, 3, quantised | difference prediction, wrapped | u8 1: compressed
 *   | the differences as symbols | i32 0, i32 2^bits - 1 | f32 origin[3] | f32 range | u8 bits | zeros, if any
 *
 * Meshes with numbers beside their positions (draco_format.h) have a second attribute: its symbols and bounds stand
 * before origin, range and bits.
 *
 * Sources: Draco's bitstream specification and STREAM.md. Stock libdraco (draco_shim.h) decodes it to the same integers
 * that its own encoder would have put there. A function of the mesh, the positions and the caller's memory. */
#ifndef GEOM_DRACO_WRITE_H
#define GEOM_DRACO_WRITE_H

#include "awt.h"
#include "geom/draco_format.h"
#include "geom/quantise.h"
#include "geom/symbols.h"

/* What the meshes of one patch have in common. Immutable once made. */
typedef struct draco_mesh {
    uint32_t vertices, triangles;
    draco_attributes attributes;
    unsigned char *head; /* [head_size]: everything before the first symbols of vertices; heap */
    size_t head_size;
    unsigned char *tail; /* [tail_size]: what follows the positions (draco_extra.h); heap; NULL: nothing */
    size_t tail_size;
    size_t least_size; /* decoders refuse a smaller one; zeros fill it up */
} draco_mesh;

/* Makes one from `indices` [triangles][3], each at most DRACO_MESH_REACH from the one before. `attributes` NULL:
 * positions alone. AWT_NO_MEMORY. */
enum { DRACO_MESH_REACH = 127 };
awt_status draco_mesh_make(uint32_t vertices, const uint16_t *indices, uint32_t triangles,
                           const draco_attributes *attributes, draco_mesh *out, awt_error *error);
void draco_mesh_fini(draco_mesh *mesh);

/* One mesh to be written. */
typedef struct draco_job {
    const draco_mesh *mesh;  /* NULL: a job that is not used */
    const float *positions;  /* [vertices][3] */
    const uint16_t *numbers; /* [vertices][3]: these in their stead, below 2^bits of the box */
    const int16_t *turns;    /* [vertices][3], where the mesh has any */
    quantise_findings found;
    size_t size;         /* out: bytes of the mesh */
    double entropy_bits; /* out, where asked for: of the vertices' symbols */
} draco_job;

/* The memory of one encoder. */
typedef struct draco_writer draco_writer;
/* For meshes of one form; `bits` of positions. */
awt_status draco_writer_create(uint32_t most_vertices, int bits, symbols_scheme scheme, draco_form form,
                               draco_writer **out, awt_error *error);
void draco_writer_destroy(draco_writer *writer);
/* Bytes that it holds. */
size_t draco_writer_bytes(const draco_writer *writer);

/* Encodes up to RANS_LANES meshes, whose positions are set onto `bounds` within the box; draco_writer_put then
 * gives their bytes. Where a job found a coordinate that is not finite, its bytes mean nothing. `measure`: entropies
 * too. */
void draco_writer_run(draco_writer *writer, const draco_box *box, const quantise_bounds *bounds,
                      draco_job jobs[RANS_LANES], bool measure);
/* Copies the mesh of job number `lane` of the last run to `out` [jobs[lane].size]. */
void draco_writer_put(const draco_writer *writer, const draco_box *box, const draco_job *job, int lane,
                      unsigned char *out);

#endif
