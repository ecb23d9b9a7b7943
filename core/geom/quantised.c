/* quantised.c: see encode.h and quantised.h. */
#include "geom/quantised.h"

#include "base/crc32c.h"
#include "base/error.h"
#include "geom/delta_checksum.h"
#include "geom/guides.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

delta_shape quantised_shape(const geom_layout *layout, uint32_t strands)
{
    const bool guides = layout->kind == GEOM_GUIDES;
    return (delta_shape){.strands = strands,
                         .points = layout->points_per_strand,
                         .components = guides ? GUIDES_COMPONENTS : 3,
                         .bits = guides ? GUIDES_BITS : layout->box.bits};
}

draco_box quantised_box(const geom_layout *layout)
{
    return layout->kind == GEOM_GUIDES ? (draco_box){.bits = GUIDES_BITS} : layout->box;
}

uint64_t quantised_binding(const geom_layout *layout)
{
    return layout->binding ? layout->binding->id : 0;
}

static void *hold(geom_quantised *quantised, size_t size)
{
    quantised->held += size;
    return malloc(size);
}

/* Points of a patch, and its numbers. */
static size_t patch_points(const geom_layout *layout, uint32_t index)
{
    return (size_t)layout->patches[index].strands * layout->points_per_strand;
}

static size_t patch_count(const geom_layout *layout, uint32_t index)
{
    const delta_shape shape = quantised_shape(layout, layout->patches[index].strands);
    return delta_count(&shape);
}

static bool make_patches(const geom_layout *layout, geom_quantised *made)
{
    made->patches = calloc(layout->patch_count, sizeof(patch_numbers *));
    made->held += layout->patch_count * sizeof(patch_numbers *);
    bool has_all = made->patches != NULL;
    for (; has_all && made->patch_count < layout->patch_count; made->patch_count += has_all) {
        const size_t count = patch_count(layout, made->patch_count);
        made->patches[made->patch_count] = patch_numbers_create(count);
        made->held += patch_numbers_bytes(count);
        has_all = made->patches[made->patch_count] != NULL;
    }
    return has_all;
}

awt_status geom_quantised_create(const geom_layout *layout, geom_quantised **out, awt_error *error)
{
    *out = NULL;
    if (layout->kind == GEOM_RIBBON) {
        return error_set(error, AWT_BAD_VALUE, "frames of this kind have no deltas");
    }
    geom_quantised *made = calloc(1, sizeof *made);
    if (!made) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    const delta_shape shape = quantised_shape(layout, layout->strands);
    const size_t sections = (size_t)layout->largest_patch * layout->points_per_strand;
    made->held = sizeof *made;
    made->count = delta_count(&shape);
    bool has_all = make_patches(layout, made);
    if (layout->kind == GEOM_GUIDES) {
        made->turns = hold(made, 3 * sections * sizeof *made->turns);
        made->rebuilt = hold(made, sections * sizeof *made->rebuilt);
        has_all = has_all && made->turns && made->rebuilt;
    }
    if (!has_all) {
        geom_quantised_destroy(made);
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    *out = made;
    return AWT_OK;
}

void geom_quantised_destroy(geom_quantised *quantised)
{
    if (quantised) {
        for (uint32_t i = 0; i < quantised->patch_count; i++) {
            patch_numbers_destroy(quantised->patches[i]);
        }
        free(quantised->patches);
        free(quantised->turns);
        free(quantised->rebuilt);
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

/* Points before a patch. */
static size_t patch_first(const geom_layout *layout, uint32_t index)
{
    return (size_t)layout->patches[index].first_strand * layout->points_per_strand;
}

static bool same_shape(const geom_quantised *quantised, const geom_layout *layout)
{
    const delta_shape shape = quantised_shape(layout, layout->strands);
    return quantised->count == delta_count(&shape) && quantised->patch_count == layout->patch_count &&
           (quantised->rebuilt != NULL) == (layout->kind == GEOM_GUIDES);
}

bool quantised_fits(const geom_quantised *quantised, const geom_layout *layout)
{
    return quantised->layout == layout && same_shape(quantised, layout);
}

const uint16_t *quantised_patch(const geom_quantised *quantised, uint32_t index)
{
    return quantised->patches[index]->numbers;
}

/* Two checksums that agree prove nothing; numbers that do, do. */
bool quantised_same(const geom_quantised *one, const geom_quantised *other, uint32_t index)
{
    const patch_numbers *a = one->patches[index], *b = other->patches[index];
    return a == b || (a->checksum == b->checksum &&
                      memcmp(a->numbers, b->numbers, patch_count(one->layout, index) * sizeof *a->numbers) == 0);
}

/* ---- patches that changed. False: a point or frame is not finite. */

static bool take_points(const geom_layout *layout, const float *points, uint32_t index, uint16_t *numbers,
                        uint32_t *clamped)
{
    const size_t count = patch_points(layout, index);
    const float *here = points + 3 * patch_first(layout, index);
    const quantise_findings found = quantise_numbers(&layout->box, &layout->bounds, here, count, numbers);
    if (found.outside && found.finite) {
        *clamped += quantise_count_outside(&layout->bounds, here, count);
    }
    return found.finite;
}

static bool all_finite(const float *values, size_t count)
{
    bool finite = true;
    for (size_t i = 0; i < count; i++) {
        finite = finite && isfinite(values[i]);
    }
    return finite;
}

static bool take_sections(const geom_layout *layout, const geom_quantise_def *def, uint32_t index, uint16_t *numbers,
                          geom_quantised *out, uint32_t *clamped)
{
    const guides_part part = {layout->patches[index].first_strand, layout->patches[index].strands};
    const float *centres = def->points + 3 * patch_first(layout, index);
    const float *frames = def->frames + 4 * patch_first(layout, index);
    if (!all_finite(centres, 3 * patch_points(layout, index)) ||
        !guides_turns(layout->binding, part, (const quat *)(const void *)frames, out->turns)) {
        return false;
    }
    *clamped +=
        guides_bind(layout->binding, part, (const vec3 *)(const void *)centres, out->turns, numbers, out->rebuilt);
    return true;
}

static bool take_patch(const geom_layout *layout, const geom_quantise_def *def, uint32_t index, geom_quantised *out,
                       uint32_t *clamped)
{
    patch_numbers *own = out->patches[index] = patch_numbers_own(out->patches[index]);
    const bool taken = layout->kind == GEOM_GUIDES ? take_sections(layout, def, index, own->numbers, out, clamped)
                                                   : take_points(layout, def->points, index, own->numbers, clamped);
    if (taken) {
        own->checksum = delta_checksum_numbers(own->numbers, patch_count(layout, index));
    }
    return taken;
}

static uint32_t find_checksum(const geom_layout *layout, const geom_quantised *quantised)
{
    const draco_box box = quantised_box(layout);
    uint32_t checksum = 0;
    for (uint32_t i = 0; i < layout->patch_count; i++) {
        checksum = crc32c_join(checksum, quantised->patches[i]->checksum, patch_count(layout, i) * sizeof(uint16_t));
    }
    return delta_checksum(checksum, &box, quantised_binding(layout));
}

static awt_status check_def(const geom_layout *layout, const geom_quantise_def *def, const geom_quantised *out,
                            awt_error *error)
{
    if (!same_shape(out, layout) || (def->unchanged && !(def->previous && quantised_fits(def->previous, layout)))) {
        return error_set(error, AWT_BAD_VALUE, "the whole numbers are none of this layout's");
    }
    if (layout->kind == GEOM_GUIDES && !def->frames) {
        return error_set(error, AWT_BAD_VALUE, "guides have frames");
    }
    return AWT_OK;
}

awt_status geom_quantise(const geom_layout *layout, const geom_quantise_def *def, geom_quantised *out,
                         uint32_t *clamped, awt_error *error)
{
    uint32_t outside = 0, taken = 0;
    awt_status status = check_def(layout, def, out, error);
    if (status != AWT_OK) {
        return status;
    }
    out->layout = NULL;
    for (uint32_t i = 0; i < layout->patch_count; i++) {
        if (def->unchanged && def->unchanged[i]) {
            out->patches[i] = patch_numbers_share(out->patches[i], def->previous->patches[i]);
        } else if (take_patch(layout, def, i, out, &outside)) {
            taken++;
        } else {
            return error_set(error, AWT_BAD_VALUE, "a point or frame of patch %u is not a finite number", i);
        }
    }
    out->checksum = taken > 0 ? find_checksum(layout, out) : def->previous->checksum;
    out->layout = layout;
    *clamped += outside;
    return AWT_OK;
}
