/* test_geom_level.c: levels: which strands they have, what these are made of, and how wide they are. */
#include "check.h"

#include "geom/layout.h"
#include "geom/read.h"
#include "unit/fixture.h"
#include "unit/geom_fixture.h"
#include "unit/groom_fixture.h"
#include "unit/guides_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEVELS = 3 };

/* A layout, an encoder, and the points of its level. */
typedef struct level_fixture {
    geom_layout *layout;
    geom_scratch *scratch;
    float *points;
    geom_buffer frame;
} level_fixture;

static void level_fixture_init(level_fixture *l, const awt_groom *groom, const geom_layout_def *def)
{
    *l = (level_fixture){0};
    CHECK_INT(geom_layout_create(groom, def, &l->layout, NULL), AWT_OK);
    CHECK_INT(geom_scratch_create(l->layout, &l->scratch, NULL), AWT_OK);
    l->points = calloc((size_t)geom_layout_strands(l->layout) * l->layout->points_per_strand, 3 * sizeof(float));
}

static void level_fixture_fini(level_fixture *l)
{
    geom_buffer_fini(&l->frame);
    geom_scratch_destroy(l->scratch);
    geom_layout_destroy(l->layout);
    free(l->points);
}

static geom_strands encode_and_read(level_fixture *l)
{
    geom_strands back = {0};
    awt_error error = {0};
    const geom_frame_def def = {.points = l->points, .head = geom_fixture_head};
    geom_frame_stats stats = {0};
    CHECK_INT(geom_encode(l->layout, l->scratch, &def, &l->frame, &stats, &error), AWT_OK);
    CHECK_TEXT(error.text, "");
    CHECK_INT(stats.clamped_points, 0);
    CHECK_INT(geom_read_frame(l->frame.bytes, l->frame.size, &back, &error), AWT_OK);
    CHECK_TEXT(error.text, "");
    return back;
}

/* Counts; that numbers rise; that each wisp with a strand of `fifth` has its strand of `guides` there. */
static void check_numbers(const awt_groom *groom, const geom_layout *layout, const geom_layout *guides)
{
    const geom_level level = layout->level.level;
    const uint32_t wisps = groom->info.wisp_count[groom->info.levels - 1], full = groom->info.strand_count;
    const uint32_t expected = level == GEOM_LEVEL_FULL ? full : level == GEOM_LEVEL_FIFTH ? (full + 4) / 5 : wisps;
    CHECK_INT(geom_layout_strands(layout), expected);
    uint32_t at = 0, wrong = 0;
    for (uint32_t g = 0; g < wisps; g++) {
        const uint32_t after = groom->gc_strand_first[g + 1], guide = geom_layout_strand(guides, g);
        bool guided = false, any = false;
        wrong += guide < groom->gc_strand_first[g] || guide >= after;
        for (; at < expected && geom_layout_strand(layout, at) < after; at++) {
            wrong += at > 0 && geom_layout_strand(layout, at) <= geom_layout_strand(layout, at - 1);
            guided = guided || geom_layout_strand(layout, at) == guide;
            any = true;
        }
        wrong += any && !guided;
    }
    CHECK_INT(wrong, 0);
    CHECK_INT(at, expected);
}

/* Each strand's floats are those of the same strand in the full hair, to the bit. */
static uint32_t strands_that_differ(const geom_layout *layout, const float *points, const float *full)
{
    const size_t a_strand = 3 * (size_t)layout->points_per_strand;
    uint32_t wrong = 0;
    for (uint32_t s = 0; s < geom_layout_strands(layout); s++) {
        const float *there = full + geom_layout_strand(layout, s) * a_strand;
        wrong += memcmp(points + s * a_strand, there, a_strand * sizeof *points) != 0;
    }
    return wrong;
}

/* Points evaluated alone, and frames of them, against the full hair's. */
static void check_level(guides_fixture *f, geom_level level, const geom_layout *guides, const geom_strands *full)
{
    level_fixture l;
    level_fixture_init(&l, f->groom, &(geom_layout_def){.kind = GEOM_STRANDS, .level = level});
    check_numbers(f->groom, l.layout, guides);
    geom_layout_evaluate(l.layout, f->groom, NULL, f->centres, f->frames, f->scratch, l.points);
    CHECK_INT(strands_that_differ(l.layout, l.points, f->points), 0);
    geom_strands back = encode_and_read(&l);
    CHECK_INT(back.level, level);
    CHECK_INT(back.strand_count, geom_layout_strands(l.layout));
    CHECK_INT(back.full_strand_count, f->info.strand_count);
    CHECK(back.positions && strands_that_differ(l.layout, back.positions, full->positions) == 0);
    geom_strands_fini(&back);
    level_fixture_fini(&l);
}

static void check_hair(const awt_groom *groom, const char *style)
{
    guides_fixture f;
    level_fixture all, guides;
    guides_fixture_init(&f, groom, style);
    guides_fixture_move(&f, "lean", 1200000);
    level_fixture_init(&all, groom, &(geom_layout_def){.kind = GEOM_STRANDS});
    level_fixture_init(&guides, groom, &(geom_layout_def){.kind = GEOM_STRANDS, .level = GEOM_LEVEL_GUIDES});
    memcpy(all.points, f.points, (size_t)f.info.strand_count * f.info.points_per_strand * 3 * sizeof(float));
    geom_strands full = encode_and_read(&all);
    for (int level = 0; level < LEVELS; level++) {
        check_level(&f, (geom_level)level, guides.layout, &full);
    }
    geom_strands_fini(&full);
    level_fixture_fini(&guides);
    level_fixture_fini(&all);
    guides_fixture_fini(&f);
}

TEST(geom_levels_have_strands_of_the_full_hair_to_the_bit)
{
    check_hair(fixture_groom("long", 2000), "long");
    const uint32_t strands[] = {1, 2, 7, 100};
    for (size_t s = 0; s < sizeof strands / sizeof strands[0]; s++) {
        awt_strands patch = groom_fixture_patch(strands[s]);
        awt_groom_def def = awt_groom_def_default();
        awt_groom *groom = groom_fixture_build(&patch, &def);
        check_hair(groom, NULL);
        awt_groom_destroy(groom);
        awt_strands_fini(&patch);
    }
}

/* The strand of `guides` is the one with the least sum of squared offsets. */
TEST(geom_guide_strands_are_nearest_to_their_wisps_centre_line)
{
    const awt_groom *groom = fixture_groom("long", 2000);
    const size_t floats = 3 * (size_t)groom->info.points_per_strand;
    level_fixture l;
    level_fixture_init(&l, groom, &(geom_layout_def){.kind = GEOM_STRANDS, .level = GEOM_LEVEL_GUIDES});
    for (uint32_t g = 0; g < geom_layout_strands(l.layout); g++) {
        double least = INFINITY, chosen = 0;
        for (uint32_t s = groom->gc_strand_first[g]; s < groom->gc_strand_first[g + 1]; s++) {
            double sum = 0;
            for (size_t i = 0; i < floats; i++) {
                sum += (double)groom->strand_offset[s * floats + i] * (double)groom->strand_offset[s * floats + i];
            }
            least = fmin(least, sum);
            chosen = s == geom_layout_strand(l.layout, g) ? sum : chosen;
        }
        CHECK_NEAR(chosen, least, 1e-5 * least);
    }
    level_fixture_fini(&l);
}

/* Cross-section times strands is the same at every level, and ribbons are where their strands are. */
TEST(geom_levels_keep_the_volume_of_the_hair)
{
    geom_fixture f;
    geom_fixture_init(&f, 3000, 9, 150);
    double volume[LEVELS];
    for (int level = 0; level < LEVELS; level++) {
        level_fixture l;
        level_fixture_init(&l, &f.groom, &(geom_layout_def){.kind = GEOM_RIBBON, .level = (geom_level)level});
        for (uint32_t s = 0; s < geom_layout_strands(l.layout); s++) {
            memcpy(l.points + 27 * (size_t)s, f.points + 27 * (size_t)geom_layout_strand(l.layout, s),
                   27 * sizeof(float));
        }
        geom_strands back = encode_and_read(&l);
        const double step = draco_box_step(&l.layout->box);
        double worst = 0;
        for (size_t i = 0; back.positions && i < 27 * (size_t)back.strand_count; i++) {
            worst = fmax(worst, fabs((double)back.positions[i] - (double)l.points[i]));
        }
        CHECK_NEAR(worst, 0, step);
        CHECK_INT(back.level, level);
        CHECK_INT(back.full_strand_count, 3000);
        volume[level] = (double)back.strand_count * (double)back.widths[4] * (double)back.widths[4];
        CHECK_NEAR(volume[level], volume[0], 1e-5 * volume[0]);
        geom_strands_fini(&back);
        level_fixture_fini(&l);
    }
    geom_fixture_fini(&f);
}

/* A patch of a level ends where a tree ends. */
TEST(geom_patches_of_levels_are_whole_trees)
{
    geom_fixture f;
    geom_fixture_init(&f, 50000, 16, 90);
    for (int level = 0; level < LEVELS; level++) {
        level_fixture l;
        level_fixture_init(&l, &f.groom, &(geom_layout_def){.kind = GEOM_STRANDS, .level = (geom_level)level});
        uint32_t next = 0;
        for (uint32_t i = 0; i < geom_layout_patches(l.layout); i++) {
            const geom_patch patch = geom_layout_patch(l.layout, i);
            CHECK_INT(patch.first_strand, next);
            next += patch.strands;
            uint32_t last = geom_layout_strand(l.layout, next - 1), tree = 0;
            while (f.groom.gc_strand_first[tree + 1] <= last) {
                tree++;
            }
            CHECK(next == geom_layout_strands(l.layout) ||
                  geom_layout_strand(l.layout, next) >= f.groom.gc_strand_first[tree + 1]);
        }
        CHECK_INT(next, geom_layout_strands(l.layout));
        level_fixture_fini(&l);
    }
    geom_fixture_fini(&f);
}

/* Strands of every third top-level wisp alone; the points of all others stay the zeros that they were. */
TEST(geom_levels_bring_up_to_date_what_moved)
{
    guides_fixture f;
    guides_fixture_init(&f, fixture_groom("long", 2000), "long");
    const uint32_t trees = f.info.wisp_count[0];
    bool *moved = calloc(trees, sizeof *moved);
    for (uint32_t t = 0; t < trees; t += 3) {
        moved[t] = true;
    }
    for (int level = 0; level < LEVELS; level++) {
        level_fixture l;
        level_fixture_init(&l, f.groom, &(geom_layout_def){.kind = GEOM_STRANDS, .level = (geom_level)level});
        const size_t a_strand = 3 * (size_t)l.layout->points_per_strand;
        uint32_t wrong = 0, named = 0, g = 0;
        geom_layout_evaluate(l.layout, f.groom, moved, f.centres, f.frames, f.scratch, l.points);
        for (uint32_t s = 0; s < geom_layout_strands(l.layout); s++) {
            const uint32_t number = geom_layout_strand(l.layout, s);
            while (f.groom->gc_strand_first[g + 1] <= number) {
                g++;
            }
            const bool there = l.points[s * a_strand] != 0; /* all were zero */
            const bool wanted = moved[f.groom->gc_tree[groom_finest_first(f.groom) + g]];
            named += wanted;
            wrong += there != wanted;
        }
        CHECK_INT(wrong, 0);
        CHECK(named > 0 && named < geom_layout_strands(l.layout));
        level_fixture_fini(&l);
    }
    free(moved);
    guides_fixture_fini(&f);
}

static awt_status read_delta(geom_delta_reader *reader, const geom_buffer *delta, const geom_strands *base,
                             geom_strands *out)
{
    return geom_read_delta(reader, delta->bytes, delta->size, base, 1, out, NULL);
}

/* What a receiver makes of the frame before and the delta is the frame that would have come whole. */
static void check_deltas(guides_fixture *f, geom_level level)
{
    level_fixture l;
    geom_quantised *base = NULL, *now = NULL;
    geom_delta_reader *reader = NULL;
    geom_buffer delta = {0};
    geom_strands out = {0};
    uint32_t clamped = 0;
    level_fixture_init(&l, f->groom, &(geom_layout_def){.kind = GEOM_STRANDS, .level = level});
    CHECK_INT(geom_quantised_create(l.layout, &base, NULL), AWT_OK);
    CHECK_INT(geom_quantised_create(l.layout, &now, NULL), AWT_OK);
    CHECK_INT(geom_delta_reader_create(&reader, NULL), AWT_OK);
    const geom_quantise_def quantise = {.points = l.points};
    geom_layout_evaluate(l.layout, f->groom, NULL, f->centres, f->frames, f->scratch, l.points);
    CHECK_INT(geom_quantise(l.layout, &quantise, base, &clamped, NULL), AWT_OK);
    geom_strands before = encode_and_read(&l);
    guides_fixture_move(f, "lean", awt_forest_time(f->forest) + 50000);
    geom_layout_evaluate(l.layout, f->groom, NULL, f->centres, f->frames, f->scratch, l.points);
    CHECK_INT(geom_quantise(l.layout, &quantise, now, &clamped, NULL), AWT_OK);
    geom_strands whole = encode_and_read(&l);
    const geom_delta_def def = {.base = base, .now = now, .base_sequence = 1, .sequence = 2, .head = geom_fixture_head};
    CHECK_INT(geom_encode_delta(l.layout, l.scratch, &def, &delta, NULL, NULL), AWT_OK);
    CHECK_INT(read_delta(reader, &delta, &before, &out), AWT_OK);
    CHECK_INT(out.level, level);
    CHECK_INT(out.full_strand_count, f->info.strand_count);
    const size_t size = (size_t)whole.strand_count * whole.points_per_strand * 3 * sizeof(float);
    CHECK(out.positions && memcmp(out.positions, whole.positions, size) == 0);
    CHECK(memcmp(before.positions, whole.positions, size) != 0);
    geom_strands_fini(&before);
    geom_strands_fini(&whole);
    geom_strands_fini(&out);
    geom_buffer_fini(&delta);
    geom_delta_reader_destroy(reader);
    geom_quantised_destroy(base);
    geom_quantised_destroy(now);
    level_fixture_fini(&l);
}

TEST(geom_deltas_go_from_frame_to_frame_at_every_level)
{
    guides_fixture f;
    guides_fixture_init(&f, fixture_groom("long", 2000), "long");
    guides_fixture_move(&f, "lean", 1200000);
    for (int level = 0; level < LEVELS; level++) {
        check_deltas(&f, (geom_level)level);
    }
    guides_fixture_fini(&f);
}

TEST(geom_levels_that_are_none_are_refused)
{
    geom_fixture f;
    geom_layout *layout = NULL;
    geom_fixture_init(&f, 30, 4, 2);
    const geom_layout_def none = {.level = (geom_level)3};
    const geom_layout_def guides = {.kind = GEOM_GUIDES, .level = GEOM_LEVEL_FIFTH};
    CHECK_INT(geom_layout_create(&f.groom, &none, &layout, NULL), AWT_BAD_VALUE);
    CHECK_INT(geom_layout_create(&f.groom, &guides, &layout, NULL), AWT_BAD_VALUE);
    CHECK(layout == NULL);
    geom_fixture_fini(&f);
}
