/* delta_fixture.h: hair (geom_fixture.h) of which two frames are at hand as whole numbers. */
#ifndef DELTA_FIXTURE_H
#define DELTA_FIXTURE_H

#include "unit/geom_fixture.h"

typedef struct delta_fixture {
    geom_fixture hair;  /* of kind strands; its points are those of `now` */
    float *base_points; /* those of `base` */
    geom_quantised *base, *now;
    uint64_t base_sequence; /* 41 */
    int64_t time_us;
    geom_delta_reader *reader;
    geom_buffer whole, delta;
    uint32_t moves;
} delta_fixture;

/* Both frames are of the hair as it was made. Ends the program where there is no memory. */
void delta_fixture_init(delta_fixture *f, uint32_t strands, uint32_t per_strand, uint32_t trees, int bits);
void delta_fixture_fini(delta_fixture *f);

/* `now` becomes `base`, and the points move: neighbours alike, tips by `reach_m` or so, roots not at all; patches that
 * are `still` (NULL: none) stay. */
void delta_fixture_move(delta_fixture *f, float reach_m, const bool *still);
/* The points, and `now`, are those of `base` again. */
void delta_fixture_to_base(delta_fixture *f);

/* Makes the delta, and checks that it is well. */
void delta_fixture_encode(delta_fixture *f, geom_frame_stats *stats);
/* Reads a copy of exactly its size, so that the sanitizers see each byte read beyond it. */
awt_status delta_fixture_read(delta_fixture *f, const geom_strands *base, geom_strands *out);

#endif
