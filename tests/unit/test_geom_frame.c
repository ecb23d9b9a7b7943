/* test_geom_frame.c: frames as they are written: what comes back from them, and what they promise. */
#include "check.h"

#include "geom/draco_shim.h"
#include "geom/glb.h"
#include "geom/json.h"
#include "geom/layout.h"
#include "geom/read.h"
#include "unit/geom_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Greatest distance along an axis between `count` numbers. */
static double greatest_difference(const float *a, const float *b, size_t count)
{
    double greatest = 0;
    for (size_t i = 0; i < count; i++) {
        greatest = fmax(greatest, fabs((double)a[i] - (double)b[i]));
    }
    return greatest;
}

static void check_round_trip(uint32_t strands, uint32_t per_strand, uint32_t trees)
{
    geom_fixture f;
    geom_frame_stats stats = {0};
    geom_strands back = {0};
    awt_error error = {0};
    geom_fixture_init(&f, strands, per_strand, trees);
    geom_fixture_encode(&f, &stats);
    CHECK_INT(geom_read_frame(f.frame.bytes, f.frame.size, &back, &error), AWT_OK);
    CHECK_TEXT(error.text, "");
    CHECK_INT(back.strand_count, strands);
    CHECK_INT(back.points_per_strand, per_strand);
    CHECK_INT(back.patch_count, geom_layout_patches(f.layout));
    CHECK_INT(back.triangle_count, strands * (per_strand - 1) * 2);
    CHECK_INT(stats.triangles, back.triangle_count);
    CHECK_INT(stats.vertices, strands * per_strand * 2);
    CHECK_INT(stats.clamped_points, 0);
    CHECK(back.time_us == GEOM_FIXTURE_TIME_US);
    CHECK_BYTES(back.head.position, geom_fixture_head.position, sizeof back.head.position);
    for (int k = 0; k < 4; k++) {
        CHECK_NEAR(back.head.orientation[k], geom_fixture_head.orientation[k], 1e-15);
    }
    if (back.positions) {
        double step = draco_box_step(&f.layout->box);
        CHECK_NEAR(greatest_difference(back.positions, f.points, (size_t)strands * per_strand * 3), 0, step);
    }
    geom_strands_fini(&back);
    geom_fixture_fini(&f);
}

TEST(geom_centre_lines_come_back_within_a_quantisation_step)
{
    const uint32_t per_strand[] = {2, 3, 16, 32, 100, 256};
    for (size_t i = 0; i < sizeof per_strand / sizeof per_strand[0]; i++) {
        check_round_trip(1, per_strand[i], 1);
        check_round_trip(300, per_strand[i], 7);
    }
    check_round_trip(5000, 16, 40);
}

/* Each patch but the last could not have taken the tree that follows it; none is over the limit; a boundary inside a
 * tree stands only where that tree alone is too large. */
static void check_patches(uint32_t strands, uint32_t per_strand, uint32_t trees)
{
    geom_fixture f;
    geom_fixture_init(&f, strands, per_strand, trees);
    const uint32_t room = GEOM_PATCH_POINTS / per_strand;
    uint32_t expected_first = 0;
    for (uint32_t i = 0; i < f.layout->patch_count; i++) {
        geom_patch patch = f.layout->patches[i];
        CHECK_INT(patch.first_strand, expected_first);
        CHECK(patch.strands >= 1 && patch.strands <= room);
        expected_first += patch.strands;
        for (uint32_t t = 0; t < trees; t++) {
            uint32_t begin = f.groom.gc_strand_first[t], end = f.groom.gc_strand_first[t + 1];
            if (begin < expected_first && expected_first < end) {
                CHECK(end - begin > room);
            }
        }
    }
    CHECK_INT(expected_first, strands);
    geom_fixture_fini(&f);
}

TEST(geom_patches_are_whole_trees_under_the_limit_of_points)
{
    check_patches(10000, 16, 60);
    check_patches(1024, 16, 1); /* exactly one patch */
    check_patches(5000, 16, 1); /* one tree, too large */
    check_patches(5000, 16, 2); /* both too large */
    check_patches(200000, 2, 20000);
    check_patches(65, 256, 65);
    check_patches(500, 256, 3);
}

TEST(geom_layout_refuses_what_is_no_strand)
{
    geom_fixture f;
    geom_layout *layout = NULL;
    awt_error error = {0};
    geom_fixture_init(&f, 3, 4, 1);
    f.groom.info.points_per_strand = 1;
    CHECK_INT(geom_layout_create(&f.groom, NULL, &layout, &error), AWT_LIMIT);
    CHECK(layout == NULL);
    f.groom.info.points_per_strand = AWT_MAX_POINTS_PER_STRAND + 1;
    CHECK_INT(geom_layout_create(&f.groom, NULL, &layout, &error), AWT_LIMIT);
    CHECK(strstr(error.text, "257") != NULL);
    geom_fixture_fini(&f);
}

/* The JSON chunk of a frame. */
static json_document frame_json(const geom_buffer *frame)
{
    json_document json = {0};
    uint32_t size = 0;
    memcpy(&size, frame->bytes + 12, sizeof size);
    CHECK_INT(json_read((const char *)frame->bytes + 20, size, &json, NULL), AWT_OK);
    return json;
}

static void bounds_of(const float *vertices, size_t count, double least[3], double greatest[3])
{
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < 3; k++) {
            double value = (double)vertices[3 * i + k];
            least[k] = i == 0 ? value : fmin(least[k], value);
            greatest[k] = i == 0 ? value : fmax(greatest[k], value);
        }
    }
}

TEST(geom_min_and_max_are_those_of_the_decoded_positions_exactly)
{
    geom_fixture f;
    geom_strands back = {0};
    geom_fixture_init(&f, 3000, 16, 3);
    geom_fixture_encode(&f, NULL);
    json_document json = frame_json(&f.frame);
    CHECK_INT(geom_read_frame(f.frame.bytes, f.frame.size, &back, NULL), AWT_OK);
    CHECK_INT(back.patch_count, 3);
    uint32_t accessor = json_member(&json, 0, "accessors") + 1;
    for (uint32_t i = 0; back.vertices && i < f.layout->patch_count; i++) {
        uint32_t position = json.tokens[accessor].after; /* indices, then positions, of each patch */
        double least[3], greatest[3], got_least[3] = {0}, got_greatest[3] = {0};
        geom_patch patch = f.layout->patches[i];
        bounds_of(back.vertices + (size_t)patch.first_strand * 16 * 6, (size_t)patch.strands * 32, least, greatest);
        CHECK(json_reals(&json, json_member(&json, position, "min"), 3, got_least));
        CHECK(json_reals(&json, json_member(&json, position, "max"), 3, got_greatest));
        CHECK_BYTES(got_least, least, sizeof least);
        CHECK_BYTES(got_greatest, greatest, sizeof greatest);
        accessor = json.tokens[position].after;
    }
    json_fini(&json);
    geom_strands_fini(&back);
    geom_fixture_fini(&f);
}

TEST(geom_encoding_has_no_hidden_state)
{
    geom_fixture f;
    geom_fixture_init(&f, 2500, 16, 5);
    geom_fixture_encode(&f, NULL);
    geom_buffer first = f.frame;
    f.frame = (geom_buffer){0};
    float kept = f.points[100];
    f.points[100] += 0.01f;
    geom_fixture_encode(&f, NULL);
    CHECK(f.frame.size != first.size || memcmp(f.frame.bytes, first.bytes, first.size) != 0);
    f.points[100] = kept;
    geom_scratch *other = NULL;
    CHECK_INT(geom_scratch_create(f.layout, &other, NULL), AWT_OK);
    geom_fixture_encode(&f, NULL);
    CHECK_U64(f.frame.size, first.size);
    CHECK_BYTES(f.frame.bytes, first.bytes, first.size);
    const geom_frame_def def = geom_fixture_def(&f);
    CHECK_INT(geom_encode(f.layout, other, &def, &f.frame, NULL, NULL), AWT_OK);
    CHECK_U64(f.frame.size, first.size);
    CHECK_BYTES(f.frame.bytes, first.bytes, first.size);
    geom_scratch_destroy(other);
    geom_buffer_fini(&first);
    geom_fixture_fini(&f);
}

static void check_refuses_what_is_not_finite(const geom_layout_def *layout)
{
    const float bad[] = {NAN, INFINITY, -INFINITY};
    geom_fixture f;
    geom_fixture_init(&f, 40, 16, 2);
    geom_fixture_layout(&f, layout);
    for (size_t i = 0; i < 3; i++) {
        awt_error error = {0};
        geom_frame_def def = geom_fixture_def(&f);
        float kept = f.points[555];
        f.points[555] = bad[i];
        CHECK_INT(geom_encode(f.layout, f.scratch, &def, &f.frame, NULL, &error), AWT_BAD_VALUE);
        CHECK(strstr(error.text, "not a finite number") != NULL);
        f.points[555] = kept;
        def.head.position[1] = (double)bad[i];
        CHECK_INT(geom_encode(f.layout, f.scratch, &def, &f.frame, NULL, NULL), AWT_BAD_VALUE);
        def.head = geom_fixture_head;
        def.head.orientation[3] = (double)bad[i];
        CHECK_INT(geom_encode(f.layout, f.scratch, &def, &f.frame, NULL, NULL), AWT_BAD_VALUE);
    }
    geom_fixture_encode(&f, NULL); /* and the scratch is as good as new */
    geom_fixture_fini(&f);
}

TEST(geom_points_and_poses_that_are_not_finite_are_refused)
{
    for (int k = 0; k < 4; k++) {
        check_refuses_what_is_not_finite(
            &(geom_layout_def){.kind = k & 1 ? GEOM_STRANDS : GEOM_RIBBON, .stock = k >= 2});
    }
}

static void check_sets_onto_the_box(const geom_layout_def *layout)
{
    geom_fixture f;
    geom_frame_stats stats = {0};
    geom_strands back = {0};
    geom_fixture_init(&f, 40, 16, 2);
    geom_fixture_layout(&f, layout);
    geom_fixture_encode(&f, &stats);
    CHECK_INT(stats.clamped_points, 0);
    f.points[3 * 17] = 1e30f;
    f.points[3 * 40 + 1] = -7.0f;
    f.points[3 * 40 + 2] = 7.0f; /* the same point */
    geom_fixture_encode(&f, &stats);
    CHECK_INT(stats.clamped_points, 2);
    CHECK_INT(geom_read_frame(f.frame.bytes, f.frame.size, &back, NULL), AWT_OK);
    if (back.positions) {
        double step = draco_box_step(&f.layout->box);
        CHECK_NEAR(back.positions[3 * 17], f.groom.info.box_max[0], step);
        CHECK_NEAR(back.positions[3 * 40 + 1], f.groom.info.box_min[1], step);
        CHECK_NEAR(back.positions[3 * 40 + 2], f.groom.info.box_max[2], step);
    }
    geom_strands_fini(&back);
    geom_fixture_fini(&f);
}

TEST(geom_points_outside_the_box_are_set_onto_it_and_counted)
{
    for (int k = 0; k < 4; k++) {
        check_sets_onto_the_box(&(geom_layout_def){.kind = k & 1 ? GEOM_STRANDS : GEOM_RIBBON, .stock = k >= 2});
    }
}

/* Bytes of the first patch after its header and its two counts, and its triangles. */
static size_t bytes_after_counts(const geom_buffer *frame, uint32_t *triangles)
{
    glb_frame glb;
    size_t size = 0;
    *triangles = 0;
    if (glb_read(frame->bytes, frame->size, &glb, NULL) == AWT_OK) {
        const unsigned char *begin = glb.binary + glb.patches[0].offset, *p = begin + 11;
        for (int counts = 0; counts < 2; counts++) {
            while (*p++ & 0x80) {
            }
        }
        size = glb.patches[0].size - (size_t)(p - begin);
        *triangles = glb.patches[0].triangles;
        glb_frame_fini(&glb);
    }
    return size;
}

/* All points in one place are the best that hair can compress. */
static void check_padding(const geom_layout_def *layout, uint32_t expected_triangles)
{
    geom_fixture f;
    geom_strands back = {0};
    uint32_t triangles;
    geom_fixture_init(&f, 500, 16, 2);
    geom_fixture_layout(&f, layout);
    geom_fixture_encode(&f, NULL);
    CHECK(bytes_after_counts(&f.frame, &triangles) > 3 * triangles); /* usual hair needs no padding */
    for (uint32_t i = 0; i < 500 * 16 * 3; i++) {
        f.points[i] = 0.1f;
    }
    geom_fixture_encode(&f, NULL);
    CHECK_U64(bytes_after_counts(&f.frame, &triangles), 3 * triangles);
    CHECK_INT(triangles, expected_triangles);
    CHECK_INT(geom_read_frame(f.frame.bytes, f.frame.size, &back, NULL), AWT_OK);
    geom_strands_fini(&back);
    geom_fixture_fini(&f);
}

/* Our own ribbons have too many bits for that. */
TEST(geom_hair_that_compresses_too_well_for_decoders_is_padded_for_them)
{
    check_padding(&(geom_layout_def){.kind = GEOM_STRANDS}, 500 * 6);
    check_padding(&(geom_layout_def){.kind = GEOM_STRANDS, .stock = true}, 500 * 6);
    check_padding(&(geom_layout_def){.kind = GEOM_RIBBON, .stock = true}, 500 * 15 * 2);
}

TEST(geom_the_quantisation_box_passes_through_draco_unchanged)
{
    geom_fixture f;
    geom_fixture_init(&f, 10, 8, 1);
    geom_fixture_encode(&f, NULL);
    const draco_box *box = &f.layout->box;
    unsigned char parameters[17]; /* as the bitstream has them: origin, range, bits */
    memcpy(parameters, box->origin, 12);
    memcpy(parameters + 12, &box->range, 4);
    parameters[16] = GEOM_RIBBON_BITS;
    bool found = false;
    for (size_t i = 0; i + sizeof parameters <= f.frame.size; i++) {
        found = found || memcmp(f.frame.bytes + i, parameters, sizeof parameters) == 0;
    }
    CHECK(found);
    for (int k = 0; k < 3; k++) {
        CHECK(box->origin[k] < f.groom.info.box_min[k]);
        CHECK(box->origin[k] + box->range > f.groom.info.box_max[k]);
    }
    geom_fixture_fini(&f);
}

TEST(geom_hair_that_rests_decodes_to_the_same_bits_while_other_hair_moves)
{
    geom_fixture f;
    geom_strands before = {0}, after = {0};
    geom_fixture_init(&f, 400, 16, 4);
    geom_fixture_encode(&f, NULL);
    CHECK_INT(geom_read_frame(f.frame.bytes, f.frame.size, &before, NULL), AWT_OK);
    for (uint32_t i = 0; i < 200 * 16; i++) {
        f.points[3 * i] += 0.004f;
    }
    geom_fixture_encode(&f, NULL);
    CHECK_INT(geom_read_frame(f.frame.bytes, f.frame.size, &after, NULL), AWT_OK);
    if (before.vertices && after.vertices) {
        size_t moved = (size_t)200 * 16 * 6;
        CHECK(memcmp(after.vertices, before.vertices, moved * sizeof(float)) != 0);
        CHECK_BYTES(after.vertices + moved, before.vertices + moved, moved * sizeof(float));
    }
    geom_strands_fini(&before);
    geom_strands_fini(&after);
    geom_fixture_fini(&f);
}
