/* lines.h: frames of ribbons and strands, whichever decoder reads what our own does not (for core/geom alone). */
#ifndef GEOM_LINES_H
#define GEOM_LINES_H

#include "geom/glb.h"
#include "geom/read.h"

/* A decoder for meshes that our own writer did not write, as draco_shim_decode. */
typedef awt_status lines_decode(const void *bytes, size_t size, const uint16_t *indices, uint32_t vertices,
                                uint32_t triangles, float *positions, awt_error *error);

/* The triangles of the frame's largest patch, heap; smaller ones have the front of them. NULL: no memory. */
uint16_t *lines_indices(const glb_frame *frame);
/* Strands of the largest patch. */
uint32_t lines_largest_patch(const glb_frame *frame);

/* Takes a frame of kind ribbon or strands; its widths become those of `out`. Without `other` what our own decoder does
 * not read is refused. Errors as geom_read_frame. */
awt_status lines_read(glb_frame *frame, lines_decode *other, geom_strands *out, awt_error *error);

#endif
