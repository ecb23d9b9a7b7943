/* formats.h: between read.c and the formats it reads. A format turns a hostile header into a read_layout whose every
 * byte is known to lie inside the file; it allocates nothing and looks at no point. */
#ifndef GROOM_FORMATS_H
#define GROOM_FORMATS_H

#include "awt.h"

/* Where the points of a file lie. Pointers go into the caller's bytes, unaligned and little-endian. */
typedef struct read_layout {
    const char *format;            /* for error texts. Static storage */
    uint32_t strand_count;         /* 1 .. AWT_MAX_STRANDS */
    uint32_t points_per_strand;    /* of every strand, 1 .. AWT_MAX_POINTS_PER_STRAND; read only without `segments` */
    const unsigned char *segments; /* u16[strand_count], points of a strand less one; NULL: all strands alike */
    const unsigned char *points;   /* f32[3] each, strand after strand, root to tip */
    uint32_t point_stride;         /* bytes from one point to the next, at least 12 */
    float colour[3];               /* as in awt_strands */
} read_layout;

/* Does the file begin as this format does? Any size. */
bool read_is_tfx(const unsigned char *bytes, size_t size);
bool read_is_hair(const unsigned char *bytes, size_t size);

/* Checks the header against the file's size and the limits. AWT_TRUNCATED, AWT_BAD_VALUE, AWT_BAD_FORMAT, AWT_LIMIT,
 * AWT_NO_STRANDS; `out` is written on success only. */
awt_status read_tfx(const unsigned char *bytes, size_t size, read_layout *out, awt_error *error);
awt_status read_hair(const unsigned char *bytes, size_t size, read_layout *out, awt_error *error);

/* The limits that hold for every format: strands of a file, points of all its strands. AWT_LIMIT, AWT_NO_STRANDS. */
awt_status read_check_counts(const char *format, uint32_t strands, uint64_t points, awt_error *error);

#endif
