/* binding_make.c: the binding of a groom, and how finely its guides are quantised.
 *
 * A receiver's strands are to lie within 0.2 mm of the server's. A position is off by 0.87 of its step at most, and a
 * turn moves a strand point by as much as its offset is long times 0.87 of the turn's step. Both at their worst and in
 * the same direction would be 0.23 mm with the limits below; over the clips of the four styles the worst point was
 * 0.167 mm off, the mean 0.034 to 0.066 (proto/GEOMETRY.md). */
#include "geom/binding.h"

#include "base/error.h"
#include "geom/encode.h"
#include "geom/guides.h"
#include "geom/measure.h"
#include "groom/groom.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define POSITION_STEP_M 0.12e-3f /* at most, where BINDING_MOST_BITS allow it */
#define TURN_ERROR_M 0.08e-3f    /* of half a step about one axis, at the end of the longest offset */

static uint32_t choose_position_bits(const awt_groom_info *info)
{
    int bits = BINDING_LEAST_BITS;
    while (bits < BINDING_MOST_BITS) {
        const draco_box box = measure_box(info, 0, bits);
        if (draco_box_step(&box) <= POSITION_STEP_M) {
            break;
        }
        bits++;
    }
    return (uint32_t)bits;
}

static uint32_t choose_turn_bits(float longest_m)
{
    uint32_t bits = BINDING_LEAST_BITS;
    while (bits < BINDING_MOST_BITS && longest_m * 0.5f * guides_turn_step(bits) > TURN_ERROR_M) {
        bits++;
    }
    return bits;
}

/* The longest offset, and the largest coordinate of any. */
static void measure_offsets(const awt_groom *groom, float *longest, float *largest)
{
    const size_t points = groom->info.points_per_strand;
    *longest = *largest = 0;
    for (size_t s = 0; s < groom->info.strand_count; s++) {
        const float *o = groom->strand_offset + 3 * points * s;
        for (size_t i = 0; i < points; i++) {
            const vec3 offset = {o[i], o[points + i], o[2 * points + i]};
            *longest = fmaxf(*longest, vec3_length(offset));
            *largest = fmaxf(*largest, fmaxf(fabsf(offset.x), fmaxf(fabsf(offset.y), fabsf(offset.z))));
        }
    }
}

static void fill_offsets(const awt_groom *groom, geom_binding *b)
{
    const size_t count = 3 * (size_t)b->strands * b->points;
    const float per_metre = b->offset_step_m > 0 ? 1.0f / b->offset_step_m : 0;
    for (size_t i = 0; i < count; i++) {
        float steps = floorf(groom->strand_offset[i] * per_metre + 0.5f);
        b->packed[i] = (int16_t)fmaxf(fminf(steps, 32767), -32767);
    }
}

static void fill(const awt_groom *groom, geom_binding *b)
{
    const uint32_t first = groom_finest_first(groom);
    const size_t nodes = (size_t)b->wisps * b->sections;
    measure_half_widths(&groom->info, 1, 0, b->widths);
    for (uint32_t i = 0; i < b->points; i++) {
        b->widths[i] *= 2;
    }
    memcpy(b->strand_first, groom->gc_strand_first, ((size_t)b->wisps + 1) * sizeof *b->strand_first);
    memcpy(b->tree, groom->gc_tree + first, b->wisps * sizeof *b->tree);
    memcpy(b->rest_centre, groom->rest_position + (size_t)first * b->sections, nodes * sizeof *b->rest_centre);
    memcpy(b->rest_frame, groom->rest_frame, nodes * sizeof *b->rest_frame);
    fill_offsets(groom, b);
}

/* The id is a hash of the file. */
static bool find_id(geom_binding *b)
{
    const size_t size = binding_walk_out(b, NULL, 0);
    unsigned char *bytes = malloc(size);
    if (bytes) {
        binding_walk_out(b, bytes, size);
    }
    free(bytes);
    return bytes != NULL;
}

awt_status binding_of_groom(const awt_groom *groom, geom_binding **out, awt_error *error)
{
    const awt_groom_info *info = &groom->info;
    float longest, largest;
    *out = NULL;
    geom_binding *b = calloc(1, sizeof *b);
    if (!b) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    measure_offsets(groom, &longest, &largest);
    b->strands = info->strand_count;
    b->points = info->points_per_strand;
    b->wisps = info->wisp_count[info->levels - 1];
    b->sections = info->sections;
    b->position_bits = choose_position_bits(info);
    b->turn_bits = choose_turn_bits(longest);
    const draco_box box = measure_box(info, 0, (int)b->position_bits);
    b->position_step_m = draco_box_step(&box);
    b->offset_step_m = largest / 32767.0f;
    bool made = binding_take_memory(b);
    if (made) {
        fill(groom, b);
        made = find_id(b);
    }
    if (!made) {
        geom_binding_destroy(b);
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    *out = b;
    return AWT_OK;
}

awt_status geom_binding_write(const awt_groom *groom, void *bytes, size_t capacity, size_t *size, awt_error *error)
{
    geom_binding *b;
    awt_status status = binding_of_groom(groom, &b, error);
    if (status != AWT_OK) {
        *size = 0;
        return status;
    }
    *size = binding_walk_out(b, bytes, capacity);
    if (bytes && capacity < *size) {
        status = error_set(error, AWT_LIMIT, "the binding needs %zu bytes, not %zu", *size, capacity);
    }
    geom_binding_destroy(b);
    return status;
}
