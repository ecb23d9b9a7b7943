/* delta_write.c: geom_encode_delta: patches that changed become point clouds, behind a table, in a GLB. As in encode.c
 * they are taken RANS_LANES at a time, and what comes out of one does not depend on the others. */
#include "geom/delta_write.h"

#include "base/error.h"
#include "geom/buffer.h"
#include "geom/cloud.h"
#include "geom/delta.h"
#include "geom/delta_format.h"
#include "geom/delta_glb.h"
#include "geom/head_pose.h"
#include "geom/layout.h"
#include "geom/quantised.h"

#include <stdlib.h>

struct delta_scratch {
    cloud_writer *writer;
    int16_t *changes;  /* [delta_before + delta_room] of the largest patch */
    uint32_t *changed; /* [patch_count]: patches that changed, in order */
    size_t held;
};

/* Where encoding stands. */
typedef struct encoding {
    const geom_layout *layout;
    delta_scratch *scratch;
    const geom_delta_def *def;
    uint32_t patches; /* that changed */
    size_t block;     /* where it begins in `out` */
    geom_buffer *out;
    geom_frame_stats stats;
    awt_error *error;
} encoding;

awt_status delta_scratch_create(const geom_layout *layout, delta_scratch **out, awt_error *error)
{
    const delta_shape largest = quantised_shape(layout, layout->largest_patch);
    const size_t changes = (delta_before(&largest) + delta_room(&largest)) * sizeof(int16_t);
    const size_t changed = layout->patch_count * sizeof(uint32_t);
    *out = NULL;
    delta_scratch *made = calloc(1, sizeof *made);
    if (!made) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    made->changes = malloc(changes);
    made->changed = malloc(changed);
    made->held = sizeof *made + changes + changed;
    awt_status status = made->changes && made->changed ? AWT_OK : error_set(error, AWT_NO_MEMORY, NULL);
    if (status == AWT_OK) {
        status = cloud_writer_create(delta_room(&largest), largest.bits, &made->writer, error);
    }
    if (status != AWT_OK) {
        delta_scratch_destroy(made);
        return status;
    }
    *out = made;
    return AWT_OK;
}

void delta_scratch_destroy(delta_scratch *scratch)
{
    if (scratch) {
        cloud_writer_destroy(scratch->writer);
        free(scratch->changes);
        free(scratch->changed);
        free(scratch);
    }
}

size_t delta_scratch_bytes(const delta_scratch *scratch)
{
    return scratch->held + cloud_writer_bytes(scratch->writer);
}

static void list_changed(encoding *e)
{
    for (uint32_t i = 0; i < e->layout->patch_count; i++) {
        if (!e->def->base || !quantised_same(e->def->base, e->def->now, i)) {
            e->scratch->changed[e->patches++] = i;
        }
    }
}

/* Header and room for the table. */
static awt_status begin_block(encoding *e)
{
    const geom_layout *layout = e->layout;
    const size_t size = DELTA_HEADER_BYTES + (size_t)e->patches * DELTA_ENTRY_BYTES;
    const delta_shape shape = quantised_shape(layout, layout->strands);
    const draco_box box = quantised_box(layout);
    const geom_delta_def *def = e->def;
    unsigned char *at;
    delta_header header = {.magic = DELTA_MAGIC,
                           .version = DELTA_VERSION,
                           .kind = (uint8_t)layout->kind,
                           .components = (uint8_t)shape.components,
                           .bits = (uint8_t)shape.bits,
                           .base_sequence = def->base_sequence,
                           .sequence = def->sequence,
                           .base_checksum = def->base ? def->base->checksum : 0,
                           .checksum = def->now->checksum,
                           .strands = layout->strands,
                           .points_per_strand = layout->points_per_strand,
                           .origin = {box.origin[0], box.origin[1], box.origin[2]},
                           .range = box.range,
                           .patches = e->patches,
                           .binding = quantised_binding(layout)};
    e->block = e->out->size;
    awt_status status = geom_buffer_extend(e->out, size, &at, e->error);
    if (status == AWT_OK) {
        codec writing = codec_writing(at, DELTA_HEADER_BYTES);
        delta_header_walk(&writing, &header);
    }
    return status;
}

/* How a patch's numbers are said. */
typedef struct manner {
    uint8_t carry;
    bool whole;
} manner;

/* A cloud, and its entry in the table, number `place`. */
static awt_status put_patch(encoding *e, uint32_t place, manner how, const cloud_job *job, int lane)
{
    const geom_patch *patch = &e->layout->patches[e->scratch->changed[place]];
    unsigned char *at;
    awt_status status = geom_buffer_extend(e->out, job->size, &at, e->error);
    if (status != AWT_OK) {
        return status;
    }
    cloud_writer_put(e->scratch->writer, job, lane, at);
    delta_entry entry = {.first_strand = patch->first_strand,
                         .strands = patch->strands,
                         .size = (uint32_t)job->size,
                         .carry = how.carry,
                         .whole = how.whole};
    codec writing = codec_writing(e->out->bytes + e->block + DELTA_HEADER_BYTES + (size_t)place * DELTA_ENTRY_BYTES,
                                  DELTA_ENTRY_BYTES);
    delta_entry_walk(&writing, &entry);
    e->stats.vertices += job->points;
    e->stats.encoded_patches++;
    e->stats.entropy_bits += job->entropy_bits;
    return AWT_OK;
}

/* The least alphabet that has all symbols, or-ed. */
static uint32_t alphabet_of(uint16_t all)
{
    uint32_t alphabet = 32;
    while (alphabet <= all) {
        alphabet *= 2;
    }
    return alphabet;
}

/* The symbols of patch number `index`, which become cloud number `lane`. */
static manner make_symbols(encoding *e, uint32_t index, int lane, cloud_job *job)
{
    const geom_layout *layout = e->layout;
    const delta_shape shape = quantised_shape(layout, layout->patches[index].strands);
    const uint16_t *base = e->def->base ? quantised_patch(e->def->base, index) : NULL;
    const uint16_t *now = quantised_patch(e->def->now, index);
    uint16_t *symbols = cloud_writer_symbols(e->scratch->writer, lane), all;
    manner how = {.carry = DELTA_PLAIN};
    if (layout->kind == GEOM_GUIDES) {
        how.whole = delta_make_plain(&shape, base, now, symbols, &all);
    } else {
        how.carry = delta_make(&shape, base, now, e->scratch->changes, symbols, &all);
    }
    *job = (cloud_job){
        .points = shape.strands * shape.points, .components = shape.components, .alphabet = alphabet_of(all)};
    return how;
}

/* Patches number `first` and the next few of those that changed. */
static awt_status put_patches(encoding *e, uint32_t first)
{
    cloud_job jobs[RANS_LANES] = {{0}};
    manner manners[RANS_LANES];
    int count = 0;
    for (; count < RANS_LANES && first + (uint32_t)count < e->patches; count++) {
        manners[count] = make_symbols(e, e->scratch->changed[first + (uint32_t)count], count, &jobs[count]);
    }
    cloud_writer_run(e->scratch->writer, jobs, e->def->measure);
    awt_status status = AWT_OK;
    for (int k = 0; k < count && status == AWT_OK; k++) {
        status = put_patch(e, first + (uint32_t)k, manners[k], &jobs[k], k);
    }
    return status;
}

/* Guides alone come whole this way: strands have a better one (geom_encode). */
static awt_status check_def(const geom_layout *layout, const geom_delta_def *def, awt_error *error)
{
    if (!quantised_fits(def->now, layout) || (def->base && !quantised_fits(def->base, layout))) {
        return error_set(error, AWT_BAD_VALUE, "the whole numbers are none of this layout's");
    }
    if (layout->kind == GEOM_GUIDES ? !def->base != !def->base_sequence : !def->base) {
        return error_set(error, AWT_BAD_VALUE, "a delta has a base and its sequence, or of guides neither");
    }
    return AWT_OK;
}

awt_status geom_encode_delta(const geom_layout *layout, geom_scratch *scratch, const geom_delta_def *def,
                             geom_buffer *out, geom_frame_stats *stats, awt_error *error)
{
    encoding e = {.layout = layout, .scratch = geom_scratch_delta(scratch), .def = def, .out = out, .error = error};
    awt_pose head;
    if (!e.scratch) {
        return error_set(error, AWT_BAD_VALUE, "frames of this layout have no deltas");
    }
    awt_status status = check_def(layout, def, error);
    if (status == AWT_OK) {
        status = head_pose_take(&def->head, &head, error);
    }
    if (status == AWT_OK) {
        list_changed(&e);
        status = delta_glb_begin(&head, def->time_us, out, error);
    }
    if (status == AWT_OK) {
        status = begin_block(&e);
    }
    for (uint32_t first = 0; first < e.patches && status == AWT_OK; first += RANS_LANES) {
        status = put_patches(&e, first);
    }
    if (status == AWT_OK) {
        status = delta_glb_end(e.block, out, error);
    }
    if (status == AWT_OK && stats) {
        *stats = e.stats;
    }
    return status;
}
