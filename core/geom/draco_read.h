/* draco_read.h: reads what draco_write.h wrote, from a source that need not be trusted, without libdraco.
 *
 * Stricter than stock decoders: counts, triangles and every constant part must be those expected, the entropy coder
 * must end as its encoder began, and nothing but the zeros that belong there may follow. What another encoder wrote is
 * refused, too, though it may be right: draco_shim.h reads that. */
#ifndef GEOM_DRACO_READ_H
#define GEOM_DRACO_READ_H

#include "awt.h"
#include "geom/draco_format.h"

/* The memory of one reader. */
typedef struct draco_reader draco_reader;
awt_status draco_reader_create(uint32_t most_vertices, uint32_t most_triangles, draco_reader **out, awt_error *error);
void draco_reader_destroy(draco_reader *reader);

/* Of extra attributes (draco_extra.h) it is checked that they are these; their data are not read, and may be anything.
 *
 * Reads the mesh of exactly these `vertices` and `triangles` with exactly these `indices` [triangles][3]; `positions`
 * [vertices][3] is filled with finite numbers. False: these bytes are not that, and `positions` may be half written. */
bool draco_read(draco_reader *reader, uint32_t extra, const void *bytes, size_t size, const uint16_t *indices,
                uint32_t vertices, uint32_t triangles, float *positions);

/* The same of a mesh with turns [vertices][3] of `turn_bits` bits beside its positions. */
bool draco_read_turns(draco_reader *reader, int turn_bits, const void *bytes, size_t size, const uint16_t *indices,
                      uint32_t vertices, uint32_t triangles, float *positions, int16_t *turns);

#endif
