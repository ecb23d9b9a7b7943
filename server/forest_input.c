/* forest_input.c: see forest_input.h. */
#include "forest_input.h"
#include "proto.h"

#include <stdlib.h>

uint16_t forest_input_message(forest_input_kind kind)
{
    static const uint16_t messages[] = {
        [FOREST_MOTION] = PROTO_MOTION, [FOREST_PARAMS] = PROTO_SET_PARAMS, [FOREST_QUERY] = PROTO_QUERY,
        [FOREST_LATEST] = PROTO_QUERY,  [FOREST_BINDING] = PROTO_BINDING,   [FOREST_STATE] = PROTO_SNAPSHOT};
    return messages[kind];
}

void forest_inputs_free(forest_input *first)
{
    while (first) {
        forest_input *next = first->next;
        free(first);
        first = next;
    }
}

void forest_motion_absorb(awt_motion *motion, const awt_motion *before)
{
    motion->teleport = motion->teleport || before->teleport;
    for (uint32_t i = 0; i < before->collider_count; i++) {
        uint32_t k = 0;
        while (k < motion->collider_count && motion->colliders[k].id != before->colliders[i].id) {
            k++;
        }
        if (k == motion->collider_count && k < AWT_MAX_COLLIDERS) {
            motion->colliders[motion->collider_count++] = before->colliders[i];
        }
    }
}
