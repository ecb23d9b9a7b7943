/* read.c: a frame back to strands: container and JSON (glb.h), then each patch's Draco data (draco_shim.h). */
#include "geom/read.h"

#include "base/error.h"
#include "geom/draco_shim.h"
#include "geom/glb.h"
#include "geom/ribbon.h"

#include <stdlib.h>

static uint32_t largest_patch(const glb_frame *frame)
{
    uint32_t largest = 0;
    for (uint32_t i = 0; i < frame->patch_count; i++) {
        largest = frame->patches[i].strands > largest ? frame->patches[i].strands : largest;
    }
    return largest;
}

static awt_status read_vertices(const glb_frame *frame, float *vertices, awt_error *error)
{
    const uint32_t per_strand = frame->points_per_strand;
    const uint32_t largest = largest_patch(frame);
    uint16_t *indices = calloc(ribbon_index_count(largest, per_strand), sizeof *indices);
    if (!indices) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    ribbon_indices(largest, per_strand, indices);
    awt_status status = AWT_OK;
    for (uint32_t i = 0; i < frame->patch_count && status == AWT_OK; i++) {
        const glb_patch *patch = &frame->patches[i];
        status = draco_shim_decode(frame->binary + patch->offset, patch->size, indices, patch->vertices,
                                   patch->triangles, vertices + (size_t)patch->first_strand * per_strand * 6, error);
    }
    free(indices);
    return status;
}

/* Centre lines: the mean of the two edges. */
static void fill_positions(const float *vertices, size_t points, float *positions)
{
    for (size_t i = 0; i < points; i++) {
        for (size_t k = 0; k < 3; k++) {
            positions[3 * i + k] = 0.5f * vertices[6 * i + k] + 0.5f * vertices[6 * i + 3 + k];
        }
    }
}

awt_status geom_read_ribbons(const void *bytes, size_t size, geom_strands *out, awt_error *error)
{
    glb_frame frame;
    geom_strands strands = {0};
    awt_status status = glb_read(bytes, size, &frame, error);
    if (status != AWT_OK) {
        return status;
    }
    const size_t points = (size_t)frame.strands * frame.points_per_strand;
    strands = (geom_strands){.strand_count = frame.strands,
                             .points_per_strand = frame.points_per_strand,
                             .positions = calloc(points, 3 * sizeof(float)),
                             .vertices = calloc(points, 6 * sizeof(float)),
                             .patch_count = frame.patch_count,
                             .head = frame.head,
                             .time_us = frame.time_us};
    if (!strands.positions || !strands.vertices) {
        status = error_set(error, AWT_NO_MEMORY, NULL);
        goto fail;
    }
    status = read_vertices(&frame, strands.vertices, error);
    if (status != AWT_OK) {
        goto fail;
    }
    fill_positions(strands.vertices, points, strands.positions);
    for (uint32_t i = 0; i < frame.patch_count; i++) {
        strands.triangle_count += frame.patches[i].triangles;
    }
    *out = strands;
    glb_frame_fini(&frame);
    return AWT_OK;
fail:
    geom_strands_fini(&strands);
    glb_frame_fini(&frame);
    return status;
}

void geom_strands_fini(geom_strands *strands)
{
    free(strands->positions);
    free(strands->vertices);
    *strands = (geom_strands){0};
}
