/* quantised.c: see encode.h and quantised.h. */
#include "geom/quantised.h"

#include "base/bytes.h"
#include "base/crc32c.h"
#include "base/error.h"
#include "geom/layout.h"

#include <stdlib.h>
#include <string.h>

enum { CHECKSUM_PIECE = 1024 /* numbers */ };

awt_status geom_quantised_create(const geom_layout *layout, geom_quantised **out, awt_error *error)
{
    *out = NULL;
    if (layout->kind != GEOM_STRANDS) {
        return error_set(error, AWT_BAD_VALUE, "frames of this kind have no deltas");
    }
    geom_quantised *made = calloc(1, sizeof *made);
    if (!made) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    made->count = (size_t)layout->strands * layout->points_per_strand * 3;
    made->patch_count = layout->patch_count;
    made->numbers = malloc(made->count * sizeof *made->numbers);
    made->checksums = malloc(made->patch_count * sizeof *made->checksums);
    made->held = sizeof *made + made->count * sizeof *made->numbers + made->patch_count * sizeof *made->checksums;
    if (!made->numbers || !made->checksums) {
        geom_quantised_destroy(made);
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    *out = made;
    return AWT_OK;
}

void geom_quantised_destroy(geom_quantised *quantised)
{
    if (quantised) {
        free(quantised->numbers);
        free(quantised->checksums);
        free(quantised);
    }
}

size_t geom_quantised_bytes(const geom_quantised *quantised)
{
    return quantised->held;
}

uint32_t geom_quantised_checksum(const geom_quantised *quantised)
{
    return quantised->checksum;
}

uint32_t quantised_numbers_checksum(const uint16_t *numbers, size_t count)
{
    unsigned char piece[2 * CHECKSUM_PIECE];
    uint32_t crc = 0;
    for (size_t at = 0; at < count; at += CHECKSUM_PIECE) {
        const size_t here = count - at < CHECKSUM_PIECE ? count - at : CHECKSUM_PIECE;
        for (size_t i = 0; i < here; i++) {
            store_u16(piece + 2 * i, numbers[at + i]);
        }
        crc = crc32c_more(crc, piece, 2 * here);
    }
    return crc;
}

uint32_t quantised_checksum(uint32_t numbers_checksum, const draco_box *box)
{
    unsigned char bytes[17];
    for (int k = 0; k < 3; k++) {
        store_f32(bytes + 4 * k, box->origin[k]);
    }
    store_f32(bytes + 12, box->range);
    bytes[16] = (unsigned char)box->bits;
    return crc32c_more(numbers_checksum, bytes, sizeof bytes);
}

static size_t patch_begin(const geom_layout *layout, uint32_t index)
{
    return (size_t)layout->patches[index].first_strand * layout->points_per_strand * 3;
}

static size_t patch_points(const geom_layout *layout, uint32_t index)
{
    return (size_t)layout->patches[index].strands * layout->points_per_strand;
}

static bool same_shape(const geom_quantised *quantised, const geom_layout *layout)
{
    return quantised->count == (size_t)layout->strands * layout->points_per_strand * 3 &&
           quantised->patch_count == layout->patch_count;
}

bool quantised_fits(const geom_quantised *quantised, const geom_layout *layout)
{
    return quantised->layout == layout && same_shape(quantised, layout);
}

const uint16_t *quantised_patch(const geom_quantised *quantised, const geom_layout *layout, uint32_t index)
{
    return quantised->numbers + patch_begin(layout, index);
}

/* One patch that changed. False: a point is not finite. */
static bool take_patch(const geom_layout *layout, const float *points, uint32_t index, geom_quantised *out,
                       uint32_t *clamped)
{
    const size_t begin = patch_begin(layout, index), count = patch_points(layout, index);
    uint16_t *numbers = out->numbers + begin;
    const quantise_findings found = quantise_numbers(&layout->box, &layout->bounds, points + begin, count, numbers);
    if (found.outside && found.finite) {
        *clamped += quantise_count_outside(&layout->bounds, points + begin, count);
    }
    out->checksums[index] = quantised_numbers_checksum(numbers, 3 * count);
    return found.finite;
}

static void keep_patch(const geom_layout *layout, const geom_quantised *previous, uint32_t index, geom_quantised *out)
{
    const size_t begin = patch_begin(layout, index), count = patch_points(layout, index);
    if (previous != out) {
        memcpy(out->numbers + begin, previous->numbers + begin, 3 * count * sizeof *out->numbers);
        out->checksums[index] = previous->checksums[index];
    }
}

awt_status geom_quantise(const geom_layout *layout, const geom_quantise_def *def, geom_quantised *out,
                         uint32_t *clamped, awt_error *error)
{
    if (!same_shape(out, layout) || (def->unchanged && !(def->previous && quantised_fits(def->previous, layout)))) {
        return error_set(error, AWT_BAD_VALUE, "the whole numbers are none of this layout's");
    }
    uint32_t outside = 0, checksum = 0;
    out->layout = NULL;
    for (uint32_t i = 0; i < layout->patch_count; i++) {
        if (def->unchanged && def->unchanged[i]) {
            keep_patch(layout, def->previous, i, out);
        } else if (!take_patch(layout, def->points, i, out, &outside)) {
            return error_set(error, AWT_BAD_VALUE, "a strand point of patch %u is not a finite number", i);
        }
        checksum = crc32c_join(checksum, out->checksums[i], 6 * patch_points(layout, i));
    }
    out->checksum = quantised_checksum(checksum, &layout->box);
    out->layout = layout;
    *clamped += outside;
    return AWT_OK;
}
