/* groom_fixture.h: strands made by hand, the grooms on them, and what holds of any groom. */
#ifndef GROOM_FIXTURE_H
#define GROOM_FIXTURE_H

#include "awt.h"
#include "groom/groom.h"

enum { GROOM_FIXTURE_POINTS = 8 }; /* of a strand of groom_fixture_patch */

/* Room for strands of `points` points each, all zero. */
awt_strands groom_fixture_strands(uint32_t strand_count, uint32_t points);
void groom_fixture_put(awt_strands *strands, uint32_t strand, uint32_t point, double x, double y, double z);
/* A patch of curved strands of uneven length on top of the head. */
awt_strands groom_fixture_patch(uint32_t strand_count);

/* A failure is a failed check, and NULL. */
awt_groom *groom_fixture_build(const awt_strands *strands, const awt_groom_def *def);
/* On groom_fixture_patch. */
awt_groom *groom_fixture_build_patch(uint32_t strand_count, uint32_t levels, uint32_t top, uint32_t finest);

/* The real grooms of the data folder, and what of their placement the roots do not show. */
enum { GROOM_FIXTURE_REAL = 5 };
typedef struct groom_fixture_file {
    const char *file;
    awt_placement placement;
} groom_fixture_file;
extern const groom_fixture_file groom_fixture_real[GROOM_FIXTURE_REAL];
/* The groom of the strands of one, which stands at `path`. A failure is a failed check, and NULL. */
awt_groom *groom_fixture_build_real(const groom_fixture_file *real, const char *path);

/* Of everything a groom consists of. */
uint64_t groom_fixture_hash(const awt_groom *groom);
/* The strands as the groom evaluates them at rest, [strands][points][3]; the caller frees. */
float *groom_fixture_rest(const awt_groom *groom);

/* Every strand is in one GC of each level, and sub-GCs and trees are contiguous. */
void groom_fixture_check_partition(const awt_groom *groom);
/* The partition, and every number finite and within reason. */
void groom_fixture_check_sound(const awt_groom *groom);
/* At rest every input strand comes back once, point by point; the groom has the strands' own number of points. */
void groom_fixture_check_strands(const awt_strands *strands, const awt_groom *groom, double tolerance_m);

#endif
