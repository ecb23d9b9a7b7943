/* glb_template.c: see glb_template.h. tinygltf writes the frame once with numbers that do not matter; our own reader of
 * JSON finds where they stand. */
#include "geom/glb_template.h"

#include "base/error.h"
#include "geom/buffer.h"
#include "geom/draco_extra.h"
#include "geom/json.h"

#include <stdlib.h>
#include <string.h>

enum {
    GLB_HEADER = 12,
    GLB_CHUNK_HEADER = 8,
    REAL_WIDTH = 24,  /* -1.2345678901234567e-308 */
    WHOLE_WIDTH = 10, /* below 2^32 */
    TIME_WIDTH = 20
};

/* Fields in the order of glb_template.fields. */
enum { FIELD_TIME, FIELD_POSITION, FIELD_ORIENTATION = 4, FIELD_BUFFER = 8, FIELD_PATCHES };
enum { PATCH_OFFSET, PATCH_SIZE, PATCH_MIN, PATCH_MAX = 5, PATCH_FIELDS = 8 };

static uint32_t patch_field(uint32_t patch, uint32_t field)
{
    return FIELD_PATCHES + patch * PATCH_FIELDS + field;
}

/* ---- making */

/* A number in tinygltf's text, and the field that it becomes. */
typedef struct found_field {
    uint32_t begin, end, width, field;
} found_field;

typedef struct finder {
    json_document json;
    found_field *found; /* [count] */
    uint32_t count;
    bool missing;
} finder;

static void find_number(finder *f, uint32_t token, uint32_t width, uint32_t field)
{
    double value;
    if (!json_real(&f->json, token, &value)) {
        f->missing = true;
        return;
    }
    const json_token *t = &f->json.tokens[token];
    f->found[f->count++] = (found_field){t->begin, t->end, width, field};
}

/* Numbers stand in an array one token after the other. */
static void find_numbers(finder *f, uint32_t array, uint32_t count, uint32_t field)
{
    f->missing = f->missing || json_items(&f->json, array) != count;
    for (uint32_t k = 0; k < count && !f->missing; k++) {
        find_number(f, array + 1 + k, REAL_WIDTH, field + k);
    }
}

/* Each patch's accessors: indices, positions, `others`: turns or extra attributes. */
static void find_patches(finder *f, uint32_t others, uint32_t patch_count)
{
    const json_document *json = &f->json;
    uint32_t views = json_member(json, 0, "bufferViews"), accessors = json_member(json, 0, "accessors");
    f->missing = f->missing || json_items(json, views) != patch_count ||
                 json_items(json, accessors) != (2 + others) * patch_count;
    for (uint32_t i = 0, view = views + 1, accessor = accessors + 1; i < patch_count && !f->missing; i++) {
        uint32_t position = json->tokens[accessor].after;
        find_number(f, json_member(json, view, "byteOffset"), WHOLE_WIDTH, patch_field(i, PATCH_OFFSET));
        find_number(f, json_member(json, view, "byteLength"), WHOLE_WIDTH, patch_field(i, PATCH_SIZE));
        find_numbers(f, json_member(json, position, "min"), 3, patch_field(i, PATCH_MIN));
        find_numbers(f, json_member(json, position, "max"), 3, patch_field(i, PATCH_MAX));
        view = json->tokens[view].after;
        accessor = json->tokens[position].after;
        for (uint32_t k = 0; k < others && !f->missing; k++) {
            accessor = json->tokens[accessor].after;
        }
    }
}

static void find_all(finder *f, uint32_t others, uint32_t patch_count)
{
    const json_document *json = &f->json;
    uint32_t asset = json_member(json, 0, "asset"), node = json_member(json, 0, "nodes") + 1;
    uint32_t buffer = json_member(json, 0, "buffers") + 1;
    find_number(f, json_member(json, json_member(json, asset, "extras"), "time_us"), TIME_WIDTH, FIELD_TIME);
    find_numbers(f, json_member(json, node, "translation"), 3, FIELD_POSITION);
    find_numbers(f, json_member(json, node, "rotation"), 4, FIELD_ORIENTATION);
    find_number(f, json_member(json, buffer, "byteLength"), WHOLE_WIDTH, FIELD_BUFFER);
    find_patches(f, others, patch_count);
}

static int by_place(const void *a, const void *b)
{
    const found_field *x = a, *y = b;
    return x->begin < y->begin ? -1 : x->begin > y->begin;
}

static void put_u32(unsigned char *at, uint32_t value)
{
    for (int k = 0; k < 4; k++) {
        at[k] = (unsigned char)(value >> (8 * k));
    }
}

/* Both chunks' headers, and the text with its fields widened and emptied. */
static bool widen(const finder *f, uint32_t text_size, glb_template *out)
{
    size_t size = text_size;
    for (uint32_t i = 0; i < f->count; i++) {
        size += f->found[i].width - (f->found[i].end - f->found[i].begin);
    }
    size = (size + 3) / 4 * 4;
    out->size = GLB_HEADER + GLB_CHUNK_HEADER + size + GLB_CHUNK_HEADER;
    out->bytes = malloc(out->size);
    if (!out->bytes) {
        return false;
    }
    unsigned char *at = out->bytes + GLB_HEADER + GLB_CHUNK_HEADER;
    memset(at, ' ', size);
    uint32_t from = 0;
    for (uint32_t i = 0; i < f->count; i++) {
        memcpy(at, f->json.text + from, f->found[i].begin - from);
        at += f->found[i].begin - from;
        out->fields[f->found[i].field] = (uint32_t)(at - out->bytes);
        at += f->found[i].width;
        from = f->found[i].end;
    }
    memcpy(at, f->json.text + from, text_size - from);
    memcpy(out->bytes, "glTF\2\0\0\0", 8);
    put_u32(out->bytes + GLB_HEADER, (uint32_t)size);
    memcpy(out->bytes + GLB_HEADER + 4, "JSON", 4);
    memcpy(out->bytes + out->size - 4, "BIN\0", 4);
    return true;
}

/* The frame with numbers that tinygltf leaves none of out. */
static awt_status write_sample(const glb_frame *frame, geom_buffer *out, awt_error *error)
{
    static const unsigned char nothing[4];
    glb_frame sample = *frame;
    sample.head = (awt_pose){{1, 2, 3}, {0.5, 0.5, 0.5, 0.5}};
    sample.binary = nothing;
    sample.binary_size = sizeof nothing;
    sample.patches = calloc(frame->patch_count, sizeof *sample.patches);
    if (!sample.patches) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    for (uint32_t i = 0; i < frame->patch_count; i++) {
        sample.patches[i] = frame->patches[i];
        sample.patches[i].offset = sample.patches[i].size = 4; /* an offset of 0 would not be written */
    }
    awt_status status = glb_shim_write(&sample, out, error);
    free(sample.patches);
    return status;
}

awt_status glb_template_make(const glb_frame *frame, glb_template *out, awt_error *error)
{
    const uint32_t fields = FIELD_PATCHES + frame->patch_count * PATCH_FIELDS;
    geom_buffer sample = {0};
    finder f = {.found = calloc(fields, sizeof *f.found)};
    glb_template made = {.patch_count = frame->patch_count, .fields = calloc(fields, sizeof *made.fields)};
    awt_status status = AWT_NO_MEMORY;
    if (f.found && made.fields) {
        status = write_sample(frame, &sample, error);
    }
    if (status == AWT_OK) {
        uint32_t size = (uint32_t)sample.bytes[GLB_HEADER] | (uint32_t)sample.bytes[GLB_HEADER + 1] << 8 |
                        (uint32_t)sample.bytes[GLB_HEADER + 2] << 16 | (uint32_t)sample.bytes[GLB_HEADER + 3] << 24;
        status = json_read((const char *)sample.bytes + GLB_HEADER + GLB_CHUNK_HEADER, size, &f.json, error);
        if (status == AWT_OK) {
            const uint32_t turns = frame->attributes.form != DRACO_POSITIONS;
            find_all(&f, turns + draco_extra_count(frame->extra), frame->patch_count);
            status = f.missing ? AWT_BAD_VALUE : AWT_OK;
        }
        if (status == AWT_OK) {
            qsort(f.found, f.count, sizeof *f.found, by_place);
            status = widen(&f, size, &made) ? AWT_OK : AWT_NO_MEMORY;
        }
    }
    json_fini(&f.json);
    free(f.found);
    geom_buffer_fini(&sample);
    if (status != AWT_OK) {
        glb_template_fini(&made);
        return error_set(error, status, status == AWT_BAD_VALUE ? "tinygltf writes frames in an unknown way" : NULL);
    }
    *out = made;
    return AWT_OK;
}

void glb_template_fini(glb_template *t)
{
    free(t->bytes);
    free(t->fields);
    *t = (glb_template){0};
}

/* ---- filling in */

static void put_whole(unsigned char *at, uint32_t width, uint64_t value)
{
    char digits[20];
    uint32_t count = 0;
    do {
        digits[count++] = (char)('0' + value % 10);
        value /= 10;
    } while (value > 0);
    for (uint32_t k = 0; k < width; k++) {
        at[k] = k < count ? (unsigned char)digits[count - 1 - k] : ' ';
    }
}

static void put_real(unsigned char *at, double value)
{
    size_t length = glb_shim_print(value, (char *)at, REAL_WIDTH);
    memset(at + length, ' ', REAL_WIDTH - length);
}

static void put_time(unsigned char *at, int64_t time_us)
{
    const bool negative = time_us < 0;
    if (negative) {
        *at++ = '-';
    }
    put_whole(at, TIME_WIDTH - negative, negative ? 0 - (uint64_t)time_us : (uint64_t)time_us);
}

awt_status glb_template_begin(const glb_template *t, const awt_pose *head, int64_t time_us, geom_buffer *out,
                              awt_error *error)
{
    out->size = 0;
    awt_status status = geom_buffer_append(out, t->bytes, t->size, error);
    if (status != AWT_OK) {
        return status;
    }
    put_time(out->bytes + t->fields[FIELD_TIME], time_us);
    for (uint32_t k = 0; k < 3; k++) {
        put_real(out->bytes + t->fields[FIELD_POSITION + k], head->position[k]);
    }
    for (uint32_t k = 0; k < 4; k++) {
        put_real(out->bytes + t->fields[FIELD_ORIENTATION + k], head->orientation[k]);
    }
    return AWT_OK;
}

void glb_template_place(const glb_template *t, uint32_t index, const glb_patch *patch, geom_buffer *out)
{
    put_whole(out->bytes + t->fields[patch_field(index, PATCH_OFFSET)], WHOLE_WIDTH, patch->offset);
    put_whole(out->bytes + t->fields[patch_field(index, PATCH_SIZE)], WHOLE_WIDTH, patch->size);
}

void glb_template_patch(const glb_template *t, uint32_t index, const glb_patch *patch, geom_buffer *out)
{
    glb_template_place(t, index, patch, out);
    for (uint32_t k = 0; k < 3 && t->fields[patch_field(index, PATCH_MIN)] != 0; k++) {
        put_real(out->bytes + t->fields[patch_field(index, PATCH_MIN + k)], (double)patch->min[k]);
        put_real(out->bytes + t->fields[patch_field(index, PATCH_MAX + k)], (double)patch->max[k]);
    }
}

void glb_template_end(const glb_template *t, geom_buffer *out)
{
    const size_t binary = out->size - t->size;
    put_whole(out->bytes + t->fields[FIELD_BUFFER], WHOLE_WIDTH, binary);
    put_u32(out->bytes + t->size - GLB_CHUNK_HEADER, (uint32_t)binary);
    put_u32(out->bytes + 8, (uint32_t)out->size);
}

/* ---- keeping */

static size_t take_whole(const unsigned char *at)
{
    size_t value = 0;
    for (uint32_t k = 0; k < WHOLE_WIDTH && at[k] >= '0' && at[k] <= '9'; k++) {
        value = 10 * value + (size_t)(at[k] - '0');
    }
    return value;
}

/* Everything but fields, which are spaces in the template, and lengths. */
bool glb_template_made(const glb_template *t, const geom_buffer *frame)
{
    unsigned wrong = 0;
    if (frame->size < t->size) {
        return false;
    }
    for (size_t i = GLB_HEADER; i < t->size - GLB_CHUNK_HEADER; i++) {
        wrong |= t->bytes[i] != ' ' && t->bytes[i] != frame->bytes[i];
    }
    return !wrong;
}

bool glb_template_keep(const glb_template *t, uint32_t index, const geom_buffer *from, geom_buffer *out,
                       glb_patch *place)
{
    const size_t binary = from->size - t->size;
    place->offset = take_whole(from->bytes + t->fields[patch_field(index, PATCH_OFFSET)]);
    place->size = take_whole(from->bytes + t->fields[patch_field(index, PATCH_SIZE)]);
    for (uint32_t k = PATCH_MIN; k < PATCH_FIELDS; k++) {
        const size_t field = t->fields[patch_field(index, k)];
        memcpy(out->bytes + field, from->bytes + field, field ? REAL_WIDTH : 0);
    }
    return place->offset <= binary && place->size <= binary - place->offset;
}
