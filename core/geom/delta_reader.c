/* delta_reader.c: see delta_reader.h. */
#include "geom/delta_reader.h"

#include "base/error.h"
#include "geom/delta_checksum.h"

#include <stdlib.h>
#include <string.h>

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

awt_status delta_reader_open(const void *bytes, size_t size, delta_glb *glb, delta_header *header, codec *block,
                             awt_error *error)
{
    *header = (delta_header){0};
    awt_status status = delta_glb_read(bytes, size, glb, error);
    if (status == AWT_OK) {
        *block = codec_reading(glb->block, glb->size);
        delta_header_walk(block, header);
    }
    return status;
}

awt_status delta_reader_room(geom_delta_reader *reader, const delta_shape *shape, awt_error *error)
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

/* ---- the patches */

/* Patches that are read at once. */
typedef struct patch_window {
    delta_entry entries[RANS_LANES];
    cloud_source clouds[RANS_LANES];
    int count;
} patch_window;

delta_shape delta_reader_shape(const delta_header *h, uint32_t strands)
{
    return (delta_shape){
        .strands = strands, .points = h->points_per_strand, .components = h->components, .bits = h->bits};
}

/* Adds a patch, whose strands begin at `next` or later; *clouds moves behind its cloud. */
static bool add_patch(geom_delta_reader *reader, const delta_header *h, const delta_entry *entry, uint32_t next,
                      codec *clouds, patch_window *w)
{
    static const uint8_t zeros[2];
    size_t from;
    if (entry->first_strand < next || entry->first_strand >= h->strands || entry->strands < 1 ||
        entry->strands > h->strands - entry->first_strand || entry->carry > DELTA_PLAIN ||
        (entry->whole && entry->carry != DELTA_PLAIN) || memcmp(entry->zeros, zeros, sizeof zeros) != 0 ||
        !codec_pass(clouds, entry->size, &from)) {
        return false;
    }
    const delta_shape shape = delta_reader_shape(h, entry->strands);
    w->entries[w->count] = *entry;
    w->clouds[w->count] = (cloud_source){clouds->in + from, entry->size, shape.strands * shape.points};
    reader->clouds.symbols[w->count++] = reader->symbols + entry->first_strand * delta_row(&shape);
    return delta_count(&shape) <= SYMBOLS_MAX_COUNT;
}

static bool take_window(geom_delta_reader *reader, const delta_header *h, const patch_window *w)
{
    if (!cloud_read(&reader->clouds, w->clouds, h->components, h->bits)) {
        return false;
    }
    for (int k = 0; k < w->count; k++) {
        const delta_entry *entry = &w->entries[k];
        const delta_shape shape = delta_reader_shape(h, entry->strands);
        const size_t begin = entry->first_strand * delta_row(&shape);
        delta_apply(&shape, entry->carry, reader->symbols + begin, entry->whole ? NULL : reader->base + begin,
                    reader->changes, reader->now + begin);
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
    return codec_ends(block) && !entries.spent;
}

awt_status delta_reader_take(geom_delta_reader *reader, const delta_header *h, codec *block, awt_error *error)
{
    const delta_shape shape = delta_reader_shape(h, h->strands);
    memcpy(reader->now, reader->base, delta_count(&shape) * sizeof *reader->now);
    if (!take_patches(reader, h, block) || delta_reader_checksum(h, reader->now) != h->checksum) {
        return error_set(error, AWT_BAD_FORMAT, "the delta's patches are damaged");
    }
    return AWT_OK;
}

draco_box delta_reader_box(const delta_header *h)
{
    return (draco_box){.origin = {h->origin[0], h->origin[1], h->origin[2]}, .range = h->range, .bits = h->bits};
}

uint32_t delta_reader_checksum(const delta_header *h, const uint16_t *numbers)
{
    const delta_shape shape = delta_reader_shape(h, h->strands);
    const draco_box box = delta_reader_box(h);
    return delta_checksum(delta_checksum_numbers(numbers, delta_count(&shape)), &box, h->binding);
}
