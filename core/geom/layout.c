/* layout.c: patches, widths, quantisation box and indices of a groom's frames, made once.
 *
 * Patches are whole wisp trees because a tree sleeps as a whole: what does not move need not be encoded again. The
 * quantisation box is fixed for the same reason, and because a box that follows the frame makes resting hair shimmer.
 */
#include "geom/layout.h"

#include "base/assert.h"
#include "base/error.h"
#include "geom/extras.h"
#include "geom/measure.h"
#include "geom/topology.h"
#include "groom/groom.h"

#include <stdlib.h>
#include <string.h>

/* Number, within the level, of the first strand, of guides the wisp itself, of finest wisp `g`. */
static uint32_t first_line(const geom_layout *layout, const awt_groom *groom, uint32_t g)
{
    return layout->kind == GEOM_GUIDES ? g : level_first_strand(&layout->level, groom, g);
}

/* Adds `strands` of a tree to the last patch, or opens a new one where they do not fit. */
static void add_strands(geom_layout *layout, uint32_t tree, uint32_t first_strand, uint32_t strands, uint32_t room)
{
    geom_patch *last = layout->patch_count > 0 ? &layout->patches[layout->patch_count - 1] : NULL;
    if (last && last->strands + strands <= room) {
        last->strands += strands;
        layout->patch_trees[layout->patch_count - 1].last = tree;
        return;
    }
    layout->patch_trees[layout->patch_count] = (layout_trees){tree, tree};
    layout->patches[layout->patch_count++] = (geom_patch){first_strand, strands};
}

static void fill_patches(geom_layout *layout, const awt_groom *groom, uint32_t room)
{
    const uint32_t finest = groom->info.wisp_count[groom->info.levels - 1];
    const uint32_t *tree = groom->gc_tree + groom_finest_first(groom);
    for (uint32_t g = 0; g < finest;) {
        uint32_t after = g + 1;
        while (after < finest && tree[after] == tree[g]) {
            after++;
        }
        uint32_t strand = first_line(layout, groom, g);
        for (uint32_t left = first_line(layout, groom, after) - strand; left > 0;) {
            uint32_t taken = left < room ? left : room;
            add_strands(layout, tree[g], strand, taken, room);
            strand += taken;
            left -= taken;
        }
        g = after;
    }
}

/* Two neighbouring patches hold more than one patch's room, or they would be one. */
static uint32_t patch_bound(uint32_t strands, uint32_t room)
{
    return 2 * (strands / room) + 2;
}

static awt_status check_counts(const awt_groom_info *info, const geom_layout_def *def, awt_error *error)
{
    if (info->strand_count < 1 || info->strand_count > AWT_MAX_STRANDS || info->points_per_strand < 2 ||
        info->points_per_strand > AWT_MAX_POINTS_PER_STRAND) {
        return error_set(error, AWT_LIMIT, "a frame holds 1 to %d strands of 2 to %d points, not %u of %u",
                         AWT_MAX_STRANDS, AWT_MAX_POINTS_PER_STRAND, info->strand_count, info->points_per_strand);
    }
    if (def->kind > GEOM_GUIDES) {
        return error_set(error, AWT_BAD_VALUE, "frames of nodes have no layout");
    }
    if (def->kind == GEOM_GUIDES && (def->bits != 0 || def->stock)) {
        return error_set(error, AWT_BAD_VALUE, "guides have the bits of their binding, and no stock encoder");
    }
    if (def->level > (def->kind == GEOM_GUIDES ? GEOM_LEVEL_FULL : GEOM_LEVEL_GUIDES)) {
        return error_set(error, AWT_BAD_VALUE, "there is no level %d, of guides none but full", (int)def->level);
    }
    if (def->attributes != 0 && (def->stock || def->kind == GEOM_GUIDES || def->attributes > GEOM_ATTRIBUTES_ALL)) {
        return error_set(error, AWT_BAD_VALUE,
                         "attributes are there for ribbons and strands by the own encoder, not %u", def->attributes);
    }
    for (int k = 0; k < 3; k++) {
        if (!(def->colour[k] >= 0 && def->colour[k] <= 1)) {
            return error_set(error, AWT_BAD_VALUE, "a colour's parts are 0 to 1");
        }
    }
    if (def->bits != 0 && (def->bits < GEOM_LEAST_BITS || def->bits > GEOM_GREATEST_BITS)) {
        return error_set(error, AWT_BAD_VALUE, "positions are quantised to %d to %d bits, not %d", GEOM_LEAST_BITS,
                         GEOM_GREATEST_BITS, def->bits);
    }
    return AWT_OK;
}

/* Widths and the box around them. A line has its width in extras only. */
static void fill_shape(geom_layout *layout, const awt_groom_info *info, int bits)
{
    const bool ribbon = layout->kind == GEOM_RIBBON;
    const float growth = ribbon || layout->kind == GEOM_STRANDS ? level_growth(&layout->level) : 1;
    layout->box = measure_box(info, ribbon ? measure_middle(info, growth) : 0, bits);
    if (layout->half_width) {
        float least = ribbon ? 0.5f * MEASURE_LEAST_STEPS * draco_box_step(&layout->box) : 0;
        measure_half_widths(info, growth, least, layout->half_width);
    }
    layout->shape = (ribbon_shape){.points_per_strand = layout->points_per_strand, .half_width = layout->half_width};
    for (int k = 0; k < 3; k++) {
        layout->shape.point_min[k] = info->box_min[k];
        layout->shape.point_max[k] = info->box_max[k];
        layout->bounds.least[k] = ribbon ? layout->box.origin[k] : info->box_min[k];
        layout->bounds.greatest[k] = ribbon ? layout->box.origin[k] + layout->box.range : info->box_max[k];
    }
}

/* Lines, and what says them: strands with their widths, or wisps with their binding. */
static awt_status take_lines(geom_layout *layout, const awt_groom *groom, const geom_layout_def *def, awt_error *error)
{
    const awt_groom_info *info = &groom->info;
    const int usual = def->kind == GEOM_RIBBON ? GEOM_RIBBON_BITS : GEOM_STRANDS_BITS;
    if (def->kind == GEOM_GUIDES) {
        awt_status status = binding_of_groom(groom, &layout->binding, error);
        if (status == AWT_OK) {
            free(layout->binding->packed); /* the largest of it, and of no use here */
            layout->binding->packed = NULL;
            layout->attributes.form = DRACO_POSITIONS_TURNS;
            layout->attributes.turn_bits = (int)layout->binding->turn_bits;
            layout->strands = layout->binding->wisps;
            layout->points_per_strand = layout->binding->sections;
            fill_shape(layout, info, (int)layout->binding->position_bits);
        }
        return status;
    }
    awt_status status = level_strands_make(groom, def->level, &layout->level, error);
    if (status != AWT_OK) {
        return status;
    }
    layout->strands = layout->level.strands;
    layout->points_per_strand = info->points_per_strand;
    layout->half_width = calloc(info->points_per_strand, sizeof *layout->half_width);
    if (!layout->half_width) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    fill_shape(layout, info, def->bits ? def->bits : usual);
    return AWT_OK;
}

static bool make_arrays(geom_layout *layout, const awt_groom *groom)
{
    const uint32_t per_strand = layout->points_per_strand, room = GEOM_PATCH_POINTS / per_strand;
    const uint32_t bound = patch_bound(layout->strands, room);
    layout->patches = calloc(bound, sizeof *layout->patches);
    layout->patch_trees = calloc(bound, sizeof *layout->patch_trees);
    if (!layout->patches || !layout->patch_trees) {
        return false;
    }
    fill_patches(layout, groom, room);
    ASSERT(layout->patch_count <= bound);
    for (uint32_t i = 0; i < layout->patch_count; i++) {
        uint32_t strands = layout->patches[i].strands;
        layout->largest_patch = strands > layout->largest_patch ? strands : layout->largest_patch;
    }
    const uint32_t triangles = topology_triangles(layout->kind, layout->largest_patch, per_strand);
    layout->indices = calloc(triangles, 3 * sizeof *layout->indices);
    layout->meshes = calloc(layout->patch_count, sizeof *layout->meshes);
    if (!layout->indices || !layout->meshes) {
        return false;
    }
    topology_indices(layout->kind, layout->largest_patch, per_strand, layout->indices);
    return true;
}

static awt_status make_meshes(geom_layout *layout, awt_error *error)
{
    awt_status status = AWT_OK;
    for (uint32_t i = 0; i < layout->patch_count && status == AWT_OK; i++) {
        const geom_patch *patch = &layout->patches[i];
        status = draco_mesh_make(layout_patch_vertices(layout, patch), layout->indices,
                                 topology_triangles(layout->kind, patch->strands, layout->points_per_strand),
                                 &layout->attributes, &layout->meshes[i], error);
    }
    return status;
}

static awt_status make_template(geom_layout *layout, awt_error *error)
{
    glb_frame frame = {.kind = layout->kind,
                       .level = layout->level.level,
                       .strands = layout->strands,
                       .points_per_strand = layout->points_per_strand,
                       .full_strands = layout->level.full_strands,
                       .attributes = layout->attributes,
                       .extra = layout->extra,
                       .colour = {layout->colour[0], layout->colour[1], layout->colour[2]},
                       .binding = layout->binding ? layout->binding->id : 0,
                       .patches = calloc(layout->patch_count, sizeof *frame.patches),
                       .patch_count = layout->patch_count,
                       .widths = layout->half_width ? calloc(layout->points_per_strand, sizeof *frame.widths) : NULL};
    awt_status status = AWT_NO_MEMORY;
    if (frame.patches && (frame.widths || !layout->half_width)) {
        for (uint32_t i = 0; i < layout->patch_count; i++) {
            frame.patches[i] = (glb_patch){.first_strand = layout->patches[i].first_strand,
                                           .strands = layout->patches[i].strands,
                                           .vertices = layout->meshes[i].vertices,
                                           .triangles = layout->meshes[i].triangles};
        }
        for (uint32_t i = 0; frame.widths && i < layout->points_per_strand; i++) {
            frame.widths[i] = 2 * layout->half_width[i];
        }
        status = glb_template_make(&frame, &layout->frame, error);
    } else {
        error_set(error, AWT_NO_MEMORY, NULL);
    }
    free(frame.patches);
    free(frame.widths);
    return status;
}

static bool is_coloured(const float *colour)
{
    return colour[0] > 0 || colour[1] > 0 || colour[2] > 0;
}

awt_status geom_layout_create(const awt_groom *groom, const geom_layout_def *def, geom_layout **out, awt_error *error)
{
    static const geom_layout_def usual = {.kind = GEOM_RIBBON};
    static const float brown[3] = {0.13f, 0.07f, 0.035f};
    const awt_groom_info *info = &groom->info;
    def = def ? def : &usual;
    *out = NULL;
    awt_status status = check_counts(info, def, error);
    if (status != AWT_OK) {
        return status;
    }
    geom_layout *layout = calloc(1, sizeof *layout);
    if (!layout) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    layout->kind = def->kind;
    layout->stock = def->stock;
    layout->extra = def->attributes;
    const float *named = is_coloured(def->colour) ? def->colour : info->colour;
    memcpy(layout->colour, is_coloured(named) ? named : brown, sizeof layout->colour);
    status = take_lines(layout, groom, def, error);
    if (status == AWT_OK && !make_arrays(layout, groom)) {
        status = error_set(error, AWT_NO_MEMORY, NULL);
    }
    status = status == AWT_OK ? make_meshes(layout, error) : status;
    status = status == AWT_OK && layout->extra ? extras_add(layout, groom, layout->extra, error) : status;
    status = status == AWT_OK ? make_template(layout, error) : status;
    if (status != AWT_OK) {
        geom_layout_destroy(layout);
        return status;
    }
    *out = layout;
    return AWT_OK;
}

void geom_layout_destroy(geom_layout *layout)
{
    if (layout) {
        for (uint32_t i = 0; layout->meshes && i < layout->patch_count; i++) {
            draco_mesh_fini(&layout->meshes[i]);
        }
        glb_template_fini(&layout->frame);
        geom_binding_destroy(layout->binding);
        level_strands_fini(&layout->level);
        free(layout->meshes);
        free(layout->half_width);
        free(layout->patches);
        free(layout->patch_trees);
        free(layout->indices);
        free(layout);
    }
}

uint32_t geom_layout_patches(const geom_layout *layout)
{
    return layout->patch_count;
}

geom_patch geom_layout_patch(const geom_layout *layout, uint32_t index)
{
    return layout->patches[index];
}

void geom_layout_unchanged(const geom_layout *layout, const bool *moved, bool *unchanged)
{
    for (uint32_t i = 0; i < layout->patch_count; i++) {
        unchanged[i] = true;
        for (uint32_t t = layout->patch_trees[i].first; t <= layout->patch_trees[i].last; t++) {
            unchanged[i] = unchanged[i] && !moved[t];
        }
    }
}

uint32_t geom_layout_strands(const geom_layout *layout)
{
    return layout->strands;
}

uint32_t geom_layout_strand(const geom_layout *layout, uint32_t index)
{
    return layout->level.number ? layout->level.number[index] : index;
}

void geom_layout_evaluate(const geom_layout *layout, const awt_groom *groom, const bool *wisps, const float *centres,
                          const float *frames, float *scratch, float *points)
{
    level_evaluate(&layout->level, groom, wisps, centres, frames, scratch, points);
}
