/* awtwrite.h: shown hair into the memory of an engine, in its format, unit and axes. Standard C only. Nothing outside
 * of what is given is written, and nothing between its elements. */
#ifndef AWTWRITE_H
#define AWTWRITE_H

#include "awtframes.h"
#include "awtspace.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum awtwrite_format {
    AWTWRITE_F32,    /* three floats a point */
    AWTWRITE_F16,    /* three IEEE halves: about 0.1 mm within 0.25 m */
    AWTWRITE_UNORM16 /* three u16: 0 .. 65535 from the box's origin to its other end; points outside are clamped */
} awtwrite_format;

/* Where points go. */
typedef struct awtwrite_target {
    void *memory;
    size_t size;   /* bytes of it */
    size_t stride; /* bytes from one point to the next, >= what the format takes; 0: just that */
    awtwrite_format format;
    awtspace space;
    float box_origin[3], box_size[3]; /* of AWTWRITE_UNORM16, in the engine's unit and axes; sizes > 0 */
} awtwrite_target;

/* Bytes of one point in a format. */
size_t awtwrite_point_size(awtwrite_format format);

/* Writes [points][3] in our frame (awtframes_shown's positions or previous). False: it does not fit, or the target
 * makes no sense; nothing was written. */
bool awtwrite_points(const awtwrite_target *target, const float *points, size_t count);

/* Where each strand begins, counted in points: [strand_count + 1], of which `capacity` fit. False: too few. */
bool awtwrite_offsets(const awtframes_shown *shown, uint32_t *offsets, size_t capacity);
/* Each point's width in the engine's unit: [strand_count * points_per_strand], of which `capacity` fit. */
bool awtwrite_widths(const awtframes_shown *shown, awtspace space, float *widths, size_t capacity);
/* Bounds of the positions in the engine's unit and axes. */
void awtwrite_bounds(const awtframes_shown *shown, awtspace space, float least[3], float greatest[3]);

#ifdef __cplusplus
}
#endif

#endif
