/* convert.c: see convert.h. */
#include "convert.h"
#include "base/error.h"

#include <string.h>

awt_pose convert_pose(const proto_pose *pose)
{
    awt_pose out;
    memcpy(out.position, pose->position, sizeof out.position);
    memcpy(out.orientation, pose->orientation, sizeof out.orientation);
    return out;
}

awt_status convert_collider(const struct proto_collider *from, awt_collider *to, awt_error *error)
{
    if (from->frame > AWT_FRAME_OWN) {
        return error_set(error, AWT_BAD_VALUE, "collider %lu has frame %u; 0 is the head, 1 the body, 2 its own",
                         (unsigned long)from->id, (unsigned)from->frame);
    }
    *to = (awt_collider){.id = from->id,
                         .frame = (awt_frame)from->frame,
                         .a = {from->ax, from->ay, from->az},
                         .b = {from->bx, from->by, from->bz},
                         .radius_a = from->radius_a,
                         .radius_b = from->radius_b};
    return AWT_OK;
}

struct proto_collider convert_collider_back(const awt_collider *from)
{
    return (struct proto_collider){.id = from->id,
                                   .frame = (uint8_t)from->frame,
                                   .ax = from->a[0],
                                   .ay = from->a[1],
                                   .az = from->a[2],
                                   .radius_a = from->radius_a,
                                   .bx = from->b[0],
                                   .by = from->b[1],
                                   .bz = from->b[2],
                                   .radius_b = from->radius_b};
}

awt_motion convert_motion(const struct proto_motion *from)
{
    awt_motion motion = {.time_us = from->time_us,
                         .head = convert_pose(&from->head),
                         .body = convert_pose(&from->body),
                         .teleport = from->teleport != 0,
                         .collider_count = from->colliders.count};
    _Static_assert(sizeof from->colliders.items / sizeof from->colliders.items[0] <= AWT_MAX_COLLIDERS,
                   "every collider of the wire has its place");
    for (uint32_t i = 0; i < motion.collider_count; i++) {
        motion.colliders[i].id = from->colliders.items[i].id;
        motion.colliders[i].pose = convert_pose(&from->colliders.items[i].pose);
    }
    return motion;
}

awt_status convert_params(const struct proto_param *from, uint32_t count, awt_params *params, awt_error *error)
{
    awt_params changed = *params;
    for (uint32_t i = 0; i < count; i++) {
        char name[64];
        proto_str_copy(from[i].name, name, sizeof name);
        awt_status status = awt_params_set(&changed, name, from[i].value, error);
        if (status != AWT_OK) {
            return status;
        }
    }
    *params = changed;
    return AWT_OK;
}
