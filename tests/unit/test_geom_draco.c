/* test_geom_draco.c: our own Draco meshes before the judge: stock libdraco must find in them the integers that its own
 * encoder would have written, and our own reader the same. */
#include "check.h"

#include "base/rng.h"
#include "geom/draco_read.h"
#include "geom/draco_shim.h"
#include "geom/draco_write.h"
#include "unit/geom_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A row of `vertices` vertices under triangles of three neighbours, the last one cut to what there is. */
typedef struct row {
    uint32_t vertices, triangles;
    uint16_t *indices;
    float *positions, *own, *stock;
    draco_box box;
    quantise_bounds bounds;
    draco_mesh mesh;
    draco_writer *writer;
    draco_reader *reader;
    unsigned char *bytes;
    size_t size;
} row;

static row make_row(uint32_t vertices, int bits, symbols_scheme scheme)
{
    row r = {.vertices = vertices, .triangles = (vertices + 2) / 3, .box = {{-0.5f, -1.0f, 0.25f}, 1.5f, bits}};
    r.indices = malloc(3 * (size_t)r.triangles * sizeof *r.indices);
    r.positions = malloc(3 * (size_t)vertices * sizeof(float));
    r.own = malloc(3 * (size_t)vertices * sizeof(float));
    r.stock = malloc(3 * (size_t)vertices * sizeof(float));
    for (uint32_t i = 0; i < 3 * r.triangles; i++) {
        r.indices[i] = (uint16_t)(i < vertices ? i : vertices - 1);
    }
    for (int k = 0; k < 3; k++) {
        r.bounds.least[k] = r.box.origin[k];
        r.bounds.greatest[k] = r.box.origin[k] + r.box.range;
    }
    CHECK_INT(draco_mesh_make(vertices, r.indices, r.triangles, NULL, &r.mesh, NULL), AWT_OK);
    CHECK_INT(draco_writer_create(vertices, bits, scheme, DRACO_POSITIONS, &r.writer, NULL), AWT_OK);
    CHECK_INT(draco_reader_create(vertices, r.triangles, &r.reader, NULL), AWT_OK);
    return r;
}

static void free_row(row *r)
{
    draco_mesh_fini(&r->mesh);
    draco_writer_destroy(r->writer);
    draco_reader_destroy(r->reader);
    free(r->indices);
    free(r->positions);
    free(r->own);
    free(r->stock);
    free(r->bytes);
}

static void write_row(row *r)
{
    draco_job jobs[RANS_LANES] = {{.mesh = &r->mesh, .positions = r->positions}};
    draco_writer_run(r->writer, &r->box, &r->bounds, jobs, false);
    CHECK(jobs[0].found.finite);
    free(r->bytes);
    r->size = jobs[0].size;
    r->bytes = malloc(r->size);
    draco_writer_put(r->writer, &r->box, &jobs[0], 0, r->bytes);
}

static bool read_row(const row *r, const unsigned char *bytes, size_t size, float *positions)
{
    const draco_kind kind = {.indices = r->indices};
    const draco_source sources[RANS_LANES] = {
        {.bytes = bytes, .size = size, .vertices = r->vertices, .triangles = r->triangles, .positions = positions}};
    return draco_read(r->reader, &kind, sources);
}

/* Ours through both readers, and the stock encoder's: the same positions to the bit. */
static void check_row(row *r)
{
    geom_buffer reference = {0};
    const size_t size = 3 * (size_t)r->vertices * sizeof(float);
    float *expected = malloc(size);
    write_row(r);
    CHECK_INT(draco_shim_decode(r->bytes, r->size, r->indices, r->vertices, r->triangles, r->stock, NULL), AWT_OK);
    CHECK(read_row(r, r->bytes, r->size, r->own));
    CHECK_INT(draco_shim_encode(&r->box, r->positions, r->vertices, r->indices, r->triangles, &reference, NULL),
              AWT_OK);
    CHECK_INT(draco_shim_decode(reference.bytes, reference.size, r->indices, r->vertices, r->triangles, expected, NULL),
              AWT_OK);
    CHECK(memcmp(r->stock, expected, size) == 0);
    CHECK(memcmp(r->own, expected, size) == 0);
    geom_buffer_fini(&reference);
    free(expected);
}

/* Positions within the box: a walk of steps up to `step` of it, which turns back at the walls. */
static void walk(row *r, double step, rng *random)
{
    double at[3] = {0.5, 0.5, 0.5};
    for (uint32_t i = 0; i < r->vertices; i++) {
        for (int k = 0; k < 3; k++) {
            at[k] += rng_between(random, -step, step);
            at[k] = at[k] < 0 ? -at[k] : at[k] > 1 ? 2 - at[k] : at[k];
            r->positions[3 * i + (uint32_t)k] = r->box.origin[k] + (float)at[k] * r->box.range;
        }
    }
}

TEST(geom_own_meshes_are_stock_draco_to_the_integer)
{
    const uint32_t vertices[] = {3, 4, 17, 160, 1000, 16383, 65535};
    rng random = rng_seed(21);
    for (size_t v = 0; v < sizeof vertices / sizeof vertices[0]; v++) {
        for (int bits = 8; bits <= 15; bits += v < 5 ? 1 : 4) {
            for (int scheme = SYMBOLS_TAGGED; scheme <= SYMBOLS_RAW; scheme++) {
                row r = make_row(vertices[v], bits, (symbols_scheme)scheme);
                walk(&r, 0.01, &random);
                check_row(&r);
                walk(&r, 1.0, &random);
                check_row(&r);
                free_row(&r);
            }
        }
    }
}

/* Differences as long as the box wrap round; all alike they are 0 but for the first. */
TEST(geom_own_meshes_of_extremes_are_stock_draco_too)
{
    for (int scheme = SYMBOLS_TAGGED; scheme <= SYMBOLS_RAW; scheme++) {
        row r = make_row(999, 12, (symbols_scheme)scheme);
        for (uint32_t i = 0; i < 3 * 999; i++) {
            r.positions[i] = i / 3 % 2 ? r.bounds.greatest[i % 3] : r.bounds.least[i % 3];
        }
        check_row(&r);
        for (uint32_t i = 0; i < 3 * 999; i++) {
            r.positions[i] = r.bounds.greatest[i % 3];
        }
        check_row(&r);
        free_row(&r);
    }
}

TEST(geom_own_reader_refuses_every_truncation_and_what_follows)
{
    rng random = rng_seed(22);
    for (int scheme = SYMBOLS_TAGGED; scheme <= SYMBOLS_RAW; scheme++) {
        row r = make_row(120, 12, (symbols_scheme)scheme);
        walk(&r, 0.01, &random);
        write_row(&r);
        CHECK(read_row(&r, r.bytes, r.size, r.own));
        for (size_t size = 0; size < r.size; size++) {
            unsigned char *copy = malloc(size ? size : 1);
            memcpy(copy, r.bytes, size);
            CHECK(!read_row(&r, copy, size, r.own));
            free(copy);
        }
        unsigned char *longer = calloc(1, r.size + 1);
        memcpy(longer, r.bytes, r.size);
        CHECK(!read_row(&r, longer, r.size + 1, r.own));
        free(longer);
        free_row(&r);
    }
}

TEST(geom_own_reader_refuses_other_triangles_and_other_padding)
{
    row r = make_row(999, 12, SYMBOLS_RAW);
    for (uint32_t i = 0; i < 3 * 999; i++) {
        r.positions[i] = r.bounds.least[i % 3];
    }
    write_row(&r);
    CHECK_U64(r.size, r.mesh.least_size);
    CHECK(read_row(&r, r.bytes, r.size, r.own));
    r.indices[500]--;
    CHECK(!read_row(&r, r.bytes, r.size, r.own));
    r.indices[500]++;
    r.bytes[r.size - 1] = 1;
    CHECK(!read_row(&r, r.bytes, r.size, r.own));
    free_row(&r);
}

TEST(geom_own_reader_refuses_boxes_that_are_none)
{
    const float wrong[] = {NAN, INFINITY, -INFINITY, 3e38f, -3e38f};
    rng random = rng_seed(24);
    row r = make_row(120, 12, SYMBOLS_RAW);
    walk(&r, 0.01, &random);
    write_row(&r);
    for (size_t field = 0; field < 4; field++) { /* origin and range, before the bits at the end */
        unsigned char *at = r.bytes + r.size - 17 + 4 * field;
        float kept;
        memcpy(&kept, at, sizeof kept);
        for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
            memcpy(at, &wrong[i], sizeof kept);
            CHECK(!read_row(&r, r.bytes, r.size, r.own));
        }
        memcpy(at, &kept, sizeof kept);
        CHECK(read_row(&r, r.bytes, r.size, r.own));
    }
    r.bytes[r.size - 1]++; /* bits */
    CHECK(!read_row(&r, r.bytes, r.size, r.own));
    free_row(&r);
}

/* Flips anywhere. What is taken in spite of them (another position, another box) must be finite. */
TEST(geom_own_reader_survives_random_damage)
{
    rng random = rng_seed(23);
    int taken = 0;
    for (int scheme = SYMBOLS_TAGGED; scheme <= SYMBOLS_RAW; scheme++) {
        row r = make_row(120, 12, (symbols_scheme)scheme);
        walk(&r, 0.01, &random);
        write_row(&r);
        unsigned char *copy = malloc(r.size);
        for (int round = 0; round < 6000; round++) {
            memcpy(copy, r.bytes, r.size);
            for (uint32_t flips = 1 + rng_u32(&random) % 3; flips > 0; flips--) {
                copy[rng_u32(&random) % r.size] ^= (unsigned char)(1 + rng_u32(&random) % 255);
            }
            if (read_row(&r, copy, r.size, r.own)) {
                taken++;
                for (uint32_t i = 0; i < 3 * r.vertices; i++) {
                    CHECK(isfinite(r.own[i]));
                }
            }
        }
        free(copy);
        free_row(&r);
    }
    CHECK(taken > 0 && taken < 6000);
}

TEST(geom_quantising_finds_bounds_and_what_lies_outside)
{
    const draco_box box = {{-1, -1, -1}, 2.0f, 12};
    const quantise_bounds bounds = {{-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}};
    float positions[3 * 33];
    uint16_t symbols[QUANTISE_BLOCK * 3];
    for (int i = 0; i < 3 * 33; i++) {
        positions[i] = (float)(i - 49) / 100.0f;
    }
    quantise_findings found = quantise_differences(&box, &bounds, positions, 33, symbols);
    CHECK(found.finite && !found.outside);
    for (int k = 0; k < 3; k++) {
        CHECK_INT(found.least[k], draco_box_number(&box, k, positions[k]));
        CHECK_INT(found.greatest[k], draco_box_number(&box, k, positions[3 * 32 + k]));
    }
    positions[98] = 0.75f; /* the last one, in a block that is not full */
    found = quantise_differences(&box, &bounds, positions, 33, symbols);
    CHECK(found.finite && found.outside);
    CHECK_INT(found.greatest[2], draco_box_number(&box, 2, 0.5f));
    positions[98] = NAN;
    CHECK(!quantise_differences(&box, &bounds, positions, 33, symbols).finite);
    positions[98] = INFINITY;
    CHECK(!quantise_differences(&box, &bounds, positions, 33, symbols).finite);
}
