/* convert.h: the wire's records as the library's structs, and back. */
#ifndef CONVERT_H
#define CONVERT_H

#include "awt.h"
#include "proto.h"

awt_pose convert_pose(const proto_pose *pose);

/* AWT_BAD_VALUE: no such frame. */
awt_status convert_collider(const struct proto_collider *from, awt_collider *to, awt_error *error);
struct proto_collider convert_collider_back(const awt_collider *from);

awt_motion convert_motion(const struct proto_motion *from);

/* Sets the parameters by their names; `params` is unchanged unless all are taken. AWT_NO_PARAM, AWT_BAD_VALUE. */
awt_status convert_params(const struct proto_param *from, uint32_t count, awt_params *params, awt_error *error);

#endif
