/* delta_read.c: geom_read_delta: a stranger's delta onto a frame that is here. Everything is checked against that frame
 * before it is used, the numbers themselves by their checksums: of the base before anything is added to it, of the
 * result before anything is handed out. */
#include "base/error.h"
#include "geom/cloud.h"
#include "geom/delta.h"
#include "geom/delta_format.h"
#include "geom/delta_glb.h"
#include "geom/quantise.h"
#include "geom/quantised.h"
#include "geom/read.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A box that is smaller or farther away is no hair's; in none other do numbers leave the range of their types. */
#define BOX_LEAST_M 0.015625f
#define BOX_REACH_M 1e6f

struct geom_delta_reader {
    cloud_reader clouds;
    uint16_t *base, *now, *symbols; /* [room]; symbols of all patches, each at its strands' place */
    int16_t *changes;
    size_t room, changes_room;
};

awt_status geom_delta_reader_create(geom_delta_reader **out, awt_error *error)
{
    geom_delta_reader *made = malloc(sizeof *made);
    *out = made;
    if (!made) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    made->base = made->now = made->symbols = NULL;
    made->changes = NULL;
    made->room = made->changes_room = 0;
    return AWT_OK;
}

static void free_arrays(geom_delta_reader *reader)
{
    free(reader->base);
    free(reader->now);
    free(reader->symbols);
    free(reader->changes);
    reader->base = reader->now = reader->symbols = NULL;
    reader->changes = NULL;
    reader->room = reader->changes_room = 0;
}

void geom_delta_reader_destroy(geom_delta_reader *reader)
{
    if (reader) {
        free_arrays(reader);
        free(reader);
    }
}

/* Room for frames of that shape, as large as the frame that is here and no larger. */
static awt_status make_room(geom_delta_reader *reader, const delta_shape *shape, awt_error *error)
{
    const size_t room = delta_room(shape), changes = delta_before(shape) + room;
    if (reader->room >= room && reader->changes_room >= changes) {
        return AWT_OK;
    }
    free_arrays(reader);
    reader->base = malloc(room * sizeof *reader->base);
    reader->now = malloc(room * sizeof *reader->now);
    reader->symbols = malloc(room * sizeof *reader->symbols);
    reader->changes = malloc(changes * sizeof *reader->changes);
    if (!reader->base || !reader->now || !reader->symbols || !reader->changes) {
        free_arrays(reader);
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    reader->room = room;
    reader->changes_room = changes;
    return AWT_OK;
}

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
        h->zero != 0 || !box_is_sound(h)) {
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

static uint32_t checksum_of(const uint16_t *numbers, size_t count, const draco_box *box)
{
    return quantised_checksum(quantised_numbers_checksum(numbers, count), box);
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
    if (!fits || checksum_of(reader->base, 3 * points, box) != h->base_checksum) {
        return error_set(error, AWT_BAD_VALUE, "the delta is for another frame than this base");
    }
    return AWT_OK;
}

/* ---- the patches */

/* Patches that are read at once. */
typedef struct patch_window {
    delta_entry entries[RANS_LANES];
    cloud_source clouds[RANS_LANES];
    int count;
} patch_window;

static delta_shape shape_of(const delta_header *h, uint32_t strands)
{
    return (delta_shape){.strands = strands, .points = h->points_per_strand, .components = 3, .bits = h->bits};
}

/* Adds a patch, whose strands begin at `next` or later; *clouds moves behind its cloud. */
static bool add_patch(geom_delta_reader *reader, const delta_header *h, const delta_entry *entry, uint32_t next,
                      codec *clouds, patch_window *w)
{
    static const uint8_t zeros[3];
    size_t from;
    if (entry->first_strand < next || entry->first_strand >= h->strands || entry->strands < 1 ||
        entry->strands > h->strands - entry->first_strand || entry->carry > DELTA_GREATEST_CARRY ||
        memcmp(entry->zeros, zeros, sizeof zeros) != 0 || !codec_pass(clouds, entry->size, &from)) {
        return false;
    }
    const delta_shape shape = shape_of(h, entry->strands);
    w->entries[w->count] = *entry;
    w->clouds[w->count] = (cloud_source){clouds->in + from, entry->size, shape.strands * shape.points};
    reader->clouds.symbols[w->count++] = reader->symbols + entry->first_strand * delta_row(&shape);
    return delta_count(&shape) <= SYMBOLS_MAX_COUNT;
}

static bool take_window(geom_delta_reader *reader, const delta_header *h, const patch_window *w)
{
    if (!cloud_read(&reader->clouds, w->clouds, 3, h->bits)) {
        return false;
    }
    for (int k = 0; k < w->count; k++) {
        const delta_entry *entry = &w->entries[k];
        const delta_shape shape = shape_of(h, entry->strands);
        const size_t begin = entry->first_strand * delta_row(&shape);
        delta_apply(&shape, entry->carry, reader->symbols + begin, reader->base + begin, reader->changes,
                    reader->now + begin);
    }
    return true;
}

/* All patches, and nothing behind the last. */
static bool take_patches(geom_delta_reader *reader, const delta_header *h, codec *block)
{
    const size_t table = (size_t)h->patches * DELTA_ENTRY_BYTES;
    size_t from;
    if (h->patches > h->strands || !codec_pass(block, table, &from)) {
        return false;
    }
    codec entries = codec_reading(block->in + from, table);
    uint32_t next = 0;
    for (uint32_t i = 0; i < h->patches;) {
        patch_window w = {.count = 0};
        for (; i < h->patches && w.count < RANS_LANES; i++) {
            delta_entry entry = {0};
            delta_entry_walk(&entries, &entry);
            if (!add_patch(reader, h, &entry, next, block, &w)) {
                return false;
            }
            next = entry.first_strand + entry.strands;
        }
        if (!take_window(reader, h, &w)) {
            return false;
        }
    }
    return codec_ends(block);
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
    delta_header header = {0};
    awt_status status = delta_glb_read(bytes, size, &glb, error);
    if (status != AWT_OK) {
        return status;
    }
    codec block = codec_reading(glb.block, glb.size);
    delta_header_walk(&block, &header);
    status = check_header(&header, base, base_sequence, error);
    if (status != AWT_OK) {
        return status;
    }
    const delta_shape shape = shape_of(&header, header.strands);
    const draco_box box = {
        .origin = {header.origin[0], header.origin[1], header.origin[2]}, .range = header.range, .bits = header.bits};
    status = make_room(reader, &shape, error);
    if (status == AWT_OK) {
        status = take_base(reader, &header, &box, base, error);
    }
    if (status != AWT_OK) {
        return status;
    }
    memcpy(reader->now, reader->base, delta_count(&shape) * sizeof *reader->now);
    if (!take_patches(reader, &header, &block) ||
        checksum_of(reader->now, delta_count(&shape), &box) != header.checksum) {
        return error_set(error, AWT_BAD_FORMAT, "the delta's patches are damaged");
    }
    status = make_out(base, out, error);
    if (status == AWT_OK) {
        fill_out(reader, &box, &glb, base, out);
    }
    return status;
}
