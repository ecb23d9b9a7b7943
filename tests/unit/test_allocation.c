/* test_allocation.c: stepping and encoding take no memory and give none back. */
#include "check.h"
#include "invariant_fixture.h"

#include "base/assert.h"
#include "drawing.h"
#include "unit/delta_fixture.h"
#include "unit/fixture.h"
#include "unit/guides_fixture.h"
#include "unit/heap_seam.h"

#include <stdio.h>

/* Were the count always 0, the other test would say nothing. */
TEST(the_heap_is_counted_where_it_is_used)
{
    awt_params params = small_params("short");
    awt_groom *groom = small_groom("short", 1);
    awt_forest_def def = awt_forest_def_default(groom);
    def.params = params;
    awt_forest *f = NULL;
    heap_watch();
    awt_status status = awt_forest_create(groom, &def, &f, NULL);
    CHECK(heap_watch_end().calls >= 2);
    CHECK_INT(status, AWT_OK);
    heap_watch();
    awt_forest_destroy(f);
    CHECK(heap_watch_end().calls >= 2);
    awt_groom_destroy(groom);
}

/* Everything that may happen while stepping happens: splits, merges, contact, sleep and waking, a teleport, refusals.
 */
static void check_stepping(const char *style)
{
    awt_groom *groom = small_groom(style, 2);
    awt_params params = small_params(style), other;
    params.contact = 1;
    params.split_threshold = 0.1f;
    awt_forest *f = small_forest(groom, &params);
    strand_points now = strand_points_of(f);
    wild w = wild_make(31, 1.5);
    params.contact = 0; /* of the rest after the motion */
    other = params;
    other.wind_x = 2;
    awt_step_stats stats, sums = {0};
    awt_error error;
    awt_motion m;
    heap_watch();
    for (int n = 1; n <= 60; n++) {
        m = wild_at(&w, (int64_t)n * 2 * AWT_STEP_US);
        m.teleport = n == 20;
        m.head.position[0] += n >= 20 ? 3.0 : 0.0;
        awt_forest_move(f, &m, NULL);
        awt_forest_move(f, &m, &error); /* refused: no time has passed */
        awt_forest_advance(f, m.time_us, &stats, NULL);
        sums.splits += stats.splits;
        sums.contacts += stats.contacts;
        strand_points_read(&now, f);
        awt_forest_hash(f);
    }
    for (int n = 0; n < 3; n++) { /* still, woken by a parameter, still again */
        awt_forest_set_params(f, n % 2 ? &other : &params, &error);
        awt_forest_advance(f, awt_forest_time(f) + 8000000, &stats, &error);
        sums.merges += stats.merges;
        sums.asleep_trees += stats.asleep_trees;
    }
    awt_forest_advance(f, 0, &stats, &error); /* refused */
    unsigned counted = heap_watch_end().calls;
    CHECK_INT(counted, 0);
    CHECK(sums.splits > 50);
    CHECK(sums.merges > 50);
    CHECK(sums.contacts > 1000);
    CHECK(sums.asleep_trees > 0);
    CHECK_INT(error.status, AWT_BAD_TIME);
    strand_points_fini(&now);
    awt_forest_destroy(f);
    awt_groom_destroy(groom);
}

TEST(stepping_allocates_nothing)
{
    check_stepping("long");
    check_stepping("short-curly");
}

/* Whole numbers, whole frames of them, deltas: once their buffer has grown. */
TEST(encoding_deltas_allocates_nothing)
{
    delta_fixture f;
    delta_fixture_init(&f, 3000, 16, 10, 12);
    geom_frame_def whole = {.quantised = f.now, .head = geom_fixture_head};
    geom_delta_def delta = {.base = f.base, .now = f.now, .head = geom_fixture_head};
    geom_quantise_def quantise = {.points = f.hair.points};
    uint32_t clamped = 0;
    delta_fixture_move(&f, 0.1f, NULL);
    delta_fixture_encode(&f, NULL);
    for (int round = 0; round < 2; round++) {
        heap_watch();
        whole.quantised = delta.now = f.now;
        delta.base = f.base;
        geom_quantise(f.hair.layout, &quantise, f.now, &clamped, NULL);
        geom_encode(f.hair.layout, f.hair.scratch, &whole, &f.whole, NULL, NULL);
        awt_status status = geom_encode_delta(f.hair.layout, f.hair.scratch, &delta, &f.delta, NULL, NULL);
        unsigned counted = heap_watch_end().calls;
        CHECK(round == 0 ? counted > 0 : counted == 0); /* f.whole has grown */
        CHECK_INT(status, AWT_OK);
    }
    delta_fixture_fini(&f);
}

/* Every form and a delta of strands and of guides of every step, into pictures that are used again as the daemon uses
 * them: once their buffers have grown, nothing is taken and nothing given back. */
TEST(drawing_allocates_nothing_in_the_steady_state)
{
    enum { PICTURES = 3, WARM = 100, STEPS = 160 };
    awt_groom *groom = small_groom("long", 2);
    awt_params params = small_params("long");
    awt_forest *f = small_forest(groom, &params);
    wild w = wild_make(31, 1.0);
    drawing *d = NULL;
    awt_error error = {0};
    picture *pictures[PICTURES] = {NULL};
    CHECK_INT(drawing_create(groom, NULL, &d, &error), AWT_OK);
    const uint64_t empty = drawing_bytes(d);
    unsigned counted = 0;
    for (uint64_t n = 1; n <= STEPS; n++) {
        awt_motion m = wild_at(&w, (int64_t)n * AWT_STEP_US);
        awt_forest_move(f, &m, &error);
        awt_forest_advance(f, m.time_us, NULL, &error);
        picture **at = &pictures[n % PICTURES];
        *at = *at ? *at : picture_create();
        ASSERT(*at);
        wishes wanted = {.keeps = {[3] = true}};
        for (int form = 0; form < FORM_COUNT; form++) {
            wishes_add(&wanted, (view_name){.form = form});
        }
        wishes_add(&wanted, (view_name){.form = 3, .base = n > 3 ? n - 3 : 0});
        wishes_add(&wanted, (view_name){.form = form_find(GEOM_GUIDES, 0, FORM_DELTAS), .base = n > 3 ? n - 3 : 0});
        heap_watch();
        const bool renewed = picture_renew(*at);
        const awt_status status = drawing_draw(d, f, n, &wanted, *at, &error);
        const unsigned calls_now = heap_watch_end().calls;
        counted += n > WARM ? calls_now : 0;
        CHECK(n > 1 || calls_now > 0);
        CHECK(renewed);
        CHECK_INT(status, AWT_OK);
        CHECK_INT((*at)->view_count, n > 3 ? FORM_COUNT + 2 : FORM_COUNT);
    }
    CHECK_INT(counted, 0);
    printf("     memory: %llu bytes before the first frame, then", (unsigned long long)empty);
    for (int form = 0; form < FORM_COUNT; form++) {
        printf(" %s %llu", form_name(form), (unsigned long long)drawing_form_bytes(d, form));
    }
    printf(", all %llu\n", (unsigned long long)drawing_bytes(d));
    drawing_destroy(d);
    for (int i = 0; i < PICTURES; i++) {
        picture_release(pictures[i]);
    }
    awt_forest_destroy(f);
    awt_groom_destroy(groom);
}

/* Deltas of guides, and whole frames of their numbers. */
TEST(encoding_deltas_of_guides_allocates_nothing)
{
    guides_fixture f;
    guides_fixture_init(&f, fixture_groom("long", 2000), "long");
    guides_fixture_move(&f, "lean", 1500000);
    guides_fixture_encode(&f, GUIDES_WHOLE, NULL);
    const geom_quantise_def quantise = {.points = f.centres, .frames = f.frames};
    geom_delta_def def = {.now = f.now, .sequence = 2, .head = awt_forest_head(f.forest)};
    geom_buffer out = {0};
    uint32_t clamped = 0;
    for (int round = 0; round < 2; round++) {
        heap_watch();
        def.base = NULL;
        def.base_sequence = 0;
        awt_status quantised = geom_quantise(f.layout, &quantise, f.now, &clamped, NULL);
        awt_status whole = geom_encode_delta(f.layout, f.encoder, &def, &out, NULL, NULL);
        def.base = f.base;
        def.base_sequence = 1;
        awt_status delta = geom_encode_delta(f.layout, f.encoder, &def, &out, NULL, NULL);
        unsigned counted = heap_watch_end().calls;
        CHECK(round == 0 ? counted > 0 : counted == 0); /* `out` has grown */
        CHECK(quantised == AWT_OK && whole == AWT_OK && delta == AWT_OK);
    }
    geom_buffer_fini(&out);
    guides_fixture_fini(&f);
}
