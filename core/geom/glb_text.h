/* glb_text.h: the JSON of frames that have little of it and always the same, put together without a library and without
 * memory of its own (delta_glb.c, nodes.c), and the container around it. Frames with patches have a template instead
 * (glb_template.h). */
#ifndef GEOM_GLB_TEXT_H
#define GEOM_GLB_TEXT_H

#include "geom/encode.h"

enum { GLB_TEXT_ROOM = 2048 };

typedef struct glb_text {
    char bytes[GLB_TEXT_ROOM]; /* [size] */
    size_t size;
} glb_text;

/* Each appends; that it fits is the caller's business, who knows what it writes, and is asserted. */
void glb_text_put(glb_text *t, const char *words);
void glb_text_format(glb_text *t, const char *format, ...);
/* With commas between; the shortest digits that read as the same numbers again. */
void glb_text_reals(glb_text *t, const double *values, int count);

/* Begins the object of the whole file: asset with its time, one scene of one node. The node follows. */
void glb_text_scene(glb_text *t, int64_t time_us);
/* The head's pose as members of a node: translation and rotation. */
void glb_text_pose(glb_text *t, const awt_pose *head);

/* Replaces what `out` holds by the file up to its binary chunk's first byte; spaces, which JSON allows, fill the text
 * up to a multiple of 4 `behind` bytes before its end. AWT_NO_MEMORY, AWT_LIMIT. */
awt_status glb_text_begin(glb_text *t, size_t behind, geom_buffer *out, awt_error *error);
/* Writes the container's lengths when the binary chunk, which begins at `binary`, is there: a multiple of 4 bytes. */
void glb_text_end(size_t binary, geom_buffer *out);

#endif
