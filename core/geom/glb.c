/* glb.c: see glb.h. The container first (lengths against what is there), then the JSON (every index and count against
 * what they index and count), the geometry itself never: that is draco_shim.h's. */
#include "geom/glb.h"

#include "base/error.h"
#include "geom/draco_extra.h"
#include "geom/glb_container.h"
#include "geom/topology.h"

#include <stdlib.h>

enum { GLB_TRIANGLES = 4, GLB_I16 = 5122, GLB_U16 = 5123, GLB_F32 = 5126 };
#define GLB_MAX_WIDTH 1e6 /* metres; that it fits a float */

/* ---- JSON */

/* An array's items by index. */
typedef struct glb_items {
    uint32_t *tokens; /* [count], heap */
    uint32_t count;
} glb_items;

typedef struct glb_reader {
    json_document json;
    glb_items accessors, views;
    size_t binary_size;
} glb_reader;

static bool index_items(const json_document *json, uint32_t array, glb_items *out)
{
    out->count = json_items(json, array);
    out->tokens = calloc(out->count ? out->count : 1, sizeof *out->tokens);
    if (!out->tokens) {
        return false;
    }
    uint32_t at = array + 1;
    for (uint32_t i = 0; i < out->count; i++, at = json->tokens[at].after) {
        out->tokens[i] = at;
    }
    return true;
}

/* The item that a member names by its index. */
static uint32_t item_of(const glb_reader *r, const glb_items *items, uint32_t object, const char *member)
{
    uint32_t index;
    bool there = json_whole(&r->json, json_member(&r->json, object, member), &index) && index < items->count;
    return there ? items->tokens[index] : JSON_NONE;
}

static bool whole_member(const glb_reader *r, uint32_t object, const char *member, uint32_t *out)
{
    return json_whole(&r->json, json_member(&r->json, object, member), out);
}

static bool whole_member_is(const glb_reader *r, uint32_t object, const char *member, uint32_t expected)
{
    uint32_t value;
    return whole_member(r, object, member, &value) && value == expected;
}

static bool read_kind(const glb_reader *r, uint32_t extras, glb_frame *out)
{
    uint32_t kind = json_member(&r->json, extras, "kind");
    for (int k = GEOM_RIBBON; k <= GEOM_GUIDES; k++) {
        out->kind = (geom_kind)k;
        if (json_is_text(&r->json, kind, glb_words_of(out->kind).kind)) {
            return true;
        }
    }
    return false;
}

/* Which binding guides belong to. */
static bool read_binding(const glb_reader *r, uint32_t extras, glb_frame *out)
{
    uint32_t bits;
    if (!json_hexadecimal(&r->json, json_member(&r->json, extras, "binding"), &out->binding) ||
        !whole_member(r, extras, "turn_bits", &bits) || bits < 2 || bits > DRACO_MAX_TURN_BITS) {
        return false;
    }
    out->attributes.form = DRACO_POSITIONS_TURNS;
    out->attributes.turn_bits = (int)bits;
    return true;
}

/* Which strands of the hair these are. */
static bool read_level(const glb_reader *r, uint32_t extras, glb_frame *out)
{
    const uint32_t level = json_member(&r->json, extras, "level");
    bool known = false;
    for (int k = GEOM_LEVEL_FULL; k <= GEOM_LEVEL_GUIDES && !known; k++) {
        out->level = (geom_level)k;
        known = json_is_text(&r->json, level, glb_level_name(out->level));
    }
    return known && whole_member(r, extras, "full_strands", &out->full_strands) &&
           out->full_strands <= AWT_MAX_STRANDS && out->strands <= out->full_strands &&
           (out->level != GEOM_LEVEL_FULL || out->strands == out->full_strands);
}

/* Strands first, for the counts of everything else follow from them. */
static bool read_counts(const glb_reader *r, uint32_t extras, glb_frame *out)
{
    if (!read_kind(r, extras, out) || (out->kind == GEOM_GUIDES && !read_binding(r, extras, out))) {
        return false;
    }
    const glb_words words = glb_words_of(out->kind);
    return whole_member(r, extras, words.lines, &out->strands) &&
           whole_member(r, extras, words.points, &out->points_per_strand) && out->strands >= 1 &&
           out->strands <= AWT_MAX_STRANDS && out->points_per_strand >= 2 &&
           out->points_per_strand <= AWT_MAX_POINTS_PER_STRAND &&
           (uint64_t)out->strands * out->points_per_strand <= AWT_MAX_POINTS &&
           (out->kind == GEOM_GUIDES || read_level(r, extras, out));
}

/* False: they are missing, or no widths. */
static bool read_widths(const glb_reader *r, uint32_t extras, glb_frame *out)
{
    double widths[AWT_MAX_POINTS_PER_STRAND];
    if (!json_reals(&r->json, json_member(&r->json, extras, "widths"), out->points_per_strand, widths)) {
        return false;
    }
    bool sound = true;
    for (uint32_t i = 0; i < out->points_per_strand; i++) {
        sound = sound && widths[i] >= 0 && widths[i] < GLB_MAX_WIDTH;
        out->widths[i] = sound ? (float)widths[i] : 0;
    }
    return sound;
}

static bool read_data_place(const glb_reader *r, uint32_t draco, glb_patch *patch)
{
    uint32_t view = item_of(r, &r->views, draco, "bufferView");
    uint32_t offset = 0, size = 0;
    uint32_t offset_member = json_member(&r->json, view, "byteOffset");
    if (!whole_member_is(r, view, "buffer", 0) || !whole_member(r, view, "byteLength", &size) ||
        (offset_member != JSON_NONE && !json_whole(&r->json, offset_member, &offset)) || offset > r->binary_size ||
        size > r->binary_size - offset) {
        return false;
    }
    patch->offset = offset;
    patch->size = size;
    return true;
}

static bool accessor_is(const glb_reader *r, uint32_t accessor, const char *type, uint32_t component, uint32_t count)
{
    return json_is_text(&r->json, json_member(&r->json, accessor, "type"), type) &&
           whole_member_is(r, accessor, "componentType", component) && whole_member_is(r, accessor, "count", count);
}

/* Attribute number `id` of the Draco data, called `name` in the JSON. */
static bool read_attribute(const glb_reader *r, uint32_t attributes, uint32_t ids, const char *name, uint32_t id,
                           uint32_t component, uint32_t vertices)
{
    return whole_member_is(r, ids, name, id) &&
           accessor_is(r, item_of(r, &r->accessors, attributes, name), "VEC3", component, vertices);
}

static bool read_attributes(const glb_reader *r, uint32_t attributes, uint32_t ids, draco_form form, uint32_t vertices)
{
    return read_attribute(r, attributes, ids, "POSITION", 0, GLB_F32, vertices) &&
           (form == DRACO_POSITIONS || read_attribute(r, attributes, ids, "_TURN", 1, GLB_I16, vertices));
}

/* Which extra attributes a patch has, all of them as ours are. False: one is not. */
static bool read_extra(const glb_reader *r, uint32_t attributes, uint32_t ids, uint32_t vertices, uint32_t *extra)
{
    *extra = 0;
    for (uint32_t i = 0; i < DRACO_EXTRAS; i++) {
        const draco_extra_form *form = draco_extra_at(i);
        if (json_member(&r->json, ids, form->name) == JSON_NONE) {
            continue;
        }
        *extra |= form->attribute;
        if (!whole_member_is(r, ids, form->name, i + 1) ||
            !accessor_is(r, item_of(r, &r->accessors, attributes, form->name),
                         form->components == 2 ? "VEC2" : "SCALAR", form->quantised ? GLB_F32 : GLB_U16, vertices)) {
            return false;
        }
    }
    return true;
}

/* One primitive, whose strands must begin with number `first`. */
static bool read_patch(const glb_reader *r, uint32_t primitive, const glb_frame *frame, uint32_t first,
                       glb_patch *patch)
{
    const json_document *json = &r->json;
    const uint32_t a_point = topology_vertices_a_point(frame->kind);
    const glb_words words = glb_words_of(frame->kind);
    uint32_t extras = json_member(json, primitive, "extras");
    if (!whole_member_is(r, extras, words.first, first) || !whole_member(r, extras, words.lines, &patch->strands) ||
        patch->strands < 1 || patch->strands > frame->strands - first ||
        patch->strands > GEOM_MAX_PATCH_VERTICES / (a_point * frame->points_per_strand)) {
        return false;
    }
    patch->first_strand = first;
    patch->vertices = patch->strands * frame->points_per_strand * a_point;
    patch->triangles = topology_triangles(frame->kind, patch->strands, frame->points_per_strand);
    uint32_t draco = json_member(json, json_member(json, primitive, "extensions"), "KHR_draco_mesh_compression");
    uint32_t attributes = json_member(json, primitive, "attributes");
    return whole_member_is(r, primitive, "mode", GLB_TRIANGLES) && read_data_place(r, draco, patch) &&
           read_attributes(r, attributes, json_member(json, draco, "attributes"), frame->attributes.form,
                           patch->vertices) &&
           (frame->kind == GEOM_GUIDES ||
            read_extra(r, attributes, json_member(json, draco, "attributes"), patch->vertices, &patch->extra)) &&
           accessor_is(r, item_of(r, &r->accessors, primitive, "indices"), "SCALAR", GLB_U16, patch->triangles * 3) &&
           /* as libdraco does: no memory for triangles that the data cannot hold */
           patch->triangles <= patch->size / 3;
}

static bool read_patches(const glb_reader *r, uint32_t primitives, glb_frame *out)
{
    uint32_t at = primitives + 1, strand = 0;
    for (uint32_t i = 0; i < out->patch_count; i++, at = r->json.tokens[at].after) {
        if (!read_patch(r, at, out, strand, &out->patches[i])) {
            return false;
        }
        strand += out->patches[i].strands;
        out->extra = out->patches[0].extra;
        if (out->patches[i].extra != out->extra) {
            return false;
        }
    }
    return strand == out->strands;
}

/* The one node, mesh and buffer that a frame of ours has. */
static awt_status read_frame(glb_reader *r, glb_frame *out, awt_error *error)
{
    const json_document *json = &r->json;
    uint32_t node = json_member(json, 0, "nodes"), mesh = json_member(json, 0, "meshes");
    uint32_t buffer = json_member(json, 0, "buffers");
    uint32_t buffer_size;
    if (!json_is_text(json, json_member(json, json_member(json, 0, "asset"), "version"), "2.0") ||
        json_items(json, node) != 1 || json_items(json, mesh) != 1 || json_items(json, buffer) != 1 ||
        !json_is_text(json, json_member(json, node + 1, "name"), "hair") ||
        !whole_member(r, buffer + 1, "byteLength", &buffer_size) || buffer_size > r->binary_size) {
        return error_set(error, AWT_BAD_FORMAT,
                         "this GLB is not a frame of awtd: it must have one node named \"hair\"");
    }
    r->binary_size = buffer_size;
    uint32_t extras = json_member(json, node + 1, "extras");
    if (!glb_read_pose(json, node + 1, &out->head) || !glb_read_time(json, &out->time_us) ||
        !read_counts(r, extras, out)) {
        return error_set(error, AWT_BAD_VALUE,
                         "the frame's head pose, time, kind or strand counts are missing or impossible");
    }
    out->widths = calloc(out->points_per_strand, sizeof *out->widths);
    if (!out->widths) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    if (out->kind != GEOM_GUIDES && !read_widths(r, extras, out)) {
        return error_set(error, AWT_BAD_VALUE, "the frame's widths are missing or impossible");
    }
    uint32_t primitives = json_member(json, mesh + 1, "primitives");
    out->patch_count = json_items(json, primitives);
    if (out->patch_count < 1 || out->patch_count > out->strands) {
        return error_set(error, AWT_BAD_FORMAT, "the frame has %u patches for %u strands", out->patch_count,
                         out->strands);
    }
    out->patches = calloc(out->patch_count, sizeof *out->patches);
    if (!out->patches || !index_items(json, json_member(json, 0, "accessors"), &r->accessors) ||
        !index_items(json, json_member(json, 0, "bufferViews"), &r->views)) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    if (!read_patches(r, primitives, out)) {
        return error_set(error, AWT_BAD_FORMAT, "a patch of the frame does not fit its strands or its data");
    }
    return AWT_OK;
}

awt_status glb_read(const void *bytes, size_t size, glb_frame *out, awt_error *error)
{
    glb_chunk text = {0}, binary = {0};
    glb_reader reader = {0};
    *out = (glb_frame){0};
    awt_status status = glb_container_take(bytes, size, &text, &binary, error);
    if (status != AWT_OK) {
        return status;
    }
    reader.binary_size = binary.size;
    status = json_read((const char *)text.bytes, text.size, &reader.json, error);
    if (status == AWT_OK) {
        status = read_frame(&reader, out, error);
    }
    json_fini(&reader.json);
    free(reader.accessors.tokens);
    free(reader.views.tokens);
    if (status != AWT_OK) {
        glb_frame_fini(out);
        return status;
    }
    out->binary = binary.bytes;
    out->binary_size = binary.size;
    return AWT_OK;
}

void glb_frame_fini(glb_frame *frame)
{
    free(frame->patches);
    free(frame->widths);
    *frame = (glb_frame){0};
}
