/* awtspace.h: points, directions of strands and turns in the frames of engines, and back.
 *
 *               up   a face looks along   handed   unit    from ours (x, y, z)
 *     ours      +Y   +Z                   right    metre   -                    (glTF's)
 *     Unreal    +Z   +X                   left     cm      100 (z, -x, y)
 *     Unity     +Y   +Z                   left     metre   (-x, y, z)
 *     Godot     +Y   +Z                   right    metre   (x, y, z)            (models look along +Z, as in glTF)
 *
 * A turn's quaternion is x y z w in each; where the hand changes its axis is mirrored and turned the other way. */
#ifndef AWTSPACE_H
#define AWTSPACE_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum awtspace { AWTSPACE_OURS, AWTSPACE_UNREAL, AWTSPACE_UNITY, AWTSPACE_GODOT } awtspace;

/* [count][3], metres, to the engine's unit and axes; `from` and `to` may be the same memory. */
void awtspace_points_to(awtspace space, const float *from, float *to, size_t count);
void awtspace_points_from(awtspace space, const float *from, float *to, size_t count);
/* A pose: position [3] and orientation [4], as proto_pose has them. In place. */
void awtspace_pose_to(awtspace space, double position[3], double orientation[4]);
void awtspace_pose_from(awtspace space, double position[3], double orientation[4]);
/* The engine's units in a metre, for widths and radii. */
float awtspace_units(awtspace space);

#ifdef __cplusplus
}
#endif

#endif
