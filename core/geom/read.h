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

/* What a frame holds, numbered as in QUERY. */
typedef enum geom_kind {
    GEOM_RIBBON = 0,  /* a ribbon of triangles along each strand: for any viewer */
    GEOM_STRANDS = 1, /* the strands' points, under triangles that only make them a mesh: for engines */
    GEOM_GUIDES = 2,  /* cross-sections of the finest wisps: for who has the binding (receive.h) */
    GEOM_NODES = 3    /* active AWT nodes: for overlays; without a layout (geom_encode_nodes) */
} geom_kind;

/* How many of the hair's strands a frame of ribbons or strands has, numbered as in QUERY. Fewer are wider: the volume
 * of the hair is the same. */
typedef enum geom_level {
    GEOM_LEVEL_FULL = 0,  /* all */
    GEOM_LEVEL_FIFTH = 1, /* every fifth */
    GEOM_LEVEL_GUIDES = 2 /* one a finest wisp */
} geom_level;

/* What vertices of ribbons and strands have beside their position where it is asked for: bits. None changes from frame
 * to frame. */
typedef enum geom_attribute {
    GEOM_ATTRIBUTE_STRAND = 1,  /* _STRAND: the strand's number within its patch */
    GEOM_ATTRIBUTE_ROOT_UV = 2, /* TEXCOORD_0: the root's place on the scalp */
    GEOM_ATTRIBUTE_WIDTH = 4,   /* _WIDTH: of the strand at this point, metres */
    GEOM_ATTRIBUTES_ALL = 7
} geom_attribute;

/* A frame read back, in the head frame. */
typedef struct geom_strands {
    geom_kind kind;
    geom_level level; /* of guides: full */
    uint32_t strand_count, points_per_strand;
    uint32_t full_strand_count; /* of the hair at level full */
    float *positions; /* [strand_count][points_per_strand][3]: the points; of ribbons the mean of the two edges */
    float *vertices;  /* of ribbons [strand_count][points_per_strand][2][3]: left and right edge; else NULL */
    float *widths;    /* [points_per_strand]: of every strand from root to tip, metres */
    uint32_t patch_count, triangle_count;
    uint32_t attributes; /* which the frame has (geom_attribute); they are not read */
    awt_pose head;
    int64_t time_us;
} geom_strands;

/* Reads a GLB that geom_encode wrote, of kind ribbon or strands and by either encoder, from a source that need not be
 * trusted: everything is checked against what is there before it is used. `out` is written on success only:
 * geom_strands_fini. AWT_BAD_FORMAT, AWT_TRUNCATED, AWT_BAD_VALUE, AWT_LIMIT, AWT_NO_MEMORY. */
awt_status geom_read_frame(const void *bytes, size_t size, geom_strands *out, awt_error *error);
void geom_strands_fini(geom_strands *strands);

/* The memory of one reader of deltas; one thread at a time. */
typedef struct geom_delta_reader geom_delta_reader;
awt_status geom_delta_reader_create(geom_delta_reader **out, awt_error *error);
void geom_delta_reader_destroy(geom_delta_reader *reader);

/* Reads a GLB that geom_encode_delta wrote, from a source that need not be trusted, for who has its base: a frame of
 * kind strands, by geom_read_frame or by this, with the number that its sender named it by. `out`, which is not `base`,
 * holds nothing or an earlier frame, whose memory is used again; it is written on success only, with the very positions
 * that the frame would have brought whole: geom_strands_fini. AWT_BAD_VALUE (it is for another base), AWT_BAD_FORMAT,
 * AWT_TRUNCATED, AWT_LIMIT, AWT_NO_MEMORY. */
awt_status geom_read_delta(geom_delta_reader *reader, const void *bytes, size_t size, const geom_strands *base,
                           uint64_t base_sequence, geom_strands *out, awt_error *error);

#ifdef __cplusplus
}
#endif

#endif
