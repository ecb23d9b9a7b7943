/* recipe.c: see recipe.h. */
#include "recipe.h"
#include "convert.h"
#include "base/error.h"

#include <stdlib.h>
#include <string.h>

#define STIFFNESS "style_omega"

static awt_status take_source(const struct proto_create *message, upload *file, recipe *r, awt_error *error)
{
    if (message->source == RECIPE_FROM_STYLE) {
        char name[RECIPE_NAME];
        proto_str_copy(message->style, name, sizeof name);
        r->style = awt_style_find(name);
        if (!r->style) {
            return error_set(error, AWT_NO_STYLE, NULL);
        }
        r->seed = message->seed;
        r->strands = message->strands ? message->strands : AWT_DEFAULT_STRANDS;
        r->groom = awt_groom_def_of_style(r->style);
        r->params = r->style->params;
        r->placement = (awt_placement){
            .scale = 1, .up = AWT_UP_Y, .head_radius = AWT_HEAD_RADIUS_M, .head_radius_m = AWT_HEAD_RADIUS_M};
        return AWT_OK;
    }
    if (message->up > AWT_UP_Z) {
        return error_set(error, AWT_BAD_VALUE, "up is %u; 0 guesses, 1 is Y, 2 is Z", (unsigned)message->up);
    }
    r->file = upload_hold(file);
    r->groom = awt_groom_def_default();
    r->params = awt_params_default();
    r->placement = (awt_placement){.scale = message->scale,
                                   .up = (awt_up_axis)message->up,
                                   .head_centre = {message->head_x, message->head_y, message->head_z},
                                   .head_radius = message->head_radius};
    return AWT_OK;
}

/* A field that is 0 leaves what the style or the default says. */
static awt_status take_groom(const struct proto_create *message, upload *hierarchy, recipe *r, awt_error *error)
{
    awt_groom_def *groom = &r->groom;
    if (hierarchy && (message->levels || message->finest_wisps || message->top_wisps)) {
        return error_set(error, AWT_BAD_VALUE,
                         "levels, finest_wisps and top_wisps are the hierarchy's: with own_hierarchy they are 0");
    }
    r->hierarchy = hierarchy ? upload_hold(hierarchy) : NULL;
    groom->levels = message->levels ? message->levels : groom->levels;
    groom->sections = message->sections ? message->sections : groom->sections;
    groom->finest_wisps = message->finest_wisps ? message->finest_wisps : groom->finest_wisps;
    groom->top_wisps = message->top_wisps ? message->top_wisps : groom->top_wisps;
    groom->points_per_strand = message->points_per_strand ? message->points_per_strand : groom->points_per_strand;
    return AWT_OK;
}

static awt_status take_colliders(const struct proto_create *message, recipe *r, awt_error *error)
{
    r->own_colliders = message->own_colliders != 0;
    if (!r->own_colliders) {
        return AWT_OK;
    }
    r->collider_count = message->colliders.count;
    for (uint32_t i = 0; i < r->collider_count; i++) {
        awt_status status = convert_collider(&message->colliders.items[i], &r->colliders[i], error);
        if (status != AWT_OK) {
            return status;
        }
    }
    return AWT_OK;
}

awt_status recipe_create(const struct proto_create *message, upload *file, upload *hierarchy, recipe **out,
                         awt_error *error)
{
    *out = NULL;
    recipe *r = calloc(1, sizeof *r);
    if (!r) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    awt_status status = take_source(message, file, r, error);
    if (status == AWT_OK) {
        status = take_groom(message, hierarchy, r, error);
    }
    if (status == AWT_OK) {
        status = convert_params(message->params.items, message->params.count, &r->params, error);
    }
    for (uint16_t i = 0; i < message->params.count; i++) {
        proto_str name = message->params.items[i].name;
        r->own_stiffness =
            r->own_stiffness || (name.length == sizeof STIFFNESS - 1 && memcmp(name.text, STIFFNESS, name.length) == 0);
    }
    if (status == AWT_OK) {
        status = take_colliders(message, r, error);
    }
    if (status != AWT_OK) {
        recipe_destroy(r);
        return status;
    }
    proto_str_copy(message->name.length || !r->style ? message->name : proto_str_of(r->style->name), r->name,
                   sizeof r->name);
    r->tells = message->progress != 0;
    r->start = (awt_motion){
        .time_us = message->time_us, .head = convert_pose(&message->head), .body = convert_pose(&message->body)};
    *out = r;
    return AWT_OK;
}

awt_status recipe_restore(upload *state, size_t offset, proto_str name, recipe **out, awt_error *error)
{
    recipe *r = calloc(1, sizeof *r);
    *out = r;
    if (!r) {
        return error_set(error, AWT_NO_MEMORY, NULL);
    }
    r->state = upload_hold(state);
    r->state_offset = offset;
    r->placement = (awt_placement){.up = AWT_UP_Y, .scale = 1};
    proto_str_copy(name, r->name, sizeof r->name);
    return AWT_OK;
}

awt_status recipe_check_files(const recipe *r, awt_error *error)
{
    upload *const files[] = {r->file, r->hierarchy, r->state};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        if (files[i] && !upload_matches(files[i])) {
            return error_set(error, AWT_BAD_FORMAT, "upload %lu does not match its SHA-256: send it anew",
                             (unsigned long)files[i]->number);
        }
    }
    return AWT_OK;
}

awt_status recipe_check_points(const recipe *r, uint64_t strands, uint64_t points_per_strand, awt_error *error)
{
    if (strands * points_per_strand <= r->greatest_points) { /* both of 32 bits */
        return AWT_OK;
    }
    return error_set(error, AWT_LIMIT, "the hair has %llu strands of %llu points; this token may have %llu points",
                     (unsigned long long)strands, (unsigned long long)points_per_strand,
                     (unsigned long long)r->greatest_points);
}

void recipe_destroy(recipe *made)
{
    if (made) {
        upload_release(made->file);
        upload_release(made->hierarchy);
        upload_release(made->state);
        free(made);
    }
}
