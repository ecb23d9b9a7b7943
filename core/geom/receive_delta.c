/* receive_delta.c: geom_read_guides_delta: a stranger's frame of guides as numbers, against the frame that is here or
 * against nothing, and these to sections by the binding. Everything is checked against the binding before it is used,
 * the numbers themselves by their checksums. */
#include "geom/receive.h"

#include "base/error.h"
#include "geom/delta_glb.h"
#include "geom/delta_reader.h"
#include "geom/guides.h"

#include <stdlib.h>
#include <string.h>

static awt_status check_header(const geom_binding *binding, const delta_header *h, awt_error *error)
{
    const bool no_box = h->origin[0] == 0 && h->origin[1] == 0 && h->origin[2] == 0 && h->range == 0;
    if (h->magic != DELTA_MAGIC || h->version != DELTA_VERSION || h->kind != GEOM_GUIDES ||
        h->components != GUIDES_COMPONENTS || h->bits != GUIDES_BITS || h->zero != 0 || !no_box) {
        return error_set(error, AWT_BAD_FORMAT, "the delta's header is none of awtd's guides, version %d",
                         DELTA_VERSION);
    }
    if (h->binding != binding->id || h->strands != binding->wisps || h->points_per_strand != binding->sections) {
        return error_set(error, AWT_BAD_VALUE, "the frame's guides belong to another binding: %016llx",
                         (unsigned long long)h->binding);
    }
    return AWT_OK;
}

static size_t sections_of(const geom_binding *binding)
{
    return (size_t)binding->wisps * binding->sections;
}

/* The numbers that the frame is said against become the reader's; of a whole frame they are 0. */
static awt_status take_base(geom_delta_reader *reader, const delta_header *h, const geom_guides *base,
                            uint64_t base_sequence, awt_error *error)
{
    const size_t size = GUIDES_COMPONENTS * (size_t)h->strands * h->points_per_strand * sizeof *reader->base;
    if (h->base_sequence == 0) {
        memset(reader->base, 0, size);
        return h->base_checksum == 0 ? AWT_OK : error_set(error, AWT_BAD_FORMAT, "a whole frame has no base");
    }
    if (!base || !base->numbers || base->wisps != h->strands || base->sections != h->points_per_strand) {
        return error_set(error, AWT_BAD_VALUE, "the delta is for a frame of guides that is not here");
    }
    if (h->base_sequence != base_sequence) {
        return error_set(error, AWT_BAD_VALUE, "the delta is for frame %llu, not %llu",
                         (unsigned long long)h->base_sequence, (unsigned long long)base_sequence);
    }
    if (delta_reader_checksum(h, base->numbers) != h->base_checksum) {
        return error_set(error, AWT_BAD_VALUE, "the delta is for another frame than this base");
    }
    memcpy(reader->base, base->numbers, size);
    return AWT_OK;
}

/* Memory for all sections, where `out` has none of that shape. */
static awt_status make_out(const geom_binding *binding, geom_guides *out, awt_error *error)
{
    const size_t sections = sections_of(binding);
    if (out->centres && out->frames && out->numbers && out->wisps == binding->wisps &&
        out->sections == binding->sections) {
        return AWT_OK;
    }
    geom_guides made = {.wisps = binding->wisps,
                        .sections = binding->sections,
                        .centres = malloc(sections * sizeof(vec3)),
                        .frames = malloc(sections * sizeof(quat)),
                        .numbers = malloc(GUIDES_COMPONENTS * sections * sizeof(uint16_t))};
    if (!made.centres || !made.frames || !made.numbers) {
        geom_guides_fini(&made);
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    geom_guides_fini(out);
    *out = made;
    return AWT_OK;
}

/* Numbers to sections; `turns` holds three of each. */
static void fill_out(const geom_binding *binding, const uint16_t *numbers, int16_t *turns, geom_guides *out)
{
    vec3 *centres = (vec3 *)(void *)out->centres;
    quat *frames = (quat *)(void *)out->frames;
    for (uint32_t w = 0; w < binding->wisps;) {
        const guides_part part = {w, guides_together(binding, w)};
        const size_t first = (size_t)w * binding->sections;
        guides_unbind(binding, part, numbers + GUIDES_COMPONENTS * first, turns + 3 * first, centres + first);
        guides_frames(binding, part, turns + 3 * first, frames + first);
        w += part.wisps;
    }
    memcpy(out->numbers, numbers, GUIDES_COMPONENTS * sections_of(binding) * sizeof *numbers);
}

bool geom_is_delta(const void *bytes, size_t size)
{
    delta_glb glb;
    return delta_glb_read(bytes, size, &glb, NULL) == AWT_OK;
}

awt_status geom_read_guides_delta(geom_delta_reader *reader, const geom_binding *binding, const void *bytes,
                                  size_t size, const geom_guides *base, uint64_t base_sequence, geom_guides *out,
                                  awt_error *error)
{
    delta_glb glb;
    delta_header header;
    codec block;
    awt_status status = delta_reader_open(bytes, size, &glb, &header, &block, error);
    if (status != AWT_OK) {
        return status;
    }
    status = check_header(binding, &header, error);
    if (status == AWT_OK) {
        const delta_shape shape = delta_reader_shape(&header, header.strands);
        status = delta_reader_room(reader, &shape, error);
    }
    if (status == AWT_OK) {
        status = take_base(reader, &header, base, base_sequence, error);
    }
    if (status == AWT_OK) {
        status = delta_reader_take(reader, &header, &block, error);
    }
    if (status == AWT_OK) {
        status = make_out(binding, out, error);
    }
    if (status == AWT_OK) {
        fill_out(binding, reader->now, reader->changes, out);
        out->patch_count = header.base_sequence ? base->patch_count : header.patches;
        out->head = glb.head;
        out->time_us = glb.time_us;
    }
    return status;
}
