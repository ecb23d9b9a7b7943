/* test_geom_ribbon.c: the shape of a ribbon: flat on the head, without twist, never thinner than it can bear. */
#include "check.h"

#include "base/crc32c.h"
#include "base/vec.h"
#include "geom/layout.h"
#include "unit/geom_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static vec3 vertex_at(const float *vertices, uint32_t i)
{
    return vec3_make(vertices[3 * i], vertices[3 * i + 1], vertices[3 * i + 2]);
}

/* Width direction of point i of a ribbon, times its width. */
static vec3 width_at(const float *vertices, uint32_t i)
{
    return vec3_sub(vertex_at(vertices, 2 * i + 1), vertex_at(vertices, 2 * i));
}

enum { RIBBON_POINTS = 24 };

/* A shape of 2 mm at every point, in a box of 1 m to each side. */
static ribbon_shape plain_shape(float half_width[RIBBON_POINTS])
{
    ribbon_shape shape = {.points_per_strand = RIBBON_POINTS, .half_width = half_width};
    for (int i = 0; i < RIBBON_POINTS; i++) {
        half_width[i] = 0.001f;
    }
    for (int k = 0; k < 3; k++) {
        shape.point_min[k] = -1;
        shape.point_max[k] = 1;
    }
    return shape;
}

TEST(geom_ribbons_lie_flat_on_the_head)
{
    float half_width[RIBBON_POINTS], points[RIBBON_POINTS * 3], vertices[RIBBON_POINTS * 6];
    ribbon_shape shape = plain_shape(half_width);
    uint32_t clamped = 0;
    for (int i = 0; i < RIBBON_POINTS; i++) { /* a quarter of a great circle */
        double angle = 0.1 + 1.4 * i / (RIBBON_POINTS - 1);
        points[3 * i] = 0.0f;
        points[3 * i + 1] = (float)(0.1 * cos(angle));
        points[3 * i + 2] = (float)(0.1 * sin(angle));
    }
    CHECK(ribbon_vertices(&shape, points, 1, vertices, &clamped));
    for (uint32_t i = 0; i < RIBBON_POINTS; i++) {
        vec3 width = width_at(vertices, i);
        CHECK_NEAR(vec3_length(width), 0.002, 1e-6);
        vec3 out = vec3_unit(vertex_at(points, i), vec3_make(0, 1, 0));
        CHECK_NEAR(vec3_dot(width, out) / vec3_length(width), 0, 0.03);
    }
}

/* A helix turns its width by little from point to point and keeps it square to the strand. */
TEST(geom_ribbons_do_not_twist_along_a_curl)
{
    float half_width[RIBBON_POINTS], points[RIBBON_POINTS * 3], vertices[RIBBON_POINTS * 6];
    ribbon_shape shape = plain_shape(half_width);
    uint32_t clamped = 0;
    for (int i = 0; i < RIBBON_POINTS; i++) {
        points[3 * i] = (float)(0.1 + 0.01 * cos(0.7 * i));
        points[3 * i + 1] = -0.01f * (float)i;
        points[3 * i + 2] = (float)(0.01 * sin(0.7 * i));
    }
    CHECK(ribbon_vertices(&shape, points, 1, vertices, &clamped));
    for (uint32_t i = 1; i + 1 < RIBBON_POINTS; i++) {
        vec3 width = width_at(vertices, i), next = width_at(vertices, i + 1);
        vec3 along = vec3_sub(vertex_at(points, i + 1), vertex_at(points, i - 1));
        CHECK_NEAR(vec3_dot(width, along) / vec3_length(along), 0, 1e-6);
        CHECK(vec3_dot(width, next) > 0.7f * vec3_length(width) * vec3_length(next));
    }
}

/* Points that coincide, strands that double back or stand straight out of the head, a root at the very centre. */
TEST(geom_ribbons_of_degenerate_strands_have_their_width)
{
    float half_width[RIBBON_POINTS], points[5][RIBBON_POINTS * 3] = {{0}}, vertices[RIBBON_POINTS * 6];
    ribbon_shape shape = plain_shape(half_width);
    uint32_t clamped = 0;
    for (int i = 0; i < RIBBON_POINTS; i++) {
        points[1][3 * i] = 0.2f;
        points[2][3 * i] = i % 2 ? 0.1f : 0.11f;
        points[3][3 * i + 1] = 0.1f + 0.01f * (float)i;
        points[4][3 * i + 2] = i < RIBBON_POINTS / 2 ? 0.01f * (float)i : 0.01f * (float)(RIBBON_POINTS - i);
    }
    for (int s = 0; s < 5; s++) {
        CHECK(ribbon_vertices(&shape, points[s], 1, vertices, &clamped));
        for (uint32_t i = 0; i < RIBBON_POINTS; i++) {
            CHECK_NEAR(vec3_length(width_at(vertices, i)), 0.002, 1e-6);
        }
    }
    CHECK_INT(clamped, 0);
}

/* Strands are taken several at a time: how many, and which, makes no difference to any. */
TEST(geom_ribbons_are_the_same_whatever_strands_are_beside_them)
{
    const uint32_t per_strand[] = {2, 3, 4, 5, 16, 255, 256};
    for (size_t n = 0; n < sizeof per_strand / sizeof per_strand[0]; n++) {
        const size_t a_strand = 6 * (size_t)per_strand[n];
        geom_fixture f;
        geom_fixture_init(&f, 21, per_strand[n], 1);
        float *alone = calloc(21, a_strand * sizeof *alone), *beside = calloc(22, a_strand * sizeof *beside);
        uint32_t clamped = 0, clamped_beside = 0;
        f.points[0] = f.points[3 * per_strand[n]] = 9; /* outside: one point each of the first and second strand */
        for (uint32_t s = 0; s < 21; s++) {
            CHECK(ribbon_vertices(&f.layout->shape, f.points + s * a_strand / 2, 1, alone + s * a_strand, &clamped));
        }
        CHECK_INT(clamped, 2);
        for (uint32_t strands = 1; strands <= 21; strands++) {
            memset(beside, 0, 22 * a_strand * sizeof *beside);
            clamped_beside = 0;
            CHECK(ribbon_vertices(&f.layout->shape, f.points, strands, beside, &clamped_beside));
            CHECK(memcmp(beside, alone, strands * a_strand * sizeof *beside) == 0);
            CHECK(beside[strands * a_strand] == 0);
            CHECK_INT(clamped_beside, strands > 1 ? 2 : 1);
        }
        free(alone);
        free(beside);
        geom_fixture_fini(&f);
    }
}

TEST(geom_ribbons_refuse_a_point_that_is_not_finite_in_any_place)
{
    const float wrong[] = {NAN, INFINITY, -INFINITY};
    geom_fixture f;
    geom_fixture_init(&f, 11, 5, 1);
    float *vertices = calloc(11, 30 * sizeof *vertices);
    uint32_t clamped = 0;
    for (size_t i = 0; i < 11 * 15; i++) {
        float right = f.points[i];
        f.points[i] = wrong[i % 3];
        CHECK(!ribbon_vertices(&f.layout->shape, f.points, 11, vertices, &clamped));
        f.points[i] = right;
    }
    CHECK(ribbon_vertices(&f.layout->shape, f.points, 11, vertices, &clamped));
    free(vertices);
    geom_fixture_fini(&f);
}

/* The same bits from every compiler and for every width of the machine's registers. */
TEST(geom_ribbons_are_these_bits)
{
    geom_fixture f;
    geom_fixture_init(&f, 333, 17, 3);
    float *vertices = calloc(333, 17 * 6 * sizeof *vertices);
    uint32_t clamped = 0;
    CHECK(ribbon_vertices(&f.layout->shape, f.points, 333, vertices, &clamped));
    CHECK_U64(crc32c(vertices, 333 * 17 * 6 * sizeof *vertices), UINT32_C(0x57b30b7c));
    free(vertices);
    geom_fixture_fini(&f);
}

TEST(geom_fewer_strands_are_wider_and_none_is_under_four_steps)
{
    const uint32_t counts[] = {1, 100, 2000, 10000, 100000};
    float before = 1;
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        geom_fixture f;
        geom_fixture_init(&f, counts[i], 9, 1);
        float step = draco_box_step(&f.layout->box), middle = 2 * f.layout->half_width[4];
        CHECK(counts[i] > 1000 ? middle < before : middle <= before);
        before = middle;
        for (uint32_t k = 0; k < 9; k++) {
            CHECK(2 * f.layout->half_width[k] >= 3.999f * step);
        }
        if (counts[i] == 10000) {
            CHECK(middle >= 0.0012f && middle <= 0.002f);
        }
        CHECK(f.layout->half_width[8] < f.layout->half_width[4]);
        CHECK(middle <= 0.005f);
        geom_fixture_fini(&f);
    }
}
