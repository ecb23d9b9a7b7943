/* head_pose.c: see head_pose.h. */
#include "geom/head_pose.h"

#include "base/error.h"

#include <math.h>

awt_status head_pose_take(const awt_pose *head, awt_pose *out, awt_error *error)
{
    double square = 0;
    for (int k = 0; k < 4; k++) {
        square += head->orientation[k] * head->orientation[k];
    }
    double length = sqrt(square);
    if (!isfinite(head->position[0]) || !isfinite(head->position[1]) || !isfinite(head->position[2]) ||
        !(fabs(length - 1.0) <= 1e-3)) {
        return error_set(error, AWT_BAD_VALUE, "the head's pose is not finite, or its orientation is not of length 1");
    }
    *out = *head;
    for (int k = 0; k < 4; k++) {
        out->orientation[k] = head->orientation[k] / length;
    }
    return AWT_OK;
}
