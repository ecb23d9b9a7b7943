/* read.h: a GLB frame back to strand points, for clients and tests. The source need not be trusted. */
#ifndef GEOM_READ_H
#define GEOM_READ_H

#include "awt.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    GEOM_MAX_GLB = 64 * 1024 * 1024 /* bytes; nothing longer is written or read */
};

/* A frame read back: centre lines (mean of a ribbon's two edges), in the head frame. */
typedef struct geom_strands {
    uint32_t strand_count, points_per_strand;
    float *positions; /* [strand_count][points_per_strand][3] */
    float *vertices;  /* [strand_count][points_per_strand][2][3]: the ribbon's left and right edge */
    uint32_t patch_count, triangle_count;
    awt_pose head;
    int64_t time_us;
} geom_strands;

/* Reads a GLB that geom_encode_ribbons wrote, from a source that need not be trusted: everything is checked against
 * what is there before it is used. `out` is written on success only: geom_strands_fini.
 * AWT_BAD_FORMAT, AWT_TRUNCATED, AWT_BAD_VALUE, AWT_LIMIT, AWT_NO_MEMORY. */
awt_status geom_read_ribbons(const void *bytes, size_t size, geom_strands *out, awt_error *error);
void geom_strands_fini(geom_strands *strands);

#ifdef __cplusplus
}
#endif

#endif
