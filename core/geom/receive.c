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

/* One patch of guides into its place; `numbers` holds six of every section of the largest. */
static bool read_patch(const geom_binding *binding, const glb_frame *frame, const glb_patch *patch,
                       draco_reader *reader, const uint16_t *indices, int16_t *numbers, geom_guides *out)
{
    const size_t first = (size_t)patch->first_strand * frame->points_per_strand;
    const guides_part part = {patch->first_strand, patch->strands};
    int16_t *turns = numbers, *offsets = numbers + 3 * (size_t)patch->vertices;
    float *centres = out->centres + 3 * first, *frames = out->frames + 4 * first;
    if (!draco_read_numbers(reader, &frame->attributes, frame->binary + patch->offset, patch->size, indices,
                            patch->vertices, patch->triangles, centres, offsets, turns)) {
        return false;
    }
    if (frame->attributes.form == DRACO_OFFSETS_TURNS) {
        guides_unbind(binding, part, offsets, turns, (vec3 *)(void *)centres);
    }
    guides_frames(binding, part, turns, (quat *)(void *)frames);
    return true;
}

static awt_status read_patches(const geom_binding *binding, const glb_frame *frame, geom_guides *out, awt_error *error)
{
    const uint32_t largest = lines_largest_patch(frame), sections = frame->points_per_strand;
    const size_t vertices = (size_t)largest * sections;
    uint16_t *indices = lines_indices(frame);
    int16_t *numbers = calloc(vertices, 6 * sizeof *numbers);
    draco_reader *reader = NULL;
    awt_status status = indices && numbers ? AWT_OK : error_set(error, AWT_NO_MEMORY, NULL);
    if (status == AWT_OK) {
        status =
            draco_reader_create((uint32_t)vertices, topology_triangles(frame->kind, largest, sections), &reader, error);
    }
    for (uint32_t i = 0; i < frame->patch_count && status == AWT_OK; i++) {
        if (!read_patch(binding, frame, &frame->patches[i], reader, indices, numbers, out)) {
            status = error_set(error, AWT_BAD_FORMAT, "a patch's Draco data is not what awtd's encoder writes");
        }
    }
    draco_reader_destroy(reader);
    free(numbers);
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

static awt_status evaluate(const geom_binding *binding, const glb_frame *frame, geom_strands *out, awt_error *error)
{
    const evaluate_binding strands = {.wisps = binding->wisps,
                                      .sections = binding->sections,
                                      .points = binding->points,
                                      .strand_first = binding->strand_first,
                                      .offsets = binding->offsets};
    const size_t points = (size_t)binding->strands * binding->points;
    geom_guides guides;
    awt_status status = take_guides(binding, frame, &guides, error);
    if (status != AWT_OK) {
        return status;
    }
    float *scratch = malloc(evaluate_scratch(binding->sections, binding->points) * sizeof *scratch);
    geom_strands made = {.kind = GEOM_GUIDES,
                         .strand_count = binding->strands,
                         .full_strand_count = binding->strands,
                         .points_per_strand = binding->points,
                         .positions = malloc(points * 3 * sizeof(float)),
                         .widths = malloc(binding->points * sizeof(float)),
                         .patch_count = frame->patch_count,
                         .head = frame->head,
                         .time_us = frame->time_us};
    if (scratch && made.positions && made.widths) {
        memcpy(made.widths, binding->widths, binding->points * sizeof *made.widths);
        evaluate_hair(&strands, guides.centres, guides.frames, scratch, made.positions);
        *out = made;
    } else {
        geom_strands_fini(&made);
        status = error_set(error, AWT_NO_MEMORY, NULL);
    }
    free(scratch);
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
