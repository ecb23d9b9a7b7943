/* head_pose.h: a head's pose on its way into a glTF node. */
#ifndef GEOM_HEAD_POSE_H
#define GEOM_HEAD_POSE_H

#include "awt.h"

/* The pose with a rotation of length 1 to the last bits, which glTF wants. AWT_BAD_VALUE. */
awt_status head_pose_take(const awt_pose *head, awt_pose *out, awt_error *error);

#endif
