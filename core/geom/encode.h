/* encode.h: strand points to frames: patches, Draco, GLB. (read.h goes the other way.)
 *
 * The way of the data: strand points (head frame) -> vertices of one patch -> quantised, sequential Draco -> all
 * patches and the head's pose in one GLB with KHR_draco_mesh_compression. Encoding is a function of the points and the
 * caller's scratch, without hidden state. Sources: STREAM.md; glTF 2.0; the extension's text. */
#ifndef GEOM_ENCODE_H
#define GEOM_ENCODE_H

#include "awt.h"
#include "base/spread.h"
#include "geom/read.h" /* GEOM_MAX_GLB */

#ifdef __cplusplus
extern "C" {
#endif

enum {
    GEOM_MAX_PATCH_VERTICES = 65535, /* 16-bit indices; 65535 itself is the primitive restart value */
    GEOM_PATCH_POINTS = 16384,       /* strand points of one patch at most, of every kind */
    GEOM_RIBBON_BITS = 14,           /* quantisation: a ribbon is a few steps wide (STREAM.md, traps) */
    GEOM_STRANDS_BITS = 12,
    GEOM_LEAST_BITS = 8, /* what a layout may ask for */
    GEOM_GREATEST_BITS = 15
};

/* GLB bytes in a buffer that grows and is reused. Zeroed: empty. */
typedef struct geom_buffer {
    unsigned char *bytes; /* heap; geom_buffer_fini */
    size_t size, capacity;
} geom_buffer;

void geom_buffer_fini(geom_buffer *buffer);

/* What of a groom decides the shape of its frames of one kind: which strands make which patch, widths, triangles, all
 * that is the same in every frame. Immutable once made; any number of threads may encode from one. */
typedef struct geom_layout geom_layout;

typedef struct geom_layout_def {
    geom_kind kind;
    geom_level level; /* of ribbons and strands; of guides: full */
    int bits; /* quantisation of positions, GEOM_LEAST_BITS .. GEOM_GREATEST_BITS; 0: the kind's own. Guides: 0 */
    uint32_t attributes; /* of vertices, beside the position: geom_attribute; own encoder, ribbons and strands only */
    float colour[3];     /* the material's base colour, linear, each 0 .. 1; all 0: the groom's, or, where that has
                            none, brown. Of guides: not looked at */
    bool stock;          /* libdraco's encoder, the reference, instead of our own: the same positions, much slower */
} geom_layout_def;

/* Patches are whole wisp trees, in order, under GEOM_PATCH_POINTS. A tree that alone is too large is cut between
 * strands. `def` NULL: ribbons by our own encoder. AWT_NO_MEMORY, AWT_LIMIT, AWT_BAD_VALUE. */
awt_status geom_layout_create(const awt_groom *groom, const geom_layout_def *def, geom_layout **out, awt_error *error);
void geom_layout_destroy(geom_layout *layout);
uint32_t geom_layout_patches(const geom_layout *layout);

/* The strands, of guides the finest wisps, of patch number `index`: whoever knows which strands moved says so by patch.
 */
typedef struct geom_patch {
    uint32_t first_strand, strands;
} geom_patch;
geom_patch geom_layout_patch(const geom_layout *layout, uint32_t index);
/* The patches of which no top-level wisp has moved[wisp]: unchanged [geom_layout_patches], as geom_frame_def and
 * geom_quantise_def take it. */
void geom_layout_unchanged(const geom_layout *layout, const bool *moved, bool *unchanged);

/* Strands of the layout's level, of guides finest wisps: what a frame's points are of, and patches count. */
uint32_t geom_layout_strands(const geom_layout *layout);
/* Which strand of the groom number `index` of a level is: the same ones in every frame, rising. */
uint32_t geom_layout_strand(const geom_layout *layout, uint32_t index);
/* The strands of a layout of ribbons or strands alone, points [geom_layout_strands][points_per_strand][3]: those that
 * awt_groom_strands_of gives, to the bit, for a share of its work. `groom` is the layout's; the others as there,
 * `wisps` NULL: all. */
void geom_layout_evaluate(const geom_layout *layout, const awt_groom *groom, const bool *wisps, const float *centres,
                          const float *frames, float *scratch, float *points);

/* One encoder's working memory; one frame at a time. */
typedef struct geom_scratch geom_scratch;
awt_status geom_scratch_create(const geom_layout *layout, geom_scratch **out, awt_error *error);
/* Takes memory for so many threads that encode one frame together (geom_frame_def.helpers), as far as the layout has
 * patches for them: from 5 on for 2, from 9 on for 3. AWT_NO_MEMORY. */
awt_status geom_scratch_widen(geom_scratch *scratch, const geom_layout *layout, uint32_t hands, awt_error *error);
void geom_scratch_destroy(geom_scratch *scratch);
/* Bytes that it holds. */
size_t geom_scratch_bytes(const geom_scratch *scratch);

/* A frame of kind strands or guides as whole numbers: what deltas are made between. */
typedef struct geom_quantised geom_quantised;

/* What a frame is made of. */
typedef struct geom_frame_def {
    const float *points; /* [geom_layout_strands][points_per_strand][3], head frame; of guides section centres */
    const float *frames; /* of guides section frames [finest_nodes][4], both as awt_forest_guides gives them */
    const geom_quantised *quantised; /* kind strands, own encoder: these, instead of points; else NULL */
    awt_pose head;                   /* becomes the glTF node's translation and rotation */
    int64_t time_us;                 /* goes into asset.extras */

    /* Patches that need not be encoded again, because their points are to the bit those that `previous` was made of: a
     * frame of the same layout, by our own encoder. The frame comes out as if all had been encoded. NULL: none. */
    const bool *unchanged; /* [geom_layout_patches] */
    const geom_buffer *previous;

    const spread *helpers; /* who helps, own encoder: the bytes are the same whoever does; NULL: nobody */
    bool measure;          /* work out entropy_bits, which takes time */
} geom_frame_def;

typedef struct geom_frame_stats {
    uint32_t vertices, triangles;
    uint32_t clamped_points;  /* points outside the quantisation box, set onto it; of the patches encoded */
    uint32_t encoded_patches; /* the others were kept */
    double entropy_bits;      /* of the encoded positions: the least for a coder of single differences */
} geom_frame_stats;

/* Writes the binding that receivers of this groom's guides need (receive.h). *size is always set to the bytes needed;
 * with `bytes` NULL nothing else happens. AWT_LIMIT where `capacity` is less; AWT_NO_MEMORY. */
awt_status geom_binding_write(const awt_groom *groom, void *bytes, size_t capacity, size_t *size, awt_error *error);

/* Writes a frame. The scene's node is named "hair" and carries extras {"kind", "level",
 * "strands", "full_strands", "points_per_strand", "widths"} (full_strands: of the whole hair; widths: of a strand from
 * root to tip, metres), every patch is a primitive with extras {"first_strand", "strands"}; of guides proto/GEOMETRY.md
 * says what they are. `out` is replaced. AWT_BAD_VALUE (a point or the pose is not finite; `previous` is no frame of
 * this layout), AWT_NO_MEMORY, AWT_LIMIT. */
awt_status geom_encode(const geom_layout *layout, geom_scratch *scratch, const geom_frame_def *def, geom_buffer *out,
                       geom_frame_stats *stats, awt_error *error);

/* ---- deltas: what changed from one frame to another (proto/DELTAS.md) ---- */

/* Memory for the whole numbers of one frame of a layout of kind strands or guides; the layout outlives it.
 * AWT_NO_MEMORY, AWT_BAD_VALUE. */
awt_status geom_quantised_create(const geom_layout *layout, geom_quantised **out, awt_error *error);
void geom_quantised_destroy(geom_quantised *quantised);
/* Bytes that it holds. */
size_t geom_quantised_bytes(const geom_quantised *quantised);
/* CRC-32C of its numbers and their box. */
uint32_t geom_quantised_checksum(const geom_quantised *quantised);

typedef struct geom_quantise_def {
    const float *points; /* as of geom_frame_def */
    const float *frames; /* likewise */

    /* Patches whose points and frames are to the bit those that `previous` was made of. NULL: none. */
    const bool *unchanged; /* [geom_layout_patches] */
    const geom_quantised *previous;
} geom_quantise_def;

/* Fills `out`, which may be `previous`, and with which it shares the numbers of unchanged patches: both belong to one
 * thread from then on, and may be destroyed in any order. Adds to *clamped how many points of the other patches were
 * set onto the box, of guides how many sections no number reached. AWT_BAD_VALUE (a point or frame is not finite,
 * `previous` is none of this layout); `out` is then of no frame. */
awt_status geom_quantise(const geom_layout *layout, const geom_quantise_def *def, geom_quantised *out,
                         uint32_t *clamped, awt_error *error);

typedef struct geom_delta_def {
    const geom_quantised *base, *now; /* of guides `base` may be NULL: the frame comes whole */
    uint64_t base_sequence, sequence; /* the caller's names for them, which the receiver is told; of no base 0 */
    awt_pose head;
    int64_t time_us;
    bool measure; /* work out entropy_bits, which takes time */
} geom_delta_def;

/* Writes the frame `now` for who has `base`: a GLB with the extension AWT_delta, in which patches that are the same in
 * both are left out. `out` is replaced. Of `stats` vertices, encoded_patches and entropy_bits are those of the
 * patches that are in it. AWT_BAD_VALUE (numbers of another layout or of no frame; a base without a
 * sequence or the reverse; the pose is not finite),
 * AWT_NO_MEMORY, AWT_LIMIT. */
awt_status geom_encode_delta(const geom_layout *layout, geom_scratch *scratch, const geom_delta_def *def,
                             geom_buffer *out, geom_frame_stats *stats, awt_error *error);
/* Writes a frame of kind nodes, the AWT itself, from nodes as awt_forest_nodes gives them: lines, a node to its parent,
 * uncompressed (nodes.c). `out` is replaced. AWT_BAD_VALUE (no nodes; something is not finite),
 * AWT_LIMIT, AWT_NO_MEMORY. */
awt_status geom_encode_nodes(const awt_node *nodes, uint32_t count, const awt_pose *head, int64_t time_us,
                             geom_buffer *out, awt_error *error);

#ifdef __cplusplus
}
#endif

#endif
