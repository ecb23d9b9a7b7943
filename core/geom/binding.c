/* binding.c: the binding's file, counted, written and read by one walk, and everything checked that is read. */
#include "geom/binding.h"

#include "base/codec.h"
#include "base/error.h"
#include "base/hash.h"

#include <math.h>
#include <stdlib.h>

enum { HEAD_BYTES = 8 + 8 + 8 * 4 }; /* all before the arrays */
static const unsigned char MAGIC[4] = {'A', 'W', 'T', 'B'};
#define VERSION UINT32_C(1)
#define REACH_M 1e6f         /* no hair is farther away */
#define STEP_GREATEST_M 1.0f /* no quantisation is coarser */

static size_t padding(const geom_binding *b)
{
    return (size_t)b->strands * b->points % 2 * 2;
}

/* ---- the walk */

static void walk_counts(codec *c, geom_binding *b)
{
    codec_u32(c, &b->strands);
    codec_u32(c, &b->points);
    codec_u32(c, &b->wisps);
    codec_u32(c, &b->sections);
    codec_u32(c, &b->position_bits);
    codec_u32(c, &b->turn_bits);
    codec_f32(c, &b->position_step_m);
    codec_f32(c, &b->offset_step_m);
}

static void walk_floats(codec *c, float *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        codec_f32(c, &values[i]);
    }
}

static void walk_arrays(codec *c, geom_binding *b)
{
    const size_t nodes = (size_t)b->wisps * b->sections, offsets = 3 * (size_t)b->strands * b->points;
    unsigned char zeros[2] = {0};
    walk_floats(c, b->widths, b->points);
    for (uint32_t w = 0; w < b->wisps; w++) {
        codec_u32(c, &b->strand_first[w + 1]);
    }
    for (uint32_t w = 0; w < b->wisps; w++) {
        codec_u32(c, &b->tree[w]);
    }
    walk_floats(c, &b->rest_centre->x, 3 * nodes);
    walk_floats(c, &b->rest_frame->x, 4 * nodes);
    for (size_t i = 0; i < offsets; i++) {
        uint16_t bits = (uint16_t)b->packed[i];
        codec_u16(c, &bits);
        b->packed[i] = (int16_t)bits;
    }
    codec_bytes(c, zeros, padding(b));
}

/* FNV-1a over little-endian words (hash.h) of `size` bytes, a multiple of 4. */
static uint64_t hash_bytes(const unsigned char *bytes, size_t size)
{
    uint64_t hash = HASH_SEED;
    for (size_t i = 0; i < size; i += 4) {
        hash = hash_u64(hash, load_u32(bytes + i));
    }
    return hash;
}

static size_t file_size(const geom_binding *b)
{
    return HEAD_BYTES + 4 * (size_t)b->points + 8 * (size_t)b->wisps + 28 * (size_t)b->wisps * b->sections +
           6 * (size_t)b->strands * b->points + padding(b);
}

size_t binding_walk_out(geom_binding *b, void *bytes, size_t capacity)
{
    const size_t size = file_size(b);
    if (bytes && capacity >= size) {
        unsigned char *out = bytes;
        codec c = codec_writing(out + 16, size - 16);
        memcpy(out, MAGIC, sizeof MAGIC);
        store_u32(out + 4, VERSION);
        walk_counts(&c, b);
        walk_arrays(&c, b);
        b->id = hash_bytes(out + 16, size - 16);
        store_u64(out + 8, b->id);
    }
    return size;
}

/* ---- memory */

bool binding_take_memory(geom_binding *b)
{
    const size_t nodes = (size_t)b->wisps * b->sections;
    b->widths = calloc(b->points, sizeof *b->widths);
    b->strand_first = calloc((size_t)b->wisps + 1, sizeof *b->strand_first);
    b->tree = calloc(b->wisps, sizeof *b->tree);
    b->rest_centre = calloc(nodes, sizeof *b->rest_centre);
    b->rest_frame = calloc(nodes, sizeof *b->rest_frame);
    b->packed = calloc((size_t)b->strands * b->points, 3 * sizeof *b->packed);
    return b->widths && b->strand_first && b->tree && b->rest_centre && b->rest_frame && b->packed;
}

void geom_binding_destroy(geom_binding *b)
{
    if (b) {
        free(b->widths);
        free(b->strand_first);
        free(b->tree);
        free(b->rest_centre);
        free(b->rest_frame);
        free(b->packed);
        free(b->offsets);
        free(b);
    }
}

/* ---- reading */

static bool step_sound(float step)
{
    return step >= 0 && step <= STEP_GREATEST_M;
}

static bool counts_sound(const geom_binding *b)
{
    return b->strands >= 1 && b->strands <= AWT_MAX_STRANDS && b->points >= 2 &&
           b->points <= AWT_MAX_POINTS_PER_STRAND && (uint64_t)b->strands * b->points <= AWT_MAX_POINTS &&
           b->wisps >= 1 && b->wisps <= b->strands && b->sections >= 2 && b->sections <= AWT_MAX_SECTIONS &&
           (uint64_t)b->wisps * b->sections <= AWT_MAX_NODES && b->position_bits >= BINDING_LEAST_BITS &&
           b->position_bits <= BINDING_MOST_BITS && b->turn_bits >= BINDING_LEAST_BITS &&
           b->turn_bits <= BINDING_MOST_BITS && step_sound(b->position_step_m) && step_sound(b->offset_step_m);
}

static bool wisps_sound(const geom_binding *b)
{
    bool sound = b->strand_first[b->wisps] == b->strands && b->tree[0] == 0;
    for (uint32_t w = 0; w < b->wisps; w++) {
        sound = sound && b->strand_first[w + 1] > b->strand_first[w];
        sound = sound && (w == 0 || b->tree[w] - b->tree[w - 1] <= 1);
    }
    return sound;
}

static bool sections_sound(const geom_binding *b)
{
    bool sound = true;
    for (uint32_t i = 0; i < b->points; i++) {
        sound = sound && b->widths[i] >= 0 && b->widths[i] <= REACH_M;
    }
    for (size_t n = 0; n < (size_t)b->wisps * b->sections; n++) {
        const vec3 *p = &b->rest_centre[n];
        const quat *q = &b->rest_frame[n];
        float square = q->x * q->x + q->y * q->y + q->z * q->z + q->w * q->w;
        sound = sound && fabsf(p->x) <= REACH_M && fabsf(p->y) <= REACH_M && fabsf(p->z) <= REACH_M &&
                fabsf(square - 1.0f) <= 1e-3f;
    }
    return sound;
}

/* Offsets in metres, which is how they are evaluated. False: no memory. */
static bool unpack(geom_binding *b)
{
    const size_t count = 3 * (size_t)b->strands * b->points;
    b->offsets = malloc(count * sizeof *b->offsets);
    for (size_t i = 0; b->offsets && i < count; i++) {
        b->offsets[i] = (float)b->packed[i] * b->offset_step_m;
    }
    free(b->packed);
    b->packed = NULL;
    return b->offsets != NULL;
}

/* Head and length, before anything is allocated. */
static awt_status read_head(const unsigned char *bytes, size_t size, geom_binding *b, awt_error *error)
{
    if (size < HEAD_BYTES) {
        return error_set(error, AWT_TRUNCATED, "the binding ends within its first %d bytes", HEAD_BYTES);
    }
    if (memcmp(bytes, MAGIC, sizeof MAGIC) != 0) {
        return error_set(error, AWT_BAD_FORMAT, "this is not a binding of awtd");
    }
    if (load_u32(bytes + 4) != VERSION) {
        return error_set(error, AWT_OTHER_VERSION, "the binding is of version %u, not %u", load_u32(bytes + 4),
                         VERSION);
    }
    codec c = codec_reading(bytes + 16, HEAD_BYTES - 16);
    b->id = load_u64(bytes + 8);
    walk_counts(&c, b);
    if (!counts_sound(b)) {
        return error_set(error, AWT_BAD_VALUE, "the binding's counts are impossible");
    }
    if (size < file_size(b)) {
        return error_set(error, AWT_TRUNCATED, "the binding ends at byte %u of %u", (unsigned)size,
                         (unsigned)file_size(b));
    }
    if (size > file_size(b) || hash_bytes(bytes + 16, size - 16) != b->id) {
        return error_set(error, AWT_BAD_VALUE, "the binding is damaged: its bytes do not make its id");
    }
    return AWT_OK;
}

awt_status geom_binding_read(const void *bytes, size_t size, geom_binding **out, awt_error *error)
{
    geom_binding head = {0};
    *out = NULL;
    awt_status status = read_head(bytes, size, &head, error);
    if (status != AWT_OK) {
        return status;
    }
    geom_binding *b = malloc(sizeof *b);
    if (!b) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    *b = head;
    if (!binding_take_memory(b)) {
        geom_binding_destroy(b);
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    codec c = codec_reading((const unsigned char *)bytes + HEAD_BYTES, size - HEAD_BYTES);
    walk_arrays(&c, b);
    if (!codec_ends(&c) || !wisps_sound(b) || !sections_sound(b)) {
        status = error_set(error, AWT_BAD_VALUE, "a number of the binding is impossible");
    } else if (!unpack(b)) {
        status = error_set(error, AWT_NO_MEMORY, NULL);
    }
    if (status != AWT_OK) {
        geom_binding_destroy(b);
        return status;
    }
    *out = b;
    return AWT_OK;
}
