/* delta_read.c: geom_read_delta: a stranger's delta onto a frame of strands that is here. Everything is checked against
 * that frame before it is used, the numbers themselves by their checksums: of the base before anything is added to it,
 * of the result before anything is handed out. */
#include "base/error.h"
#include "geom/delta_glb.h"
#include "geom/delta_reader.h"
#include "geom/quantise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A box that is smaller or farther away is no hair's; in none other do numbers leave the range of their types. */
#define BOX_LEAST_M 0.015625f
#define BOX_REACH_M 1e6f

/* ---- the base */

static bool box_is_sound(const delta_header *h)
{
    bool sound = h->range >= BOX_LEAST_M && h->range <= BOX_REACH_M && h->bits >= 1 && h->bits <= DELTA_MAX_BITS;
    for (int k = 0; k < 3; k++) {
        sound = sound && fabsf(h->origin[k]) <= BOX_REACH_M;
    }
    return sound;
}

static awt_status check_header(const delta_header *h, const geom_strands *base, uint64_t base_sequence,
                               awt_error *error)
{
    if (h->magic != DELTA_MAGIC || h->version != DELTA_VERSION || h->kind != GEOM_STRANDS || h->components != 3 ||
        h->zero != 0 || h->binding != 0 || !box_is_sound(h)) {
        return error_set(error, AWT_BAD_FORMAT, "the delta's header is none of awtd's, version %d", DELTA_VERSION);
    }
    if (base->kind != GEOM_STRANDS || h->strands != base->strand_count ||
        h->points_per_strand != base->points_per_strand) {
        return error_set(error, AWT_BAD_VALUE, "the delta is of %u strands of %u points, the base of %u of %u",
                         h->strands, h->points_per_strand, base->strand_count, base->points_per_strand);
    }
    if (h->base_sequence != base_sequence) {
        return error_set(error, AWT_BAD_VALUE, "the delta is for frame %llu, not %llu",
                         (unsigned long long)h->base_sequence, (unsigned long long)base_sequence);
    }
    return AWT_OK;
}

/* The whole numbers that the base's positions were made of: positions are exact to a small part of a step. */
static awt_status take_base(geom_delta_reader *reader, const delta_header *h, const draco_box *box,
                            const geom_strands *base, awt_error *error)
{
    const size_t points = (size_t)h->strands * h->points_per_strand;
    const uint16_t greatest = (uint16_t)((1u << h->bits) - 1);
    quantise_bounds bounds;
    for (int k = 0; k < 3; k++) {
        bounds.least[k] = box->origin[k];
        bounds.greatest[k] = draco_box_coordinate(box, k, greatest);
    }
    const quantise_findings found = quantise_numbers(box, &bounds, base->positions, points, reader->base);
    bool fits = found.finite;
    for (int k = 0; k < 3; k++) {
        fits = fits && found.least[k] <= greatest && found.greatest[k] <= greatest;
    }
    if (!fits || delta_reader_checksum(h, reader->base) != h->base_checksum) {
        return error_set(error, AWT_BAD_VALUE, "the delta is for another frame than this base");
    }
    return AWT_OK;
}

/* ---- the frame */

/* Memory like the base's, where `out` has none of that shape. */
static awt_status make_out(const geom_strands *base, geom_strands *out, awt_error *error)
{
    if (out->positions && out->widths && !out->vertices && out->strand_count == base->strand_count &&
        out->points_per_strand == base->points_per_strand) {
        return AWT_OK;
    }
    const size_t points = (size_t)base->strand_count * base->points_per_strand;
    geom_strands made = *base;
    made.positions = malloc(3 * points * sizeof *made.positions);
    made.widths = malloc(base->points_per_strand * sizeof *made.widths);
    if (!made.positions || !made.widths) {
        free(made.positions);
        free(made.widths);
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    geom_strands_fini(out);
    *out = made;
    return AWT_OK;
}

static void fill_out(const geom_delta_reader *reader, const draco_box *box, const delta_glb *glb,
                     const geom_strands *base, geom_strands *out)
{
    const size_t points = (size_t)base->strand_count * base->points_per_strand;
    const float step = draco_box_step(box);
    float *positions = out->positions, *widths = out->widths;
    for (size_t i = 0; i < 3 * points; i += 3) {
        for (size_t k = 0; k < 3; k++) {
            positions[i + k] = (float)reader->now[i + k] * step + box->origin[k];
        }
    }
    memcpy(widths, base->widths, base->points_per_strand * sizeof *widths);
    *out = *base;
    out->positions = positions;
    out->widths = widths;
    out->head = glb->head;
    out->time_us = glb->time_us;
}

awt_status geom_read_delta(geom_delta_reader *reader, const void *bytes, size_t size, const geom_strands *base,
                           uint64_t base_sequence, geom_strands *out, awt_error *error)
{
    delta_glb glb;
    delta_header header;
    codec block;
    awt_status status = delta_reader_open(bytes, size, &glb, &header, &block, error);
    if (status != AWT_OK) {
        return status;
    }
    status = check_header(&header, base, base_sequence, error);
    if (status != AWT_OK) {
        return status;
    }
    const delta_shape shape = delta_reader_shape(&header, header.strands);
    const draco_box box = delta_reader_box(&header);
    status = delta_reader_room(reader, &shape, error);
    if (status == AWT_OK) {
        status = take_base(reader, &header, &box, base, error);
    }
    if (status == AWT_OK) {
        status = delta_reader_take(reader, &header, &block, error);
    }
    if (status == AWT_OK) {
        status = make_out(base, out, error);
    }
    if (status == AWT_OK) {
        fill_out(reader, &box, &glb, base, out);
    }
    return status;
}
