/* receive.h: frames back to strand points, by nothing but standard C: for clients on any system, and in a browser.
 *
 * Kinds ribbon and strands hold their points. Of kind guides the strands are evaluated here, by the code that the
 * server itself evaluates with (sim/evaluate.h), from a binding that the server gives once. Sources need not be
 * trusted. (read.h also takes what libdraco's own encoder wrote.) */
#ifndef GEOM_RECEIVE_H
#define GEOM_RECEIVE_H

#include "geom/read.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What binds the strands of one groom to its guides. Immutable; any number of threads may read it. */
typedef struct geom_binding geom_binding;

/* Reads what geom_binding_write wrote. AWT_BAD_FORMAT, AWT_TRUNCATED, AWT_BAD_VALUE (damaged), AWT_OTHER_VERSION,
 * AWT_LIMIT, AWT_NO_MEMORY; *out is NULL then. */
awt_status geom_binding_read(const void *bytes, size_t size, geom_binding **out, awt_error *error);
void geom_binding_destroy(geom_binding *binding);

/* Sections of guides read back, head frame. */
typedef struct geom_guides {
    uint32_t wisps, sections;
    float *centres; /* [wisps * sections][3] */
    float *frames;  /* [wisps * sections][4]: section frame to head frame, x y z w */

    /* What the next delta is made to, of frames by geom_read_guides_delta; else NULL. [wisps * sections][6] */
    uint16_t *numbers;
    uint32_t patch_count;
    awt_pose head;
    int64_t time_us;
} geom_guides;

/* Reads a frame of guides that stands for itself (GLB with meshes). `out` is written on success only: geom_guides_fini.
 * AWT_BAD_VALUE where the frame is of another groom than the binding; else the errors of geom_read_frame. */
awt_status geom_read_guides(const geom_binding *binding, const void *bytes, size_t size, geom_guides *out,
                            awt_error *error);
void geom_guides_fini(geom_guides *guides);

/* Reads a frame of guides that geom_encode_delta wrote: whole, where its base sequence is 0, or for who has its base, a
 * frame by this, with the number that its sender named it by. `base` may be NULL, and does not matter where the frame
 * is whole. `out`, which is not `base`, holds nothing or an earlier frame, whose memory is used again; it is written on
 * success only: geom_guides_fini. AWT_BAD_VALUE (it is for another binding or base), AWT_BAD_FORMAT, AWT_TRUNCATED,
 * AWT_LIMIT, AWT_NO_MEMORY. */
awt_status geom_read_guides_delta(geom_delta_reader *reader, const geom_binding *binding, const void *bytes,
                                  size_t size, const geom_guides *base, uint64_t base_sequence, geom_guides *out,
                                  awt_error *error);

/* Whether these bytes are a delta's file, as guides are that come as numbers; if not, they may be a frame that stands
 * for itself. What is in it is not looked at. */
bool geom_is_delta(const void *bytes, size_t size);

/* The strands of guides that were read with that binding. `out` holds nothing or an earlier frame, whose memory is used
 * again where it fits; it is written on success only: geom_strands_fini. AWT_BAD_VALUE (guides of another binding),
 * AWT_NO_MEMORY. */
awt_status geom_guides_strands(const geom_binding *binding, const geom_guides *guides, geom_strands *out,
                               awt_error *error);

/* The strands of a frame of any kind. `binding` is asked for guides only and may be NULL for others. `out` as
 * geom_read_frame; its kind says what the frame held. Errors of both. */
awt_status geom_receive_frame(const geom_binding *binding, const void *bytes, size_t size, geom_strands *out,
                              awt_error *error);

/* Nodes read back. */
typedef struct geom_nodes {
    uint32_t count;
    awt_node *nodes; /* [count], heap: geom_nodes_fini */
    awt_pose head;
    int64_t time_us;
} geom_nodes;

/* Reads what geom_encode_nodes wrote, from a source that need not be trusted: on success every number is finite, every
 * radius 0 or more, every level below AWT_MAX_LEVELS, and every parent stands before its node or is the node itself.
 * AWT_BAD_FORMAT, AWT_TRUNCATED, AWT_BAD_VALUE, AWT_LIMIT, AWT_NO_MEMORY. */
awt_status geom_read_nodes(const void *bytes, size_t size, geom_nodes *out, awt_error *error);
void geom_nodes_fini(geom_nodes *nodes);

#ifdef __cplusplus
}
#endif

#endif
