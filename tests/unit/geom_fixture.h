/* geom_fixture.h: a groom with nothing in it but what frames need, and strands to go with it. */
#ifndef GEOM_FIXTURE_H
#define GEOM_FIXTURE_H

#include "geom/encode.h"
#include "groom/groom.h"

typedef struct geom_fixture {
    struct awt_groom groom; /* one level; tree t has the strands gc_strand_first[t] .. gc_strand_first[t+1]-1 */
    float *points;          /* [strands][points_per_strand][3], wavy hair on a head, all within the groom's box */
    geom_layout *layout;
    geom_scratch *scratch;
    geom_buffer frame;
} geom_fixture;

/* `strands` in `trees` about equal trees, for ribbons. Ends the program where there is no memory. */
void geom_fixture_init(geom_fixture *fixture, uint32_t strands, uint32_t points_per_strand, uint32_t trees);
/* The same hair for frames of another layout, from now on. */
void geom_fixture_layout(geom_fixture *fixture, const geom_layout_def *def);
void geom_fixture_fini(geom_fixture *fixture);

/* Encodes the points as they are now at the pose and time below; checks that it is well. */
void geom_fixture_encode(geom_fixture *fixture, geom_frame_stats *stats);

/* What geom_fixture_encode encodes. */
geom_frame_def geom_fixture_def(const geom_fixture *fixture);

extern const awt_pose geom_fixture_head;
#define GEOM_FIXTURE_TIME_US INT64_C(5000000123) /* beyond 32 bits */

#endif
