/* encode.c: strands to a frame: each patch to ribbons to Draco, then all patches into one GLB. */
#include "geom/encode.h"

#include "base/error.h"
#include "geom/buffer.h"
#include "geom/glb_shim.h"
#include "geom/layout.h"

#include <math.h>
#include <stdlib.h>

struct geom_scratch {
    float *vertices;    /* of the largest patch */
    glb_patch *patches; /* [patch_count] */
    geom_buffer binary; /* Draco data of all patches, each at a multiple of 4 */
};

awt_status geom_scratch_create(const geom_layout *layout, geom_scratch **out, awt_error *error)
{
    *out = NULL;
    geom_scratch *scratch = calloc(1, sizeof *scratch);
    if (!scratch) {
        goto fail;
    }
    size_t points = (size_t)layout->largest_patch * layout->points_per_strand;
    scratch->vertices = calloc(points, 6 * sizeof *scratch->vertices);
    scratch->patches = calloc(layout->patch_count, sizeof *scratch->patches);
    if (!scratch->vertices || !scratch->patches) {
        goto fail;
    }
    *out = scratch;
    return AWT_OK;
fail:
    geom_scratch_destroy(scratch);
    return error_set(error, AWT_NO_MEMORY, NULL);
}

void geom_scratch_destroy(geom_scratch *scratch)
{
    if (scratch) {
        free(scratch->vertices);
        free(scratch->patches);
        geom_buffer_fini(&scratch->binary);
        free(scratch);
    }
}

/* The bounds that a decoder will find: rounding to the quantisation grid keeps the order, so that the rounded bounds
 * are the bounds of the rounded positions, exactly. */
static void find_bounds(const draco_box *box, const float *vertices, glb_patch *patch)
{
    for (int k = 0; k < 3; k++) {
        float least = vertices[k], greatest = vertices[k];
        for (size_t i = 1; i < patch->vertices; i++) {
            float value = vertices[3 * i + (size_t)k];
            least = value < least ? value : least;
            greatest = value > greatest ? value : greatest;
        }
        patch->min[k] = draco_shim_round(box, k, least);
        patch->max[k] = draco_shim_round(box, k, greatest);
    }
}

static awt_status pad_binary(geom_buffer *binary, awt_error *error)
{
    static const unsigned char zeros[4];
    return geom_buffer_append(binary, zeros, (4 - binary->size % 4) % 4, error);
}

static awt_status encode_patch(const geom_layout *layout, geom_scratch *scratch, const float *points,
                               const geom_patch *place, glb_patch *patch, geom_frame_stats *stats, awt_error *error)
{
    const uint32_t per_strand = layout->points_per_strand;
    *patch = (glb_patch){.first_strand = place->first_strand,
                         .strands = place->strands,
                         .vertices = place->strands * per_strand * 2,
                         .triangles = ribbon_index_count(place->strands, per_strand) / 3,
                         .offset = scratch->binary.size};
    if (!ribbon_vertices(&layout->shape, points + (size_t)place->first_strand * per_strand * 3, place->strands,
                         scratch->vertices, &stats->clamped_points)) {
        return error_set(error, AWT_BAD_VALUE, "a strand point among strands %u to %u is not a finite number",
                         place->first_strand, place->first_strand + place->strands - 1);
    }
    find_bounds(&layout->box, scratch->vertices, patch);
    awt_status status = draco_shim_encode(&layout->box, scratch->vertices, patch->vertices, layout->indices,
                                          patch->triangles, &scratch->binary, error);
    if (status != AWT_OK) {
        return status;
    }
    patch->size = scratch->binary.size - patch->offset;
    stats->vertices += patch->vertices;
    stats->triangles += patch->triangles;
    return pad_binary(&scratch->binary, error);
}

/* glTF wants a rotation of length 1 to the last bits. */
static awt_status take_head(const awt_pose *head, awt_pose *out, awt_error *error)
{
    double square = 0;
    for (int k = 0; k < 4; k++) {
        square += head->orientation[k] * head->orientation[k];
    }
    double length = sqrt(square);
    if (!isfinite(head->position[0]) || !isfinite(head->position[1]) || !isfinite(head->position[2]) ||
        !(fabs(length - 1.0) <= 1e-3)) {
        return error_set(error, AWT_BAD_VALUE, "the head's pose is not finite, or its orientation is not of length 1");
    }
    *out = *head;
    for (int k = 0; k < 4; k++) {
        out->orientation[k] = head->orientation[k] / length;
    }
    return AWT_OK;
}

awt_status geom_encode_ribbons(const geom_layout *layout, geom_scratch *scratch, const float *points,
                               const awt_pose *head, int64_t time_us, geom_buffer *out, geom_frame_stats *stats,
                               awt_error *error)
{
    geom_frame_stats counted = {0};
    glb_frame frame = {.strands = layout->strands,
                       .points_per_strand = layout->points_per_strand,
                       .patches = scratch->patches,
                       .patch_count = layout->patch_count,
                       .time_us = time_us};
    awt_status status = take_head(head, &frame.head, error);
    scratch->binary.size = 0;
    for (uint32_t i = 0; i < layout->patch_count && status == AWT_OK; i++) {
        status = encode_patch(layout, scratch, points, &layout->patches[i], &scratch->patches[i], &counted, error);
    }
    if (status != AWT_OK) {
        return status;
    }
    frame.binary = scratch->binary.bytes;
    frame.binary_size = scratch->binary.size;
    out->size = 0;
    status = glb_shim_write(&frame, out, error);
    if (status == AWT_OK && stats) {
        *stats = counted;
    }
    return status;
}
