/* encode_guides.h: what frames of guides, as meshes, as numbers against nothing and against the frame before, and of
 * nodes cost, and how near their strands come. */
#ifndef BENCH_ENCODE_GUIDES_H
#define BENCH_ENCODE_GUIDES_H

#include "geom/encode.h"
#include "geom/receive.h"

enum { GUIDES_KEYFRAME, GUIDES_WHOLE, GUIDES_DELTA, GUIDES_NODES, GUIDES_KINDS };

/* One kind: times are medians of whole frames, on one core; the rest are means over the frames unless said. */
typedef struct guides_row {
    const char *name, *kind;
    bool delta;             /* to the frame before */
    double nodes;           /* of a frame: finest ones, or active ones */
    uint32_t position_bits; /* 0: floats */
    uint32_t turn_bits;
    double encode_ms;                   /* guides to GLB */
    double receive_ms;                  /* GLB to strand points, or to nodes */
    double bytes;                       /* of a frame, JSON and all */
    double entropy_bits;                /* a node, without tables, connectivity and JSON */
    double max_error_mm, mean_error_mm; /* of a strand point that a receiver makes; greatest of all, and mean */
} guides_row;

/* What is measured with, and what has been. */
typedef struct guides_subject {
    geom_layout *layout;
    geom_scratch *scratch;
    geom_quantised *base, *now; /* the frame before, and this one */
    geom_delta_reader *reader;
    geom_guides base_got, got; /* as a receiver has them */
    geom_strands strands;
    geom_binding *binding;
    size_t binding_bytes;
    awt_node *nodes;
    geom_buffer frame;
    uint32_t taken, done;
    double *encode_ms[GUIDES_KINDS], *receive_ms[GUIDES_KINDS]; /* [frames] */
    guides_row sums[GUIDES_KINDS];
} guides_subject;

/* For `frames` frames of the groom. guides_subject_fini, whatever it returns. */
awt_status guides_subject_init(guides_subject *subject, const awt_groom *groom, uint32_t frames, awt_error *error);
void guides_subject_fini(guides_subject *subject);
/* One frame: the forest as it is, its guides and its strand points; `measured`, or only the next one's base. */
awt_status guides_measure(guides_subject *subject, const awt_forest *forest, const float *centres, const float *frames,
                          const float *points, bool measured, awt_error *error);
/* After the last one. */
void guides_rows(guides_subject *subject, guides_row rows[GUIDES_KINDS]);

#endif
