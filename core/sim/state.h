/* state.h: the moving state of one head of hair, and nothing that acts on it.
 *
 * Positions are relative to the head's centre, along the world's axes; velocities and accelerations are those of this
 * moving frame, and the frame's own change of velocity enters as an inertial force (dynamics.c). The numbers
 * that floats hold are therefore never larger than the hair is long, 100 km from zero and in a moving car alike,
 * and nothing ever needs to be rebased. (CONTRACT.md asks for an origin on a grid that follows the head by
 * rebasing; a frame that rides on the head meets the same promises with no event at all.)
 *
 * Node (g, i) has index g * sections + i, as in the groom. Which arrays are meaningful for which nodes: active nodes
 * have position, velocity, acceleration, agitation, radius, link and reference; nodes below an active one have an
 * offset; finest nodes have a frame always. */
#ifndef SIM_STATE_H
#define SIM_STATE_H

#include "base/arena.h"
#include "base/sym3.h"
#include "groom/groom.h"
#include "sim/grid.h"
#include "sim/track.h"
#include "sim/wind.h"

/* One AWT (§2.3): the active nodes of a top-level GC, in the slots first .. first + count - 1 of the active
 * arrays, by cross-section, so that parents come before children. Slot `first` is the root. */
typedef struct tree {
    uint32_t first, count;
    bool asleep;       /* nothing of it moves relative to the head (rest.c) */
    bool loose;        /* offsets, frames or radii are not what the groom's rest shape makes them (embed.c) */
    float quiet_s;     /* for so long it has hardly moved */
    float unrelaxed_s; /* for so long its offsets have not relaxed */
    uint64_t moved;    /* number of the sub-step that last moved anything of it in the head frame; no state: 0 anew */
} tree;

/* parent_node of a node that is not active: whatever parent it gets is a new one. */
#define STATE_NO_PARENT UINT32_MAX

/* Where an obstacle is in this sub-step, relative to the head's centre, and how it moves there. */
typedef struct obstacle {
    vec3 a, b;
    float radius_a, radius_b;
    vec3 middle;         /* of a sphere that holds all of it */
    float reach;         /* that sphere's radius */
    vec3 velocity, spin; /* of its frame; at the frame's origin */
    vec3 origin;
    vec3 rest_a, rest_b; /* at rest, head frame: no node is held farther out than it rests (obstacle.c) */
    bool rests;          /* false: a frame of its own, which has no rest place */
} obstacle;

typedef struct segment segment; /* touch.h */
typedef struct segment_ends segment_ends;
typedef struct wisp_contact wisp_contact;

struct awt_forest {
    const awt_groom *groom;
    arena memory;
    awt_params params;
    int64_t time_us;
    uint64_t sub_steps; /* since it was made or restored; no state */
    uint32_t collider_count;
    awt_collider colliders[AWT_MAX_COLLIDERS];
    track track;

    /* the moving frame */
    track_pose pose[TRACK_COUNT]; /* at time_us */
    mat3 head;                    /* head frame to world axes */
    vec3 head_spin;               /* rad/s, world axes */
    dvec3 frame_velocity;         /* of the head's centre during the last sub-step */
    vec3 frame_acceleration;
    wind_field wind; /* in this sub-step */
    obstacle obstacles[AWT_MAX_COLLIDERS];
    dquat still_orientation; /* of the head, when the world was last not still (rest.c) */
    float still_s;           /* for so long the world has been still */

    /* the AWTs; per GC, [gc_count] */
    uint32_t *first_split; /* node (g, i) is active iff first_split[super(g)] <= i < first_split[g] */
    int64_t *event_us;     /* time of the last split or merge of this GC */
    uint32_t split_from;   /* tree that is asked first for splits in the next step (adapt.c) */

    /* per node, [gc_count * sections] */
    vec3 *position, *velocity;
    vec3 *acceleration; /* in the world, filtered */
    float *agitation;   /* m/s2: what contacts and air do to it, weighted, filtered alike; 0 with no weights */
    float *radius;
    float *link_length;    /* this step's target */
    uint32_t *parent_node; /* of the AWT; a root's: itself; STATE_NO_PARENT where not active */
    vec3 *reference;       /* head frame: direction of its chord at which the offsets below it were taken */
    vec3 *offset;          /* head frame: from the super-node, when the chord had its reference direction */
    quat *frame;           /* finest nodes [finest_nodes]: section frame to head frame, at the reference direction */

    /* active nodes, by slot; made by tree_rebuild */
    tree *trees;                           /* [wisp_count[0]] */
    uint32_t *active_node, *active_parent; /* node; slot */
    float *active_mass;                    /* strands it stands for: its mass in mass units */
    vec3 *active_rest_tangent;             /* head frame */
    uint32_t *active_chord;                /* slot where the chord begins that shows how the wisp lies here (embed.c) */
    vec3 *active_rest_chord;               /* head frame: its direction at rest */
    float *active_turn_share;              /* of the chord's turn that the section takes; the head's turn is the rest */
    vec3 *active_style;                    /* head frame: from its parent to where the style spring holds it */
    vec3 *active_preload;                  /* head frame, m/s2: what of gravity the style carries at rest */
    float *active_stiffness;               /* of the style spring, times style_omega^2; in mass units */
    float *active_hung_mass;               /* of the node and all below it; in mass units */
    float *active_rest_length;
    float *active_lead;     /* links.c */
    uint32_t *slot_of_node; /* [nodes]; of active nodes */

    /* working memory of a step, by slot */
    vec3 *next;      /* position at the end of the step */
    mat3 *turn;      /* of the segment, from rest in the head frame to now in the world */
    vec3 *tangent;   /* of the segment, world axes */
    bool *touching;  /* an obstacle gave it its velocity */
    sym3 *link_mass; /* links.c */
    vec3 *link_push, *link_carry;
    float *link_gain, *link_gap;
    sym3 *joint_mass; /* joint.c */
    mat3 *joint_up, *joint_far;
    vec3 *joint_push;

    /* contact.c */
    vec3 *active_push;                  /* by slot: change of velocity by contacts in this sub-step */
    struct contact_node *contact_nodes; /* by slot (touch.h) */
    float *contact_load;                /* by slot */
    segment *segments;                  /* [slots]; of this sub-step, the moving ones first (touch.h) */
    segment_ends *ends;                 /* [slots]; of the same segments */
    grid_box *segment_box;              /* [slots] */
    wisp_contact *contacts;             /* pairs in contact in this sub-step (touch.h) */
    uint32_t contact_capacity;
    uint32_t contacts_left_out; /* in this sub-step: those beyond contact_capacity, which had no effect */
    grid grid;
};

static inline vec3 state_to_head(const awt_forest *f, vec3 v)
{
    return mat3_apply_transposed(f->head, v);
}

#endif
