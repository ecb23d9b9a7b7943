/* draco_read.h: reads what draco_write.h wrote, from a source that need not be trusted, without libdraco.
 *
 * Stricter than stock decoders: counts, triangles and every constant part must be those expected, the entropy coder
 * must end as its encoder began, and nothing but the zeros that belong there may follow. What another encoder wrote is
 * refused, too, though it may be right: draco_shim.h reads that. */
#ifndef GEOM_DRACO_READ_H
#define GEOM_DRACO_READ_H

#include "awt.h"
#include "geom/draco_format.h"
#include "geom/rans.h"

/* The memory of one reader, which goes through RANS_LANES meshes at once. */
typedef struct draco_reader draco_reader;
awt_status draco_reader_create(uint32_t most_vertices, uint32_t most_triangles, draco_reader **out, awt_error *error);
void draco_reader_destroy(draco_reader *reader);

/* What meshes must be of. */
typedef struct draco_kind {
    const uint16_t *indices; /* [triangles of the largest][3]; every mesh's are the first of them */
    uint32_t extra;          /* attributes; it is checked that they are these, their data may be anything */
    int turn_bits;           /* 0: no turns */
} draco_kind;

/* One mesh on its way in: of exactly these `vertices` and `triangles`, 1 or more of each, within the reader's. */
typedef struct draco_source {
    const unsigned char *bytes; /* [size] */
    size_t size;
    uint32_t vertices, triangles; /* vertices 0: a source that is not used */
    float *positions;             /* out: [vertices][3], finite numbers */
    int16_t *turns;               /* out, where there are turns: [vertices][3] of `turn_bits` bits */
} draco_source;

/* Extra attributes (draco_extra.h) stand beside no turns. False: one of the meshes is not that, and what was to be
 * filled may be half written. */
bool draco_read(draco_reader *reader, const draco_kind *kind, const draco_source sources[RANS_LANES]);

#endif
