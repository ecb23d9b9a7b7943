/* binding.h: what a receiver of guides has once: how every strand hangs on the finest wisps, and how these are at rest.
 *
 * The file (proto/GEOMETRY.md has it byte by byte) is plain numbers, not a GLB: no viewer can do anything with it
 * without our evaluation, and a reader needs no JSON for it. Its id, a hash of all of it, is said by every frame of
 * guides, so that nobody evaluates one head's guides with another's binding.
 *
 * Offsets are whole numbers of `offset_step_m`, the largest of the groom's by 32767: a strand point is at most 0.9
 * steps from where it was bound, 4 micrometres for the built-in styles. */
#ifndef GEOM_BINDING_H
#define GEOM_BINDING_H

#include "geom/receive.h"

#include "base/vec.h"

enum {
    BINDING_LEAST_BITS = 10, /* of positions and turns; each groom has as many as its error allows */
    BINDING_MOST_BITS = 14
};

struct geom_binding {
    uint64_t id;
    uint32_t strands, points; /* points of a strand */
    uint32_t wisps, sections; /* finest wisps, and cross-sections of each */
    uint32_t position_bits;   /* of positions in the groom's box */
    uint32_t turn_bits;       /* of turns (guides.h) */
    float position_step_m;
    float offset_step_m;
    float *widths;          /* [points]: of every strand from root to tip, metres */
    uint32_t *strand_first; /* [wisps + 1] */
    uint32_t *tree;         /* [wisps], rising from 0: which top-level wisp each one is of */
    vec3 *rest_centre;      /* [wisps * sections], head frame */
    quat *rest_frame;       /* [wisps * sections], section frame to head frame */
    int16_t *packed;        /* [strands][3][points]: offsets in the frames of the stations (sim/evaluate.h), in steps */
    float *offsets;         /* the same in metres; made by geom_binding_read only */
};

/* Takes the arrays that the counts ask for, zeroed. False: no memory. */
bool binding_take_memory(geom_binding *binding);

/* Bytes of the file; what is written to `bytes` where it is not NULL and `capacity` is enough. Sets the id. */
size_t binding_walk_out(geom_binding *binding, void *bytes, size_t capacity);

/* The binding of a groom, without `offsets`. AWT_LIMIT, AWT_NO_MEMORY. */
awt_status binding_of_groom(const awt_groom *groom, geom_binding **out, awt_error *error);

#endif
