/* skeleton.h: the HIERARCHY part of a BVH file. Private to motion. */
#ifndef MOTION_SKELETON_H
#define MOTION_SKELETON_H

#include "base/vec.h"
#include "motion/motion.h"
#include "motion/text.h"

enum { SKELETON_MAX_JOINTS = 1024, SKELETON_MAX_CHANNELS = 6, SKELETON_MAX_NAME = 63 };

typedef enum skeleton_channel {
    CHANNEL_X,
    CHANNEL_Y,
    CHANNEL_Z,
    CHANNEL_TURN_X,
    CHANNEL_TURN_Y,
    CHANNEL_TURN_Z
} skeleton_channel;

typedef struct skeleton_joint {
    char name[SKELETON_MAX_NAME + 1]; /* empty: an end site */
    int parent;                       /* -1: a root */
    bool has_offset;
    dvec3 offset; /* from the parent, file units */
    dvec3 bind;   /* where it stands when no channel says anything, file units */
    uint32_t channel_count;
    skeleton_channel channels[SKELETON_MAX_CHANNELS]; /* in the order in which they act */
    uint32_t first_channel;                           /* place of its first number in a row */
} skeleton_joint;

typedef struct skeleton {
    uint32_t joint_count, channel_count;
    skeleton_joint *joints; /* heap; parents before children */
} skeleton;

/* Reads up to and with the word MOTION. `out` is zeroed on entry and may be half filled on failure: skeleton_fini. */
awt_status skeleton_read(text_cursor *text, skeleton *out, awt_error *error);
void skeleton_fini(skeleton *s);

/* The joint of that name, or where `name` is NULL the one that looks like the head. An error lists the joints. */
awt_status skeleton_find(const skeleton *s, const char *name, int *joint, awt_error *error);
/* The `steps`-th ancestor, or the topmost one where there are fewer. */
int skeleton_ancestor(const skeleton *s, int joint, int steps);
/* The longest side of the bind pose's bounding box, file units: about a person's height or span of arms. */
double skeleton_extent(const skeleton *s);

#endif
