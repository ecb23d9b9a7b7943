/* glb_template.h: the JSON of a layout's frames, written once. A frame copies it and fills in what differs from frame
 * to frame: numbers in fields of fixed width, padded with spaces, which JSON allows between tokens. */
#ifndef GEOM_GLB_TEMPLATE_H
#define GEOM_GLB_TEMPLATE_H

#include "geom/glb_shim.h"

typedef struct glb_template {
    unsigned char *bytes; /* [size]: the file up to the binary chunk's first byte, fields empty; heap */
    size_t size;
    uint32_t patch_count;
    uint32_t *fields; /* where each field begins, 0: there is none; heap */
} glb_template;

/* Makes the template of frames that have `frame`'s counts, kind and widths; its pose, time, bounds and places do not
 * matter. AWT_NO_MEMORY, AWT_LIMIT, AWT_BAD_VALUE. */
awt_status glb_template_make(const glb_frame *frame, glb_template *out, awt_error *error);
void glb_template_fini(glb_template *t);

/* Replaces what `out` holds by a frame without patches; they are to be appended. AWT_NO_MEMORY, AWT_LIMIT. */
awt_status glb_template_begin(const glb_template *t, const awt_pose *head, int64_t time_us, geom_buffer *out,
                              awt_error *error);
/* Says where patch number `index` is in the binary chunk. */
void glb_template_place(const glb_template *t, uint32_t index, const glb_patch *patch, geom_buffer *out);
/* The same, and its bounds. */
void glb_template_patch(const glb_template *t, uint32_t index, const glb_patch *patch, geom_buffer *out);
/* Writes the lengths, when all patches are there. */
void glb_template_end(const glb_template *t, geom_buffer *out);

/* Whether a buffer holds a frame of this template. */
bool glb_template_made(const glb_template *t, const geom_buffer *frame);
/* Copies the bounds of patch number `index` from a frame of this template; *place becomes its place in that frame.
 * False: there is no such place. */
bool glb_template_keep(const glb_template *t, uint32_t index, const geom_buffer *from, geom_buffer *out,
                       glb_patch *place);

#endif
