/* glb_shim.h: a frame's patches and pose into a GLB, through tinygltf. C types; no exception gets out.
 * (glb.h reads one back without tinygltf, whose loader does not check a stranger's file.) */
#ifndef GEOM_GLB_SHIM_H
#define GEOM_GLB_SHIM_H

#include "geom/draco_format.h"
#include "geom/encode.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One primitive of the mesh. */
typedef struct glb_patch {
    uint32_t first_strand, strands;
    uint32_t vertices, triangles;
    float min[3], max[3]; /* of the positions as a decoder gives them back */
    uint32_t extra;       /* as the frame's */
    size_t offset, size;  /* its Draco data in the binary chunk */
} glb_patch;

/* What frames of a kind call their lines, the points of a line, and a patch's first line. */
typedef struct glb_words {
    const char *kind, *lines, *points, *first;
} glb_words;

static inline glb_words glb_words_of(geom_kind kind)
{
    glb_words words = {"ribbon", "strands", "points_per_strand", "first_strand"};
    if (kind == GEOM_STRANDS) {
        words.kind = "strands";
    }
    if (kind == GEOM_GUIDES) {
        words.kind = "guides", words.lines = "wisps", words.points = "sections", words.first = "first_wisp";
    }
    return words;
}

/* What frames call a level. */
static inline const char *glb_level_name(geom_level level)
{
    return level == GEOM_LEVEL_FULL ? "full" : level == GEOM_LEVEL_FIFTH ? "fifth" : "guides";
}

/* What a GLB of ours says. */
typedef struct glb_frame {
    geom_kind kind;
    geom_level level;                    /* of ribbons and strands */
    uint32_t strands, points_per_strand; /* of guides: wisps, and sections of each */
    uint32_t full_strands;               /* of ribbons and strands: of the hair at level full */
    draco_attributes attributes;         /* of its meshes */
    uint64_t binding;                    /* guides: which one (binding.h) */
    glb_patch *patches;                  /* [patch_count] */
    uint32_t patch_count;
    const unsigned char *binary; /* [binary_size], the binary chunk */
    size_t binary_size;
    uint32_t extra;  /* attributes (geom_attribute) of its vertices */
    float colour[3]; /* of the material, linear; written only */
    float *widths;   /* [points_per_strand] from root to tip, metres; NULL: not said */
    awt_pose head;   /* orientation of length 1 */
    int64_t time_us;
} glb_frame;

/* Appends the frame as a GLB. AWT_NO_MEMORY, AWT_LIMIT. */
awt_status glb_shim_write(const glb_frame *frame, geom_buffer *out, awt_error *error);

/* Writes the shortest text that reads as `value` again, exactly, into `text` [size]; returns its length. 24 characters
 * hold any finite number. */
size_t glb_shim_print(double value, char *text, size_t size);

#ifdef __cplusplus
}
#endif

#endif
