/* touch.h: which of the pairs that the grid finds are in contact, and where (AWT §4.1). */
#ifndef SIM_TOUCH_H
#define SIM_TOUCH_H

#include "sim/state.h"

/* An active segment (§4.1): the cylinder from parent to child. */
struct segment {
    vec3 from;
    float radius;
    vec3 along; /* to the child */
    float mass; /* the child's */
};

/* Slots of its two nodes. */
struct segment_ends {
    uint32_t child, parent;
};

/* An active node as contacts see it: its velocity relative to the turning head; a root is carried, and nothing moves
 * it: its inverse mass is 0. */
struct contact_node {
    vec3 velocity;
    float inverse_mass;
};

/* Two segments in contact; P = (1 - on) * N_parent + on * N_child on each axis, eq. (3). */
struct wisp_contact {
    segment_ends of[2];
    float on[2];
    float mass;    /* the smaller child's */
    vec3 velocity; /* of the second's point against the first's, as far as it counts: friction pulls the first along it
                    */
    vec3 overlap;  /* by which the first is to be pushed away from the second; zero: no repulsion */
};

/* What decides over a contact. */
typedef struct touch_rule {
    float least_speed2; /* relative motion below is none */
    float cosine2;      /* of the angle above which segments repel each other */
} touch_rule;

/* Writes the contacts among at most GRID_PAIRS pairs of f->segments, in their order, to `out` (room for `count`);
 * returns how many. */
uint32_t touch_find(const awt_forest *f, const touch_rule *rule, const grid_pair *pairs, uint32_t count,
                    wisp_contact *out);

#endif
