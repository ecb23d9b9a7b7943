/* test_geom_others.c: frames of every shape for readers that are not ours (tests/node), and beside each the vertices
 * that went in. */
#include "check.h"

#include "geom/layout.h"
#include "unit/geom_fixture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Vertices as they went in: a ribbon's, or the strands' points. */
static void write_vertices(const geom_fixture *f, const float *points, const char *folder, const char *name)
{
    const uint32_t strands = f->layout->strands, per_strand = f->layout->points_per_strand;
    const bool ribbon = f->layout->kind == GEOM_RIBBON;
    const size_t size = (size_t)strands * per_strand * (ribbon ? 6 : 3) * sizeof(float);
    uint32_t clamped = 0;
    float *vertices = malloc(size);
    CHECK(vertices != NULL);
    if (ribbon) {
        CHECK(ribbon_vertices(&f->layout->shape, points, strands, vertices, &clamped));
    } else {
        memcpy(vertices, points, size);
    }
    check_write_file(folder, name, ".f32", vertices, size);
    free(vertices);
}

static void write_frame(geom_fixture *f, const geom_frame_def *def, const char *folder, const char *name)
{
    CHECK_INT(geom_encode(f->layout, f->scratch, def, &f->frame, NULL, NULL), AWT_OK);
    check_write_file(folder, name, "", f->frame.bytes, f->frame.size);
    write_vertices(f, def->points, folder, name);
}

/* The strands of the fixture's layout. */
static float *points_of_level(const geom_fixture *f)
{
    const size_t a_strand = 3 * (size_t)f->layout->points_per_strand, strands = geom_layout_strands(f->layout);
    float *points = malloc(strands * a_strand * sizeof *points);
    CHECK(points != NULL);
    for (uint32_t s = 0; s < strands; s++) {
        memcpy(points + s * a_strand, f->points + geom_layout_strand(f->layout, s) * a_strand,
               a_strand * sizeof *points);
    }
    return points;
}

/* A fifth of the strands, and one a wisp. */
static void write_levels(const char *folder)
{
    geom_fixture f;
    char name[80];
    geom_fixture_init(&f, 10000, 16, 60);
    for (int n = 0; n < 4; n++) {
        const geom_level level = n & 1 ? GEOM_LEVEL_GUIDES : GEOM_LEVEL_FIFTH;
        geom_fixture_layout(&f, &(geom_layout_def){.kind = n / 2 ? GEOM_STRANDS : GEOM_RIBBON, .level = level});
        geom_frame_def def = geom_fixture_def(&f);
        float *points = points_of_level(&f);
        def.points = points;
        snprintf(name, sizeof name, "%s-level%d.glb", n / 2 ? "strands" : "ribbon", (int)level);
        write_frame(&f, &def, folder, name);
        free(points);
    }
    geom_fixture_fini(&f);
}

/* One shape of hair as a frame of each kind by each encoder. */
static void write_frames(const char *folder, const uint32_t shape[3], bool alike)
{
    static const char *const kinds[] = {"ribbon", "strands"};
    const uint32_t strands = shape[0], per_strand = shape[1];
    geom_fixture f;
    char name[80];
    geom_fixture_init(&f, strands, per_strand, shape[2]);
    for (uint32_t k = 0; k < strands * per_strand && alike; k++) { /* straight up: padded */
        f.points[3 * k] = f.points[3 * k + 2] = 0.01f;
        f.points[3 * k + 1] = 0.1f + 0.0001f * (float)(k % per_strand);
    }
    for (int n = 0; n < 4; n++) {
        const bool stock = n & 1;
        geom_fixture_layout(&f, &(geom_layout_def){.kind = n / 2 ? GEOM_STRANDS : GEOM_RIBBON, .stock = stock});
        const geom_frame_def def = geom_fixture_def(&f);
        snprintf(name, sizeof name, "%s-%ux%u%s.glb", kinds[n / 2], strands, per_strand, stock ? "-stock" : "");
        write_frame(&f, &def, folder, name);
    }
    geom_fixture_fini(&f);
}

TEST(geom_frames_for_other_readers)
{
    const char *folder = getenv("AWT_FRAMES");
    if (!folder) {
        check_skip("AWT_FRAMES names no folder to write frames to, for tests/node/check_glb.mjs");
        return;
    }
    const uint32_t shapes[][3] = {{1, 2, 1},     {1, 3, 1},       {1, 16, 1},       {1, 32, 1},   {1, 100, 1},
                                  {40, 2, 3},    {40, 3, 3},      {40, 16, 3},      {300, 32, 4}, {10000, 16, 60},
                                  {500, 100, 5}, {50000, 4, 200}, {50000, 16, 200}, {600, 24, 6}};
    const size_t count = sizeof shapes / sizeof shapes[0];
    for (size_t i = 0; i < count; i++) {
        write_frames(folder, shapes[i], i + 1 == count);
    }
    write_levels(folder);
}
