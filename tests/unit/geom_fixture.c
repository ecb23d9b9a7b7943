/* geom_fixture.c: see geom_fixture.h. */
#include "unit/geom_fixture.h"

#include "base/assert.h"
#include "base/rng.h"
#include "base/trig.h"
#include "check.h"

#include <stdlib.h>

const awt_pose geom_fixture_head = {
    {100000.25, 1.7, -3.1}, {0.18257418583505536, 0.36514837167011072, 0.54772255750516607, 0.73029674334022143}};

/* A root on the upper half of the head, and the strand falling from it outside the head, with a wave of its own. */
static void grow_strand(rng *r, uint32_t per_strand, float *p)
{
    double turn = rng_between(r, -3.14, 3.14), height = rng_between(r, 0.1, 1.0);
    double ring = sqrt(1 - height * height), sine, cosine;
    double length = rng_between(r, 0.1, 0.3), phase = rng_between(r, 0, 6), wave = rng_between(r, 0, 0.01);
    trig_sin_cos(turn, &sine, &cosine);
    dvec3 out = {ring * sine, height, ring * cosine};
    for (uint32_t i = 0; i < per_strand; i++) {
        double t = length * (double)i / (double)(per_strand - 1), ripple, other;
        trig_sin_cos(phase + t * 60, &ripple, &other);
        double away = 0.097 + 0.25 * t;
        dvec3 at = dvec3_add(dvec3_scale(out, away), (dvec3){wave * ripple, -2.5 * t * t, wave * other});
        double distance = dvec3_length(at);
        at = distance < away ? dvec3_scale(at, away / distance) : at;
        *p++ = (float)at.x;
        *p++ = (float)at.y;
        *p++ = (float)at.z;
    }
}

static void bound_points(geom_fixture *f, size_t points)
{
    for (size_t k = 0; k < 3; k++) {
        float least = -0.1f, greatest = 0.1f;
        for (size_t i = 0; i < points; i++) {
            float value = f->points[3 * i + k];
            least = value < least ? value : least;
            greatest = value > greatest ? value : greatest;
        }
        f->groom.info.box_min[k] = least - 0.05f;
        f->groom.info.box_max[k] = greatest + 0.05f;
    }
}

void geom_fixture_init(geom_fixture *f, uint32_t strands, uint32_t points_per_strand, uint32_t trees)
{
    *f = (geom_fixture){0};
    awt_groom_info *info = &f->groom.info;
    *info = (awt_groom_info){.strand_count = strands, .points_per_strand = points_per_strand, .levels = 1};
    info->wisp_count[0] = trees;
    info->head_radius_m = AWT_HEAD_RADIUS_M;
    f->groom.gc_count = trees;
    f->groom.level_first[1] = trees;
    f->groom.gc_tree = calloc(trees, sizeof(uint32_t));
    f->groom.gc_strand_first = calloc(trees + 1, sizeof(uint32_t));
    size_t points = (size_t)strands * points_per_strand;
    f->points = calloc(points, 3 * sizeof(float));
    f->groom.strand_offset = calloc(points, 3 * sizeof(float));
    ASSERT(f->groom.gc_tree && f->groom.gc_strand_first && f->points && f->groom.strand_offset);
    for (uint32_t t = 0; t < trees; t++) {
        f->groom.gc_tree[t] = t;
        f->groom.gc_strand_first[t + 1] = (uint32_t)((uint64_t)strands * (t + 1) / trees);
    }
    rng r = rng_seed(strands + points_per_strand);
    for (uint32_t s = 0; s < strands; s++) {
        grow_strand(&r, points_per_strand, f->points + (size_t)s * points_per_strand * 3);
    }
    for (size_t s = 0; s < strands; s++) { /* as if all wisps stood still in the head's centre */
        for (size_t i = 0; i < 3 * (size_t)points_per_strand; i++) {
            const size_t at = s * 3 * points_per_strand;
            f->groom.strand_offset[at + i % 3 * points_per_strand + i / 3] = f->points[at + i];
        }
    }
    bound_points(f, points);
    geom_fixture_layout(f, NULL);
}

void geom_fixture_layout(geom_fixture *f, const geom_layout_def *def)
{
    geom_scratch_destroy(f->scratch);
    geom_layout_destroy(f->layout);
    f->scratch = NULL;
    CHECK_INT(geom_layout_create(&f->groom, def, &f->layout, NULL), AWT_OK);
    ASSERT(f->layout);
    CHECK_INT(geom_scratch_create(f->layout, &f->scratch, NULL), AWT_OK);
    ASSERT(f->scratch);
}

void geom_fixture_fini(geom_fixture *f)
{
    geom_buffer_fini(&f->frame);
    geom_scratch_destroy(f->scratch);
    geom_layout_destroy(f->layout);
    free(f->groom.gc_tree);
    free(f->groom.gc_strand_first);
    free(f->groom.strand_offset);
    free(f->points);
    *f = (geom_fixture){0};
}

geom_frame_def geom_fixture_def(const geom_fixture *f)
{
    return (geom_frame_def){.points = f->points, .head = geom_fixture_head, .time_us = GEOM_FIXTURE_TIME_US};
}

void geom_fixture_encode(geom_fixture *f, geom_frame_stats *stats)
{
    awt_error error = {0};
    const geom_frame_def def = geom_fixture_def(f);
    CHECK_INT(geom_encode(f->layout, f->scratch, &def, &f->frame, stats, &error), AWT_OK);
    CHECK_TEXT(error.text, "");
}
