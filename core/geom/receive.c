/* receive.c: see receive.h. */
#include "geom/receive.h"

#include "base/error.h"
#include "geom/draco_read.h"
#include "geom/guides.h"
#include "geom/lines.h"
#include "geom/topology.h"
#include "sim/evaluate.h"

#include <stdlib.h>
#include <string.h>

/* ---- guides */

/* Sections before a patch. */
static size_t patch_first(const glb_frame *frame, const glb_patch *patch)
{
    return (size_t)patch->first_strand * frame->points_per_strand;
}

/* Patches number `first` and the next few into their places; `turns` holds those of RANS_LANES patches. */
static bool read_some(const geom_binding *binding, const glb_frame *frame, uint32_t first, draco_reader *reader,
                      const draco_kind *kind, int16_t *const turns[RANS_LANES], geom_guides *out)
{
    draco_source sources[RANS_LANES] = {{0}};
    const uint32_t left = frame->patch_count - first, count = left < RANS_LANES ? left : RANS_LANES;
    for (uint32_t k = 0; k < count; k++) {
        const glb_patch *patch = &frame->patches[first + k];
        sources[k] = (draco_source){.bytes = frame->binary + patch->offset,
                                    .size = patch->size,
                                    .vertices = patch->vertices,
                                    .triangles = patch->triangles,
                                    .positions = out->centres + 3 * patch_first(frame, patch),
                                    .turns = turns[k]};
    }
    if (!draco_read(reader, kind, sources)) {
        return false;
    }
    for (uint32_t k = 0; k < count; k++) {
        const glb_patch *patch = &frame->patches[first + k];
        float *frames = out->frames + 4 * patch_first(frame, patch);
        guides_frames(binding, (guides_part){patch->first_strand, patch->strands}, turns[k], (quat *)(void *)frames);
    }
    return true;
}

static awt_status read_patches(const geom_binding *binding, const glb_frame *frame, geom_guides *out, awt_error *error)
{
    const uint32_t largest = lines_largest_patch(frame), sections = frame->points_per_strand;
    const size_t vertices = (size_t)largest * sections;
    uint16_t *indices = lines_indices(frame);
    int16_t *memory = calloc(RANS_LANES * vertices, 3 * sizeof *memory), *turns[RANS_LANES];
    draco_reader *reader = NULL;
    const draco_kind kind = {.indices = indices, .turn_bits = frame->attributes.turn_bits};
    awt_status status = indices && memory ? AWT_OK : error_set(error, AWT_NO_MEMORY, NULL);
    if (status == AWT_OK) {
        status =
            draco_reader_create((uint32_t)vertices, topology_triangles(frame->kind, largest, sections), &reader, error);
    }
    for (size_t k = 0; k < RANS_LANES && status == AWT_OK; k++) {
        turns[k] = memory + 3 * vertices * k;
    }
    for (uint32_t i = 0; i < frame->patch_count && status == AWT_OK; i += RANS_LANES) {
        if (!read_some(binding, frame, i, reader, &kind, turns, out)) {
            status = error_set(error, AWT_BAD_FORMAT, "a patch's Draco data is not what awtd's encoder writes");
        }
    }
    draco_reader_destroy(reader);
    free(memory);
    free(indices);
    return status;
}

static awt_status take_guides(const geom_binding *binding, const glb_frame *frame, geom_guides *out, awt_error *error)
{
    if (!binding || binding->id != frame->binding || binding->wisps != frame->strands ||
        binding->sections != frame->points_per_strand || binding->turn_bits != (uint32_t)frame->attributes.turn_bits) {
        return error_set(error, AWT_BAD_VALUE, "the frame's guides belong to another binding: %016llx",
                         (unsigned long long)frame->binding);
    }
    const size_t nodes = (size_t)binding->wisps * binding->sections;
    geom_guides guides = {.wisps = binding->wisps,
                          .sections = binding->sections,
                          .centres = calloc(nodes, sizeof(vec3)),
                          .frames = calloc(nodes, sizeof(quat)),
                          .patch_count = frame->patch_count,
                          .head = frame->head,
                          .time_us = frame->time_us};
    awt_status status = guides.centres && guides.frames ? AWT_OK : error_set(error, AWT_NO_MEMORY, NULL);
    if (status == AWT_OK) {
        status = read_patches(binding, frame, &guides, error);
    }
    if (status != AWT_OK) {
        geom_guides_fini(&guides);
        return status;
    }
    *out = guides;
    return AWT_OK;
}

void geom_guides_fini(geom_guides *guides)
{
    free(guides->centres);
    free(guides->frames);
    free(guides->numbers);
    *guides = (geom_guides){0};
}

awt_status geom_read_guides(const geom_binding *binding, const void *bytes, size_t size, geom_guides *out,
                            awt_error *error)
{
    glb_frame frame;
    awt_status status = glb_read(bytes, size, &frame, error);
    if (status == AWT_OK) {
        status = frame.kind == GEOM_GUIDES ? take_guides(binding, &frame, out, error)
                                           : error_set(error, AWT_BAD_FORMAT, "this frame holds no guides");
    }
    glb_frame_fini(&frame);
    return status;
}

/* ---- strands */

/* Memory for all strands of the binding, where `out` has none of that shape. */
static awt_status make_strands(const geom_binding *binding, geom_strands *out, awt_error *error)
{
    if (out->positions && out->widths && !out->vertices && out->strand_count == binding->strands &&
        out->points_per_strand == binding->points) {
        return AWT_OK;
    }
    const size_t points = (size_t)binding->strands * binding->points;
    geom_strands made = {.strand_count = binding->strands,
                         .points_per_strand = binding->points,
                         .positions = malloc(points * 3 * sizeof(float)),
                         .widths = malloc(binding->points * sizeof(float))};
    if (!made.positions || !made.widths) {
        geom_strands_fini(&made);
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    geom_strands_fini(out);
    *out = made;
    return AWT_OK;
}

awt_status geom_guides_strands(const geom_binding *binding, const geom_guides *guides, geom_strands *out,
                               awt_error *error)
{
    const evaluate_binding strands = {.wisps = binding->wisps,
                                      .sections = binding->sections,
                                      .points = binding->points,
                                      .strand_first = binding->strand_first,
                                      .offsets = binding->offsets};
    if (guides->wisps != binding->wisps || guides->sections != binding->sections) {
        return error_set(error, AWT_BAD_VALUE, "these guides belong to another binding");
    }
    float *scratch = malloc(evaluate_scratch(binding->sections, binding->points) * sizeof *scratch);
    awt_status status = scratch ? make_strands(binding, out, error) : error_set(error, AWT_NO_MEMORY, NULL);
    if (status == AWT_OK) {
        evaluate_hair(&strands, guides->centres, guides->frames, scratch, out->positions);
        memcpy(out->widths, binding->widths, binding->points * sizeof *out->widths);
        out->kind = GEOM_GUIDES;
        out->full_strand_count = binding->strands;
        out->patch_count = guides->patch_count;
        out->triangle_count = 0;
        out->head = guides->head;
        out->time_us = guides->time_us;
    }
    free(scratch);
    return status;
}

static awt_status evaluate(const geom_binding *binding, const glb_frame *frame, geom_strands *out, awt_error *error)
{
    geom_guides guides = {0};
    geom_strands made = {0};
    awt_status status = take_guides(binding, frame, &guides, error);
    if (status == AWT_OK) {
        status = geom_guides_strands(binding, &guides, &made, error);
    }
    if (status == AWT_OK) {
        *out = made;
    }
    geom_guides_fini(&guides);
    return status;
}

awt_status geom_receive_frame(const geom_binding *binding, const void *bytes, size_t size, geom_strands *out,
                              awt_error *error)
{
    glb_frame frame;
    awt_status status = glb_read(bytes, size, &frame, error);
    if (status == AWT_OK && frame.kind == GEOM_GUIDES && !binding) {
        status = error_set(error, AWT_BAD_VALUE, "a frame of guides makes strands with its binding only");
    } else if (status == AWT_OK) {
        status =
            frame.kind == GEOM_GUIDES ? evaluate(binding, &frame, out, error) : lines_read(&frame, NULL, out, error);
    }
    glb_frame_fini(&frame);
    return status;
}
