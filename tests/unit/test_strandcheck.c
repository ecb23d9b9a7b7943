/* test_strandcheck.c: what awtctl says of decoded frames is what was done to them. */
#include "check.h"

#include "strandcheck.h"
#include "unit/geom_fixture.h"

#include <math.h>

enum { STRANDS = 40, POINTS = 16 };

/* Decodes and adds. */
static awt_status add_glb(strandcheck *check, const void *glb, size_t size, awt_error *error)
{
    geom_strands strands;
    awt_status status = geom_read_frame(glb, size, &strands, error);
    if (status == AWT_OK) {
        status = strandcheck_add(check, &strands, error);
        geom_strands_fini(&strands);
    }
    return status;
}

/* Scales each strand about its root and moves it, by amounts for every fourth strand and for the others. */
static void change(geom_fixture *f, float scale_fourth, float scale, float move)
{
    for (uint32_t s = 0; s < STRANDS; s++) {
        float *p = f->points + (size_t)s * POINTS * 3, root[3] = {p[0], p[1], p[2]};
        float by = s % 4 == 0 ? scale_fourth : scale;
        for (int i = 0; i < POINTS * 3; i++) {
            p[i] = root[i % 3] + (p[i] - root[i % 3]) * by + (i % 3 == 1 ? move : 0);
        }
    }
}

static void add(strandcheck *check, geom_fixture *f)
{
    awt_error error = {0};
    geom_frame_stats stats;
    geom_fixture_encode(f, &stats);
    CHECK_INT(add_glb(check, f->frame.bytes, f->frame.size, &error), AWT_OK);
    CHECK_TEXT(error.text, "");
}

TEST(strandcheck_measures_lengths_and_roots_against_the_first_frame)
{
    geom_fixture f;
    strandcheck check = {0};
    geom_fixture_init(&f, STRANDS, POINTS, 3);
    add(&check, &f);
    CHECK_INT(check.frames, 0);
    change(&f, 0.8f, 0.9f, 0.005f);
    add(&check, &f);
    CHECK_INT(check.frames, 1);
    /* three quarters of the strands by 10 %, the rest by 20 %, to within what quantisation does to short segments */
    CHECK_NEAR(strandcheck_percent(&check, 0.5), 10, 0.5);
    CHECK_NEAR(strandcheck_percent(&check, 0.95), 20, 0.5);
    CHECK_NEAR(check.greatest_percent, 20, 0.5);
    CHECK_NEAR(check.greatest_root_m, 0.005, 0.0005);
    strandcheck_fini(&check);
    geom_fixture_fini(&f);
}

TEST(strandcheck_refuses_other_strands_and_broken_frames)
{
    geom_fixture f, other;
    strandcheck check = {0};
    awt_error error = {0};
    geom_frame_stats stats;
    geom_fixture_init(&f, STRANDS, POINTS, 3);
    geom_fixture_init(&other, STRANDS + 1, POINTS, 3);
    add(&check, &f);
    geom_fixture_encode(&other, &stats);
    CHECK_INT(add_glb(&check, other.frame.bytes, other.frame.size, &error), AWT_BAD_VALUE);
    f.points[0] = NAN;
    const geom_strands broken = {.strand_count = STRANDS, .points_per_strand = POINTS, .positions = f.points};
    CHECK_INT(strandcheck_add(&check, &broken, &error), AWT_BAD_VALUE);
    CHECK_INT(check.frames, 0);
    geom_strands coarser = {.strand_count = STRANDS + 1,
                            .points_per_strand = POINTS,
                            .positions = other.points,
                            .level = GEOM_LEVEL_FIFTH}; /* whose first frame it is */
    CHECK_INT(strandcheck_add(&check, &coarser, &error), AWT_OK);
    CHECK_INT(check.frames, 0);
    CHECK_INT(strandcheck_add(&check, &coarser, &error), AWT_OK);
    CHECK_INT(check.frames, 1);
    strandcheck_fini(&check);
    geom_fixture_fini(&f);
    geom_fixture_fini(&other);
}
