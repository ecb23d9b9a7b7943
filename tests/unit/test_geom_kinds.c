/* test_geom_kinds.c: what holds for frames of every kind and by either encoder. */
#include "check.h"

#include "base/rng.h"
#include "geom/layout.h"
#include "geom/read.h"
#include "unit/geom_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static geom_strands read_frame(const geom_buffer *frame)
{
    geom_strands back = {0};
    awt_error error = {0};
    CHECK_INT(geom_read_frame(frame->bytes, frame->size, &back, &error), AWT_OK);
    CHECK_TEXT(error.text, "");
    return back;
}

/* Centre lines within a step of what went in, and the same bits whichever encoder wrote them. */
static void check_kind(geom_kind kind, uint32_t strands, uint32_t per_strand, uint32_t trees)
{
    geom_fixture f;
    geom_frame_stats stats = {0};
    const size_t floats = (size_t)strands * per_strand * 3;
    geom_fixture_init(&f, strands, per_strand, trees);
    geom_fixture_layout(&f, &(geom_layout_def){.kind = kind});
    geom_fixture_encode(&f, &stats);
    geom_strands own = read_frame(&f.frame);
    const double step = draco_box_step(&f.layout->box);
    geom_fixture_layout(&f, &(geom_layout_def){.kind = kind, .stock = true});
    geom_fixture_encode(&f, NULL);
    geom_strands stock = read_frame(&f.frame);
    CHECK_INT(own.kind, kind);
    CHECK_INT(own.strand_count, strands);
    CHECK_INT(own.points_per_strand, per_strand);
    CHECK_INT(own.triangle_count, stats.triangles);
    CHECK(3 * stats.triangles >= stats.vertices); /* or decoders refuse it */
    CHECK_INT(stats.clamped_points, 0);
    CHECK_INT(stats.encoded_patches, own.patch_count);
    CHECK((own.vertices != NULL) == (kind == GEOM_RIBBON));
    if (own.positions && stock.positions) {
        double worst = 0;
        for (size_t i = 0; i < floats; i++) {
            worst = fmax(worst, fabs((double)own.positions[i] - (double)f.points[i]));
        }
        CHECK(worst <= (kind == GEOM_RIBBON ? step : 0.51 * step));
        CHECK(memcmp(own.positions, stock.positions, floats * sizeof(float)) == 0);
        CHECK(memcmp(own.widths, stock.widths, per_strand * sizeof(float)) == 0);
        CHECK_NEAR(own.widths[0], 2 * f.layout->half_width[0], 1e-9);
    }
    geom_strands_fini(&own);
    geom_strands_fini(&stock);
    geom_fixture_fini(&f);
}

TEST(geom_both_kinds_come_back_from_both_encoders_alike)
{
    const uint32_t per_strand[] = {2, 3, 4, 16, 32, 100, 256};
    for (size_t i = 0; i < sizeof per_strand / sizeof per_strand[0]; i++) {
        check_kind(GEOM_STRANDS, 1, per_strand[i], 1);
        check_kind(GEOM_STRANDS, 300, per_strand[i], 7);
        check_kind(GEOM_RIBBON, 1, per_strand[i], 1);
        check_kind(GEOM_RIBBON, 300, per_strand[i], 7);
    }
    check_kind(GEOM_STRANDS, 5000, 16, 40);
    check_kind(GEOM_STRANDS, 50000, 4, 200);
    check_kind(GEOM_RIBBON, 50000, 4, 200);
}

TEST(geom_frames_keep_their_positions_at_any_number_of_bits)
{
    for (int bits = GEOM_LEAST_BITS; bits <= GEOM_GREATEST_BITS; bits++) {
        geom_fixture f;
        geom_fixture_init(&f, 60, 16, 3);
        geom_fixture_layout(&f, &(geom_layout_def){.kind = GEOM_STRANDS, .bits = bits});
        geom_fixture_encode(&f, NULL);
        geom_strands back = read_frame(&f.frame);
        double step = draco_box_step(&f.layout->box), worst = 0;
        for (size_t i = 0; i < 60 * 16 * 3 && back.positions; i++) {
            worst = fmax(worst, fabs((double)back.positions[i] - (double)f.points[i]));
        }
        CHECK(worst > 0.4 * step && worst <= 0.51 * step);
        geom_strands_fini(&back);
        geom_fixture_fini(&f);
    }
    geom_fixture f;
    geom_layout *layout = NULL;
    geom_fixture_init(&f, 3, 4, 1);
    CHECK_INT(geom_layout_create(&f.groom, &(geom_layout_def){.bits = 7}, &layout, NULL), AWT_BAD_VALUE);
    CHECK_INT(geom_layout_create(&f.groom, &(geom_layout_def){.bits = 16}, &layout, NULL), AWT_BAD_VALUE);
    CHECK(layout == NULL);
    geom_fixture_fini(&f);
}

/* Moves the points of patch number `index` a little. */
static void move_patch(geom_fixture *f, uint32_t index, float by_m)
{
    geom_patch patch = geom_layout_patch(f->layout, index);
    const size_t a_strand = (size_t)f->groom.info.points_per_strand * 3;
    for (size_t i = 0; i < patch.strands * a_strand; i++) {
        f->points[patch.first_strand * a_strand + i] += by_m;
    }
}

/* Some patches kept from the frame before, the others encoded: the frame is the one that encoding all of it makes. */
static void check_kept(geom_kind kind)
{
    geom_fixture f;
    rng random = rng_seed(31);
    bool unchanged[20];
    geom_buffer before = {0}, kept = {0};
    geom_frame_stats stats;
    geom_fixture_init(&f, 18000, 8, 18);
    geom_fixture_layout(&f, &(geom_layout_def){.kind = kind});
    const uint32_t patches = geom_layout_patches(f.layout);
    CHECK_INT(patches, 9);
    for (int round = 0; round < 12; round++) {
        uint32_t moved = 0;
        geom_fixture_encode(&f, NULL);
        geom_buffer swap = before;
        before = f.frame;
        f.frame = swap;
        for (uint32_t i = 0; i < patches; i++) {
            unchanged[i] = round > 0 && (round == 1 || rng_u32(&random) % 3 > 0);
            moved += !unchanged[i];
            move_patch(&f, i, unchanged[i] ? 0 : 0.001f);
        }
        geom_frame_def def = geom_fixture_def(&f);
        def.unchanged = unchanged;
        def.previous = &before;
        def.time_us = -1 - round;
        CHECK_INT(geom_encode(f.layout, f.scratch, &def, &kept, &stats, NULL), AWT_OK);
        CHECK_INT(stats.encoded_patches, moved);
        def.unchanged = NULL;
        CHECK_INT(geom_encode(f.layout, f.scratch, &def, &f.frame, &stats, NULL), AWT_OK);
        CHECK_U64(kept.size, f.frame.size);
        CHECK(kept.size == f.frame.size && memcmp(kept.bytes, f.frame.bytes, kept.size) == 0);
    }
    geom_buffer_fini(&before);
    geom_buffer_fini(&kept);
    geom_fixture_fini(&f);
}

TEST(geom_patches_kept_from_the_frame_before_make_the_same_frame)
{
    check_kept(GEOM_RIBBON);
    check_kept(GEOM_STRANDS);
}

TEST(geom_patches_are_not_kept_from_a_frame_of_another_layout)
{
    geom_fixture f;
    const bool unchanged[1] = {true};
    awt_error error = {0};
    geom_buffer other = {0}, none = {0};
    geom_fixture_init(&f, 20, 8, 1);
    geom_fixture_layout(&f, &(geom_layout_def){.kind = GEOM_STRANDS});
    geom_fixture_encode(&f, NULL);
    other = f.frame;
    f.frame = (geom_buffer){0};
    geom_fixture_layout(&f, NULL);
    geom_frame_def def = geom_fixture_def(&f);
    def.unchanged = unchanged;
    CHECK_INT(geom_encode(f.layout, f.scratch, &def, &f.frame, NULL, &error), AWT_BAD_VALUE);
    def.previous = &other;
    CHECK_INT(geom_encode(f.layout, f.scratch, &def, &f.frame, NULL, &error), AWT_BAD_VALUE);
    CHECK(strstr(error.text, "none of this layout") != NULL);
    def.previous = &none;
    CHECK_INT(geom_encode(f.layout, f.scratch, &def, &f.frame, NULL, &error), AWT_BAD_VALUE);
    geom_fixture_layout(&f, &(geom_layout_def){.stock = true});
    def.previous = &other;
    CHECK_INT(geom_encode(f.layout, f.scratch, &def, &f.frame, NULL, &error), AWT_BAD_VALUE);
    geom_buffer_fini(&other);
    geom_fixture_fini(&f);
}

/* Poses and times that need every digit, and few. */
TEST(geom_every_pose_and_time_comes_back_to_the_bit)
{
    const awt_pose poses[] = {{{0, 0, 0}, {0, 0, 0, 1}},
                              {{-1.2345678901234567e-300, 1.7976931348623157e308, -5e-324}, {0.6, 0, -0.8, 0}},
                              {{-123456.78901234567, 0.1, 1e22}, {-0.5, 0.5, -0.5, 0.5}}};
    const int64_t times_us[] = {0, -1, INT64_C(9007199254740992), INT64_C(-9007199254740992), 1000000};
    geom_fixture f;
    geom_fixture_init(&f, 3, 4, 1);
    for (size_t p = 0; p < 3; p++) {
        for (size_t t = 0; t < 5; t++) {
            geom_frame_def def = geom_fixture_def(&f);
            def.head = poses[p];
            def.time_us = times_us[t];
            CHECK_INT(geom_encode(f.layout, f.scratch, &def, &f.frame, NULL, NULL), AWT_OK);
            geom_strands back = read_frame(&f.frame);
            CHECK_BYTES(back.head.position, poses[p].position, sizeof back.head.position);
            CHECK_BYTES(back.head.orientation, poses[p].orientation, sizeof back.head.orientation);
            CHECK(back.time_us == times_us[t]);
            geom_strands_fini(&back);
        }
    }
    geom_fixture_fini(&f);
}

static void check_cut_and_damaged(geom_kind kind, uint32_t attributes)
{
    geom_fixture f;
    rng random = rng_seed(32);
    int read = 0;
    geom_fixture_init(&f, 24, 8, 2);
    geom_fixture_layout(&f, &(geom_layout_def){.kind = kind, .attributes = attributes});
    geom_fixture_encode(&f, NULL);
    unsigned char *copy = malloc(f.frame.size);
    for (size_t size = 12; size < f.frame.size; size++) { /* with a header that agrees */
        uint32_t length = (uint32_t)size;
        geom_strands strands;
        unsigned char *cut = malloc(size);
        memcpy(cut, f.frame.bytes, size);
        memcpy(cut + 8, &length, 4);
        CHECK_INT(geom_read_frame(cut, size, &strands, NULL), AWT_BAD_FORMAT);
        free(cut);
    }
    for (int round = 0; round < 2000; round++) {
        geom_strands strands = {0};
        memcpy(copy, f.frame.bytes, f.frame.size);
        for (uint32_t flips = 1 + rng_u32(&random) % 4; flips > 0; flips--) {
            copy[rng_u32(&random) % f.frame.size] = (unsigned char)rng_u32(&random);
        }
        bool taken = geom_read_frame(copy, f.frame.size, &strands, NULL) == AWT_OK;
        for (size_t i = 0; taken && i < 24 * 8 * 3; i++) {
            CHECK(isfinite(strands.positions[i]));
        }
        read += taken;
        geom_strands_fini(&strands);
    }
    CHECK(read > 0 && read < 2000);
    free(copy);
    geom_fixture_fini(&f);
}

TEST(geom_frames_of_both_kinds_cut_short_or_damaged_do_no_harm)
{
    check_cut_and_damaged(GEOM_RIBBON, 0);
    check_cut_and_damaged(GEOM_STRANDS, 0);
    check_cut_and_damaged(GEOM_STRANDS, GEOM_ATTRIBUTE_STRAND | GEOM_ATTRIBUTE_WIDTH);
}
