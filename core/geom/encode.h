/* encode.h: strand points to frames: ribbons in patches, Draco, GLB. (read.h goes the other way.)
 *
 * The way of the data: strand points (head frame) -> ribbon vertices of one patch -> quantised, sequential Draco
 * -> all patches and the head's pose in one GLB with KHR_draco_mesh_compression. Encoding is a function of
 * the points and the caller's scratch, without hidden state. Sources: STREAM.md; glTF 2.0; the extension's text. */
#ifndef GEOM_ENCODE_H
#define GEOM_ENCODE_H

#include "awt.h"
#include "geom/read.h" /* GEOM_MAX_GLB */

#ifdef __cplusplus
extern "C" {
#endif

enum {
    GEOM_MAX_PATCH_VERTICES = 65535, /* 16-bit indices; 65535 itself is the primitive restart value */
    GEOM_RIBBON_BITS = 14            /* quantisation of ribbon positions */
};

/* GLB bytes in a buffer that grows and is reused. Zeroed: empty. */
typedef struct geom_buffer {
    unsigned char *bytes; /* heap; geom_buffer_fini */
    size_t size, capacity;
} geom_buffer;

void geom_buffer_fini(geom_buffer *buffer);

/* What of a groom decides the shape of its frames: which strands make which patch, ribbon widths, indices.
 * Immutable once made; any number of threads may encode from one. */
typedef struct geom_layout geom_layout;

/* Patches are whole wisp trees, in order, under GEOM_MAX_PATCH_VERTICES. A tree that alone is too large is cut
 * between strands. AWT_NO_MEMORY, AWT_LIMIT. The groom must outlive the layout. */
awt_status geom_layout_create(const awt_groom *groom, geom_layout **out, awt_error *error);
void geom_layout_destroy(geom_layout *layout);
uint32_t geom_layout_patches(const geom_layout *layout);

/* One encoder's working memory; one thread at a time. */
typedef struct geom_scratch geom_scratch;
awt_status geom_scratch_create(const geom_layout *layout, geom_scratch **out, awt_error *error);
void geom_scratch_destroy(geom_scratch *scratch);

typedef struct geom_frame_stats {
    uint32_t vertices, triangles;
    uint32_t clamped_points; /* strand points outside the quantisation box, set onto it */
} geom_frame_stats;

/* Writes a `ribbon` frame: strand points [strands][points_per_strand][3], head frame; `head` becomes the glTF
 * node's translation and rotation; `time_us` goes into asset.extras. The scene's node is named "hair" and carries
 * extras {"strands", "points_per_strand"}; every patch is a primitive with extras {"first_strand", "strands"}.
 * `out` is replaced. AWT_BAD_VALUE (a point is not finite), AWT_NO_MEMORY, AWT_LIMIT. */
awt_status geom_encode_ribbons(const geom_layout *layout, geom_scratch *scratch, const float *points,
                               const awt_pose *head, int64_t time_us, geom_buffer *out, geom_frame_stats *stats,
                               awt_error *error);

#ifdef __cplusplus
}
#endif

#endif
