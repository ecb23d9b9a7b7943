/* test_geom_guides.c: guides and the binding that makes strands of them again. */
#include "check.h"

#include "base/rng.h"
#include "geom/guides.h"
#include "geom/layout.h"
#include "geom/numbers.h"
#include "geom/receive.h"
#include "unit/fixture.h"
#include "unit/groom_fixture.h"
#include "unit/guides_fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ALLOWED_M 0.2e-3

static const char *const styles[] = {"short", "short-curly", "long", "long-curly"};

TEST(geom_numbers_come_back_whatever_they_are)
{
    rng random = rng_seed(41);
    for (int bits = 2; bits <= 15; bits++) {
        const int reach = 1 << (bits - 1);
        int16_t numbers[300], back[300];
        uint16_t symbols[300];
        for (int i = 0; i < 300; i++) {
            int number = (int)(rng_u32(&random) % (uint32_t)(2 * reach)) - reach;
            numbers[i] = (int16_t)(i % 7 == 0 ? -reach : i % 7 == 1 ? reach - 1 : number);
        }
        CHECK(numbers_differences(bits, numbers, 100, symbols) < 1 << bits);
        CHECK(numbers_sum_up(bits, symbols, 100, back));
        CHECK_BYTES(back, numbers, sizeof numbers);
        symbols[37] = (uint16_t)(1 << bits);
        CHECK(!numbers_sum_up(bits, symbols, 100, back));
    }
}

/* The whole way of a clip's liveliest seconds, every form, each delta to the frame before. */
static void check_clip(guides_fixture *f, const char *clip, int frames)
{
    for (int n = 1; n <= frames; n++) {
        guides_fixture_move(f, clip, INT64_C(1000000) + (int64_t)n * 100000);
        for (int form = 0; form < GUIDES_FORMS; form++) {
            geom_frame_stats stats;
            double greatest, mean;
            guides_fixture_encode(f, form, &stats);
            guides_fixture_compare(f, form, &greatest, &mean);
            CHECK_INT(stats.clamped_points, 0);
            CHECK_INT(stats.vertices, f->info.finest_nodes);
            CHECK(form != GUIDES_MESHES || 3 * stats.triangles >= stats.vertices); /* or decoders refuse it */
            CHECK_NEAR(greatest, 0, ALLOWED_M);
            CHECK_NEAR(mean, 0, 0.35 * ALLOWED_M);
        }
        guides_fixture_keep(f);
    }
}

TEST(geom_guides_make_the_servers_strands_within_a_fifth_of_a_millimetre)
{
    for (size_t s = 0; s < 4; s++) {
        guides_fixture f;
        guides_fixture_init(&f, fixture_groom(styles[s], 2000), styles[s]);
        check_clip(&f, s % 2 ? "shake" : "lean", 15);
        guides_fixture_fini(&f);
    }
}

/* A turn of more than half round, and numbers of turns that no section has. */
TEST(geom_guides_turn_all_the_way_round)
{
    guides_fixture f;
    guides_fixture_init(&f, fixture_groom("long", 2000), "long");
    rng random = rng_seed(42);
    for (uint32_t n = 0; n < f.info.finest_nodes; n++) {
        quat q = {0};
        float *parts[4] = {&q.x, &q.y, &q.z, &q.w};
        for (int k = 0; k < 4; k++) {
            *parts[k] = (float)rng_between(&random, -1, 1);
        }
        q = quat_unit(q);
        memcpy(f.frames + 4 * n, &q, sizeof q);
    }
    for (int form = 0; form < GUIDES_FORMS; form++) {
        geom_guides back = {0};
        double worst = 0;
        guides_fixture_encode(&f, form, NULL);
        CHECK_INT(form == GUIDES_MESHES ? geom_read_guides(f.binding, f.frame.bytes, f.frame.size, &back, NULL)
                                        : geom_read_guides_delta(f.reader, f.binding, f.frame.bytes, f.frame.size,
                                                                 &f.base_got, f.base_sequence, &back, NULL),
                  AWT_OK);
        for (uint32_t n = 0; back.frames && n < f.info.finest_nodes; n++) {
            const float *a = f.frames + 4 * n, *b = back.frames + 4 * n;
            double dot = fabs((double)a[0] * b[0] + (double)a[1] * b[1] + (double)a[2] * b[2] + (double)a[3] * b[3]);
            worst = fmax(worst, 1 - dot);
        }
        /* 1 - cos of half an angle of five steps of a milliradian: four of them where a turn keeps its side */
        CHECK_NEAR(worst, 0, 0.5 * 0.0025 * 0.0025);
        geom_guides_fini(&back);
    }
    guides_fixture_fini(&f);
}

TEST(geom_guides_of_few_strands_and_of_few_or_many_points)
{
    const uint32_t points[] = {2, 3, 16, 32, 100};
    const uint32_t strands[] = {1, 2, 40};
    for (size_t s = 0; s < 3; s++) {
        awt_strands patch = groom_fixture_patch(strands[s]);
        for (size_t p = 0; p < sizeof points / sizeof points[0]; p++) {
            awt_groom_def def = awt_groom_def_default();
            guides_fixture f;
            def.points_per_strand = points[p];
            def.sections = p == 0 ? 2 : 0;
            awt_groom *groom = groom_fixture_build(&patch, &def);
            guides_fixture_init(&f, groom, NULL);
            check_clip(&f, "lean", 3);
            guides_fixture_fini(&f);
            awt_groom_destroy(groom);
        }
        awt_strands_fini(&patch);
    }
}

/* The receiver takes the other kinds, too, to the bit as the reader with libdraco behind it. */
TEST(geom_receivers_take_every_kind)
{
    guides_fixture f;
    guides_fixture_init(&f, fixture_groom("long", 2000), "long");
    for (int kind = GEOM_RIBBON; kind <= GEOM_STRANDS; kind++) {
        const geom_layout_def def = {.kind = (geom_kind)kind};
        const geom_frame_def frame = {.points = f.points, .head = awt_forest_head(f.forest)};
        geom_layout *layout = NULL;
        geom_scratch *scratch = NULL;
        geom_strands read = {0}, received = {0};
        CHECK_INT(geom_layout_create(f.groom, &def, &layout, NULL), AWT_OK);
        CHECK_INT(geom_scratch_create(layout, &scratch, NULL), AWT_OK);
        CHECK_INT(geom_encode(layout, scratch, &frame, &f.frame, NULL, NULL), AWT_OK);
        CHECK_INT(geom_read_frame(f.frame.bytes, f.frame.size, &read, NULL), AWT_OK);
        CHECK_INT(geom_receive_frame(NULL, f.frame.bytes, f.frame.size, &received, NULL), AWT_OK);
        CHECK_BYTES(received.positions, read.positions, (size_t)read.strand_count * read.points_per_strand * 12);
        CHECK_INT(received.kind, kind);
        CHECK_INT(geom_read_guides(f.binding, f.frame.bytes, f.frame.size, &(geom_guides){0}, NULL), AWT_BAD_FORMAT);
        geom_strands_fini(&read);
        geom_strands_fini(&received);
        geom_scratch_destroy(scratch);
        geom_layout_destroy(layout);
    }
    guides_fixture_fini(&f);
}

TEST(geom_guides_are_not_evaluated_with_another_binding)
{
    guides_fixture f, other;
    geom_strands strands = {0};
    awt_error error = {0};
    guides_fixture_init(&f, fixture_groom("long", 2000), "long");
    guides_fixture_init(&other, fixture_groom("long", 2001), "long"); /* alike but for its numbers */
    CHECK_INT(other.info.finest_nodes, f.info.finest_nodes);
    guides_fixture_encode(&f, GUIDES_MESHES, NULL);
    CHECK_INT(geom_receive_frame(other.binding, f.frame.bytes, f.frame.size, &strands, &error), AWT_BAD_VALUE);
    CHECK(strstr(error.text, "another binding") != NULL);
    CHECK_INT(geom_receive_frame(NULL, f.frame.bytes, f.frame.size, &strands, &error), AWT_BAD_VALUE);
    CHECK_INT(geom_read_frame(f.frame.bytes, f.frame.size, &strands, &error), AWT_BAD_VALUE);
    for (int form = GUIDES_WHOLE; form < GUIDES_FORMS; form++) {
        geom_guides back = {0};
        guides_fixture_encode(&f, form, NULL);
        CHECK_INT(geom_read_guides_delta(f.reader, other.binding, f.frame.bytes, f.frame.size, &f.base_got,
                                         f.base_sequence, &back, &error),
                  AWT_BAD_VALUE);
        CHECK(strstr(error.text, "another binding") != NULL);
        CHECK(back.centres == NULL);
    }
    CHECK_INT(geom_receive_frame(f.binding, f.frame.bytes, f.frame.size, &strands, &error), AWT_BAD_FORMAT);
    CHECK(strands.positions == NULL);
    guides_fixture_fini(&other);
    guides_fixture_fini(&f);
}

TEST(geom_guides_refuse_what_is_not_finite)
{
    guides_fixture f;
    guides_fixture_init(&f, fixture_groom("long", 2000), "long");
    geom_frame_def def = {.points = f.centres, .frames = f.frames, .head = awt_forest_head(f.forest)};
    geom_quantise_def quantise = {.points = f.centres, .frames = f.frames};
    uint32_t clamped = 0;
    float *numbers[] = {f.centres + 50, f.frames + 50};
    for (int k = 0; k < 6; k++) {
        const float wild[] = {NAN, INFINITY, 1e30f}, kept = *numbers[k % 2];
        *numbers[k % 2] = wild[k / 2];
        if (k != 4) { /* a centre that is only far is set onto the box */
            CHECK_INT(geom_encode(f.layout, f.encoder, &def, &f.frame, NULL, NULL), AWT_BAD_VALUE);
            CHECK_INT(geom_quantise(f.layout, &quantise, f.now, &clamped, NULL), AWT_BAD_VALUE);
        }
        *numbers[k % 2] = kept;
    }
    def.frames = quantise.frames = NULL;
    CHECK_INT(geom_encode(f.layout, f.encoder, &def, &f.frame, NULL, NULL), AWT_BAD_VALUE);
    CHECK_INT(geom_quantise(f.layout, &quantise, f.now, &clamped, NULL), AWT_BAD_VALUE);
    geom_layout *layout = NULL;
    const geom_layout_def bits = {.kind = GEOM_GUIDES, .bits = 12}, stock = {.kind = GEOM_GUIDES, .stock = true};
    CHECK_INT(geom_layout_create(f.groom, &bits, &layout, NULL), AWT_BAD_VALUE);
    CHECK_INT(geom_layout_create(f.groom, &stock, &layout, NULL), AWT_BAD_VALUE);
    CHECK_INT(geom_layout_create(f.groom, &(geom_layout_def){.kind = GEOM_NODES}, &layout, NULL), AWT_BAD_VALUE);
    guides_fixture_fini(&f);
}

/* Sections far from where the others would have them: the numbers end, and it is counted. */
TEST(geom_guides_count_what_no_number_reaches)
{
    guides_fixture f;
    geom_frame_stats stats;
    guides_fixture_init(&f, fixture_groom("long", 2000), "long");
    f.centres[3 * 100] += 5;
    guides_fixture_encode(&f, GUIDES_WHOLE, &stats);
    CHECK(stats.clamped_points >= 1);
    guides_fixture_encode(&f, GUIDES_MESHES, &stats);
    CHECK_INT(stats.clamped_points, 1);
    guides_fixture_fini(&f);
}

/* Patches of trees at rest keep their bytes. */
TEST(geom_guides_keep_patches_that_rest)
{
    guides_fixture f;
    geom_buffer kept = {0};
    guides_fixture_init(&f, fixture_groom("long-curly", 10000), "long-curly");
    const uint32_t patches = geom_layout_patches(f.layout);
    bool unchanged[64] = {false};
    CHECK(patches >= 1 && patches <= 64);
    guides_fixture_encode(&f, GUIDES_MESHES, NULL);
    for (uint32_t i = 0; i < patches; i++) {
        unchanged[i] = i % 2 == 0;
    }
    const geom_frame_def def = {.points = f.centres,
                                .frames = f.frames,
                                .head = awt_forest_head(f.forest),
                                .time_us = awt_forest_time(f.forest),
                                .unchanged = unchanged,
                                .previous = &f.frame};
    geom_frame_stats stats;
    CHECK_INT(geom_encode(f.layout, f.encoder, &def, &kept, &stats, NULL), AWT_OK);
    CHECK_INT(stats.encoded_patches, patches / 2);
    CHECK_U64(kept.size, f.frame.size);
    CHECK(kept.size == f.frame.size && memcmp(kept.bytes, f.frame.bytes, kept.size) == 0);
    geom_buffer_fini(&kept);
    guides_fixture_fini(&f);
}

/* ---- for the checks of tests/node */

/* The turns of `frame`, of its one patch. */
static void write_turns(const guides_fixture *f, const char *folder, const char *name)
{
    const size_t nodes = f->info.finest_nodes;
    const guides_part all = {0, f->binding->wisps};
    int16_t *turns = calloc(3 * nodes, sizeof *turns);
    CHECK_INT(geom_layout_patches(f->layout), 1);
    CHECK(guides_turns(f->binding, all, (const quat *)(const void *)f->frames, turns));
    check_write_file(folder, name, ".i16", turns, 3 * nodes * sizeof *turns);
    free(turns);
}

/* `name` says the form by its ending: .glb, .whole or .delta. */
static void write_frame(guides_fixture *f, int form, const char *folder, const char *name)
{
    const size_t floats = (size_t)f->info.strand_count * f->info.points_per_strand * 3;
    geom_strands received = {0};
    guides_fixture_encode(f, form, NULL);
    CHECK_INT(guides_fixture_receive(f, form, &received, NULL), AWT_OK);
    check_write_file(folder, name, "", f->frame.bytes, f->frame.size);
    check_write_file(folder, name, ".strands.f32", f->points, floats * sizeof(float));
    check_write_file(folder, name, ".received.f32", received.positions, floats * sizeof(float));
    if (form == GUIDES_MESHES) {
        check_write_file(folder, name, ".f32", f->centres, 3 * (size_t)f->info.finest_nodes * sizeof(float));
        write_turns(f, folder, name);
    }
    geom_strands_fini(&received);
}

/* Frame n + 1 as a delta has frame n as its base. */
static void write_clip(const char *folder, const char *name, const awt_groom *groom, const char *style)
{
    static const char *const endings[GUIDES_FORMS] = {"glb", "whole", "delta"};
    guides_fixture f;
    char file[80];
    guides_fixture_init(&f, groom, style);
    check_write_file(folder, name, ".awtb", f.binding_bytes, f.binding_size);
    for (int n = 0; n < 4; n++) {
        guides_fixture_move(&f, "lean", INT64_C(1500000) + n * INT64_C(300000));
        for (int form = 0; form < (n > 0 ? GUIDES_FORMS : GUIDES_DELTA); form++) {
            snprintf(file, sizeof file, "%s-%d.%s", name, n, endings[form]);
            write_frame(&f, form, folder, file);
        }
        guides_fixture_keep(&f);
    }
    guides_fixture_fini(&f);
}

TEST(geom_guides_for_other_receivers)
{
    const char *folder = getenv("AWT_FRAMES");
    if (!folder) {
        check_skip("AWT_FRAMES names no folder to write frames to, for tests/node/check_receiver.mjs");
        return;
    }
    for (size_t s = 0; s < 4; s++) {
        char name[32]; /* a name that begins with another's would take its frames */
        snprintf(name, sizeof name, "style%zu", s);
        write_clip(folder, name, fixture_groom(styles[s], 10000), styles[s]);
    }
    const uint32_t points[] = {2, 3, 16, 32, 100};
    for (size_t p = 0; p < sizeof points / sizeof points[0]; p++) {
        awt_groom_def def = awt_groom_def_default();
        char name[32];
        awt_strands patch = groom_fixture_patch(p % 2 ? 1 : 40);
        def.points_per_strand = points[p];
        awt_groom *groom = groom_fixture_build(&patch, &def);
        snprintf(name, sizeof name, "patch%zu", p);
        write_clip(folder, name, groom, NULL);
        awt_groom_destroy(groom);
        awt_strands_fini(&patch);
    }
}
