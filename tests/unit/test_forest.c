/* test_forest.c: a forest in motion: rest, links, roots, time, determinism, bad input. */
#include "check.h"
#include "fixture.h"

#include "sim/state.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>

static const double zero[3] = {0, 0, 0};
enum { STRANDS = 2000 };

typedef struct hair {
    float *centres, *frames, *scratch, *points;
    size_t point_count;
} hair;

static hair hair_make(const awt_groom *groom)
{
    hair h = {.point_count = (size_t)groom->info.strand_count * groom->info.points_per_strand};
    h.centres = malloc((size_t)groom->info.finest_nodes * 3 * sizeof(float));
    h.frames = malloc((size_t)groom->info.finest_nodes * 4 * sizeof(float));
    h.scratch = malloc(awt_groom_strand_scratch(groom) * sizeof(float));
    h.points = malloc(h.point_count * 3 * sizeof(float));
    return h;
}

static void hair_read(hair *h, const awt_forest *f)
{
    awt_forest_guides(f, h->centres, h->frames);
    awt_groom_strands(awt_forest_groom(f), h->centres, h->frames, h->scratch, h->points);
}

static void hair_free(hair *h)
{
    free(h->centres), free(h->frames), free(h->scratch), free(h->points);
}

static double mean_distance(const hair *a, const hair *b)
{
    double sum = 0;
    for (size_t i = 0; i < a->point_count; i++) {
        double d2 = 0;
        for (size_t axis = 0; axis < 3; axis++) {
            double d = (double)a->points[3 * i + axis] - (double)b->points[3 * i + axis];
            d2 += d * d;
        }
        sum += sqrt(d2);
    }
    return sum / (double)a->point_count;
}

TEST(every_style_stays_as_it_rests_while_nobody_moves)
{
    for (size_t s = 0; s < awt_style_count(); s++) {
        const char *style = awt_style_at(s)->name;
        const awt_groom *groom = fixture_groom(style, STRANDS);
        awt_forest *f = fixture_forest(groom, style, zero, zero);
        hair before = hair_make(groom), after = hair_make(groom);
        hair_read(&before, f);
        awt_step_stats stats;
        CHECK_INT(awt_forest_advance(f, 3000000, &stats, NULL), AWT_OK);
        hair_read(&after, f);
        CHECK_NEAR(mean_distance(&before, &after), 0, 1e-3);
        CHECK_INT(stats.splits, 0);
        CHECK_INT(stats.active_nodes, groom->info.coarse_nodes);
        CHECK_INT(stats.unreached_contacts, 0);
        hair_free(&before);
        hair_free(&after);
        awt_forest_destroy(f);
    }
}

TEST(rigid_links_keep_their_length_and_roots_ride_the_head_in_every_clip)
{
    static const char *const clips[] = {"lean", "jump", "run", "shake"};
    const awt_groom *groom = fixture_groom("long", STRANDS);
    for (size_t c = 0; c < sizeof clips / sizeof clips[0]; c++) {
        awt_forest *f = fixture_forest(groom, "long", zero, zero);
        hair start = hair_make(groom), now = hair_make(groom);
        hair_read(&start, f);
        double worst_link = 0, worst_root = 0;
        bool finite = true;
        for (int n = 1; n <= check_rounds(600); n++) {
            awt_step_stats stats;
            fixture_advance(f, fixture_clip(clips[c]), (int64_t)n * 16667, zero, zero, &stats);
            worst_link = (double)stats.link_error > worst_link ? (double)stats.link_error : worst_link;
            if (n % 20 == 0) {
                hair_read(&now, f);
                for (size_t i = 0; i < 3 * now.point_count; i++) {
                    finite = finite && isfinite(now.points[i]);
                }
                size_t stride = 3 * (size_t)groom->info.points_per_strand;
                for (size_t s = 0; s < groom->info.strand_count; s++) {
                    for (size_t axis = 0; axis < 3; axis++) {
                        double d =
                            fabs((double)now.points[s * stride + axis] - (double)start.points[s * stride + axis]);
                        worst_root = d > worst_root ? d : worst_root;
                    }
                }
            }
        }
        CHECK(finite);
        CHECK_NEAR(worst_link, 0, 1e-5);
        CHECK_NEAR(worst_root, 0, 1e-3); /* sections bend with the first segment, the root centres do not move */
        hair_free(&start);
        hair_free(&now);
        awt_forest_destroy(f);
    }
}

TEST(a_lean_splits_wisps_and_rest_merges_them_again)
{
    for (size_t s = 0; s < awt_style_count(); s++) {
        const char *style = awt_style_at(s)->name;
        const awt_groom *groom = fixture_groom(style, STRANDS);
        awt_forest *f = fixture_forest(groom, style, zero, zero);
        awt_params params = awt_forest_params(f);
        params.split_threshold = 0.2f; /* the styles' own leave short hair shut in a lean */
        awt_forest_set_params(f, &params, NULL);
        uint32_t most = 0;
        awt_step_stats stats;
        for (int n = 1; n <= 1000; n++) {
            fixture_advance(f, fixture_clip("lean"), (int64_t)n * AWT_STEP_US, zero, zero, &stats);
            most = stats.active_nodes > most ? stats.active_nodes : most;
        }
        /* short hair hardly opens in a lean; long hair does */
        CHECK(most > groom->info.coarse_nodes + (groom->info.levels > 2 ? groom->info.coarse_nodes / 2 : 0));
        CHECK_INT(stats.active_nodes, groom->info.coarse_nodes);
        awt_forest_destroy(f);
    }
}

TEST(a_request_is_cut_into_equal_steps_that_land_on_its_time)
{
    awt_forest *f = fixture_forest(fixture_groom("short", STRANDS), "short", zero, zero);
    static const struct {
        int64_t time_us;
        uint32_t steps;
    } requests[] = {{16667, 2}, {16667, 0}, {26667, 1}, {26668, 1}, {33611, 1}, {333611, 30}, {343612, 2}};
    for (size_t r = 0; r < sizeof requests / sizeof requests[0]; r++) {
        awt_step_stats stats;
        CHECK_INT(awt_forest_advance(f, requests[r].time_us, &stats, NULL), AWT_OK);
        CHECK_INT(stats.steps, requests[r].steps);
        CHECK_INT(stats.time_us, requests[r].time_us);
        CHECK_INT(awt_forest_time(f), requests[r].time_us);
    }
    awt_error error;
    CHECK_INT(awt_forest_advance(f, 343611, NULL, &error), AWT_BAD_TIME);
    CHECK_INT(awt_forest_advance(f, 343612 + AWT_MAX_ADVANCE_US + 1, NULL, &error), AWT_LIMIT);
    CHECK_INT(awt_forest_time(f), 343612);
    awt_forest_destroy(f);
}

TEST(the_same_motion_far_away_and_at_speed_is_the_same_motion)
{
    const double far_away[3] = {1e5, 2e4, -1e5}, fast[3] = {10, 0, 5};
    const awt_groom *groom = fixture_groom("long", STRANDS);
    awt_forest *a = fixture_forest(groom, "long", zero, zero), *b = fixture_forest(groom, "long", far_away, fast);
    hair ha = hair_make(groom), hb = hair_make(groom);
    for (int n = 1; n <= 130; n++) {
        fixture_advance(a, fixture_clip("lean"), (int64_t)n * AWT_STEP_US, zero, zero, NULL);
        fixture_advance(b, fixture_clip("lean"), (int64_t)n * AWT_STEP_US, far_away, fast, NULL);
    }
    hair_read(&ha, a);
    hair_read(&hb, b);
    CHECK_NEAR(mean_distance(&ha, &hb), 0, 1e-4);
    hair_free(&ha);
    hair_free(&hb);
    awt_forest_destroy(a);
    awt_forest_destroy(b);
}

TEST(a_teleport_carries_the_hair_rigidly)
{
    const awt_groom *groom = fixture_groom("long", STRANDS);
    awt_forest *f = fixture_forest(groom, "long", zero, zero);
    hair before = hair_make(groom), after = hair_make(groom);
    hair_read(&before, f);
    awt_motion there = {.time_us = AWT_STEP_US, .teleport = true};
    there.head.position[0] = there.body.position[0] = 5;
    there.head.orientation[1] = there.body.orientation[1] = 1; /* half a turn */
    CHECK_INT(awt_forest_move(f, &there, NULL), AWT_OK);
    CHECK_INT(awt_forest_advance(f, AWT_STEP_US, NULL, NULL), AWT_OK);
    hair_read(&after, f);
    CHECK_NEAR(mean_distance(&before, &after), 0, 1e-4);
    hair_free(&before);
    hair_free(&after);
    awt_forest_destroy(f);
}

TEST(bad_parameters_obstacles_and_poses_are_refused_whole)
{
    const awt_groom *groom = fixture_groom("short", STRANDS);
    awt_forest_def def = awt_forest_def_default(groom);
    awt_forest *f = NULL;
    awt_error error;
    def.params.drag = NAN;
    CHECK_INT(awt_forest_create(groom, &def, &f, &error), AWT_BAD_VALUE);
    CHECK(f == NULL);
    def = awt_forest_def_default(groom);
    def.colliders[1].radius_b = 0;
    CHECK_INT(awt_forest_create(groom, &def, &f, &error), AWT_BAD_VALUE);
    def = awt_forest_def_default(groom);
    def.colliders[1].id = def.colliders[0].id;
    CHECK_INT(awt_forest_create(groom, &def, &f, &error), AWT_BAD_VALUE);
    def = awt_forest_def_default(groom);
    def.collider_count = AWT_MAX_COLLIDERS + 1;
    CHECK_INT(awt_forest_create(groom, &def, &f, &error), AWT_LIMIT);
    def = awt_forest_def_default(groom);
    def.start.head.orientation[0] = 0.5;
    CHECK_INT(awt_forest_create(groom, &def, &f, &error), AWT_BAD_VALUE);
    CHECK(f == NULL);
    awt_params params = awt_params_default();
    CHECK_INT(awt_params_set(&params, "no_such", 1, &error), AWT_NO_PARAM);
    CHECK_INT(awt_params_set(&params, "rest_gravity", 1.5f, &error), AWT_BAD_VALUE);
    CHECK_INT(awt_params_set(&params, "rest_gravity", 0.5f, &error), AWT_OK);
    CHECK_NEAR(params.rest_gravity, 0.5, 0);
}

/* ---- same inputs, same bits ---------------------------------------------------------------------------------- */

typedef struct run {
    const char *style;
    uint64_t hash;
} run;

static void *run_lean(void *context)
{
    run *r = context;
    awt_forest *f = fixture_forest(fixture_groom(r->style, STRANDS), r->style, zero, zero);
    for (int n = 1; n <= 250; n++) {
        fixture_advance(f, fixture_clip("lean"), (int64_t)n * AWT_STEP_US, zero, zero, NULL);
    }
    r->hash = awt_forest_hash(f);
    awt_forest_destroy(f);
    return NULL;
}

TEST(one_worker_and_two_give_the_same_bits)
{
    run alone[2] = {{"long", 0}, {"short-curly", 0}}, beside[2] = {{"long", 0}, {"short-curly", 0}};
    run_lean(&alone[0]);
    run_lean(&alone[1]);
    pthread_t threads[2];
    for (int k = 0; k < 2; k++) {
        CHECK_INT(pthread_create(&threads[k], NULL, run_lean, &beside[k]), 0);
    }
    for (int k = 0; k < 2; k++) {
        pthread_join(threads[k], NULL);
        CHECK_U64(beside[k].hash, alone[k].hash);
    }
    CHECK(alone[0].hash != alone[1].hash);
}

TEST(one_bit_of_one_pose_changes_the_state)
{
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        awt_forest *f = fixture_forest(fixture_groom("short", STRANDS), "short", zero, zero);
        awt_motion m = {.time_us = AWT_STEP_US};
        m.head.orientation[3] = m.body.orientation[3] = 1;
        m.head.position[0] = k ? nextafter(0.01, 1) : 0.01;
        awt_forest_move(f, &m, NULL);
        awt_forest_advance(f, AWT_STEP_US, NULL, NULL);
        hash[k] = awt_forest_hash(f);
        awt_forest_destroy(f);
    }
    CHECK(hash[0] != hash[1]);
}
