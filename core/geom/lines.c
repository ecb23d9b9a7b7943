/* lines.c: see lines.h. */
#include "geom/lines.h"

#include "base/error.h"
#include "geom/draco_read.h"
#include "geom/topology.h"

#include <stdlib.h>

uint32_t lines_largest_patch(const glb_frame *frame)
{
    uint32_t largest = 0;
    for (uint32_t i = 0; i < frame->patch_count; i++) {
        largest = frame->patches[i].strands > largest ? frame->patches[i].strands : largest;
    }
    return largest;
}

/* What reading a frame's patches needs. */
typedef struct lines_job {
    const glb_frame *frame;
    draco_reader *reader;
    draco_kind kind;
    lines_decode *other;
    float *vertices; /* of all patches, each at its strands' place */
} lines_job;

static draco_source source_of(const lines_job *job, uint32_t patch_number)
{
    const glb_frame *frame = job->frame;
    const glb_patch *patch = &frame->patches[patch_number];
    const size_t a_strand = (size_t)frame->points_per_strand * topology_vertices_a_point(frame->kind) * 3;
    return (draco_source){.bytes = frame->binary + patch->offset,
                          .size = patch->size,
                          .vertices = patch->vertices,
                          .triangles = patch->triangles,
                          .positions = job->vertices + patch->first_strand * a_strand};
}

/* Patches first .. end - 1, of which our reader does not know one at least: each by whoever reads it. */
static awt_status read_one_by_one(const lines_job *job, uint32_t first, uint32_t end, awt_error *error)
{
    awt_status status = AWT_OK;
    for (uint32_t i = first; i < end && status == AWT_OK; i++) {
        const draco_source sources[RANS_LANES] = {source_of(job, i)}, *s = &sources[0];
        if (!draco_read(job->reader, &job->kind, sources)) {
            status =
                job->other
                    ? job->other(s->bytes, s->size, job->kind.indices, s->vertices, s->triangles, s->positions, error)
                    : error_set(error, AWT_BAD_FORMAT, "a patch's Draco data is not what awtd's encoder writes");
        }
    }
    return status;
}

static awt_status read_patches(const lines_job *job, awt_error *error)
{
    const uint32_t count = job->frame->patch_count;
    awt_status status = AWT_OK;
    for (uint32_t i = 0; i < count && status == AWT_OK; i += RANS_LANES) {
        const uint32_t end = count - i < RANS_LANES ? count : i + RANS_LANES;
        draco_source sources[RANS_LANES] = {{0}};
        for (uint32_t k = i; k < end; k++) {
            sources[k - i] = source_of(job, k);
        }
        if (!draco_read(job->reader, &job->kind, sources)) {
            status = read_one_by_one(job, i, end, error);
        }
    }
    return status;
}

uint16_t *lines_indices(const glb_frame *frame)
{
    const uint32_t per_strand = frame->points_per_strand, largest = lines_largest_patch(frame);
    uint16_t *indices = calloc(topology_triangles(frame->kind, largest, per_strand), 3 * sizeof *indices);
    if (indices) {
        topology_indices(frame->kind, largest, per_strand, indices);
    }
    return indices;
}

static awt_status read_vertices(const glb_frame *frame, lines_decode *other, float *vertices, awt_error *error)
{
    const uint32_t per_strand = frame->points_per_strand, largest = lines_largest_patch(frame);
    draco_reader *reader = NULL;
    uint16_t *indices = lines_indices(frame);
    awt_status status = indices ? AWT_OK : error_set(error, AWT_NO_MEMORY, NULL);
    if (status == AWT_OK) {
        status = draco_reader_create(largest * per_strand * topology_vertices_a_point(frame->kind),
                                     topology_triangles(frame->kind, largest, per_strand), &reader, error);
    }
    if (status == AWT_OK) {
        const lines_job job = {frame, reader, {.indices = indices, .extra = frame->extra}, other, vertices};
        status = read_patches(&job, error);
    }
    draco_reader_destroy(reader);
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

awt_status lines_read(glb_frame *frame, lines_decode *other, geom_strands *out, awt_error *error)
{
    const size_t points = (size_t)frame->strands * frame->points_per_strand;
    const bool ribbon = frame->kind == GEOM_RIBBON;
    geom_strands strands = {.kind = frame->kind,
                            .level = frame->level,
                            .strand_count = frame->strands,
                            .points_per_strand = frame->points_per_strand,
                            .full_strand_count = frame->full_strands,
                            .positions = calloc(points, 3 * sizeof(float)),
                            .vertices = ribbon ? calloc(points, 6 * sizeof(float)) : NULL,
                            .patch_count = frame->patch_count,
                            .attributes = frame->extra,
                            .head = frame->head,
                            .time_us = frame->time_us};
    awt_status status = strands.positions && (strands.vertices || !ribbon) ? AWT_OK : AWT_NO_MEMORY;
    status = status == AWT_OK ? read_vertices(frame, other, ribbon ? strands.vertices : strands.positions, error)
                              : error_set(error, status, NULL);
    if (status != AWT_OK) {
        geom_strands_fini(&strands);
        return status;
    }
    if (ribbon) {
        fill_positions(strands.vertices, points, strands.positions);
    }
    for (uint32_t i = 0; i < frame->patch_count; i++) {
        strands.triangle_count += frame->patches[i].triangles;
    }
    strands.widths = frame->widths; /* the caller's now */
    frame->widths = NULL;
    *out = strands;
    return AWT_OK;
}

void geom_strands_fini(geom_strands *strands)
{
    free(strands->positions);
    free(strands->vertices);
    free(strands->widths);
    *strands = (geom_strands){0};
}
