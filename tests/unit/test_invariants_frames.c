/* test_invariants_frames.c: invariant 9: hair knows neither how fast its world goes, nor where it is, nor which way is
 * up but by gravity and wind. Strands are compared in the head frame at every step of the first 0.3 s, point by point,
 * to 0.1 mm.
 *
 * Two worlds differ by rounding, 1e-7 of what they hold, and where a node lies on an obstacle's very surface, or two
 * wisps move against each other at the very speed below which they do not touch, rounding decides. Hair by itself must
 * agree for every motion; with obstacles and contact, for two motions of three. */
#include "check.h"
#include "invariant_fixture.h"

#include "base/assert.h"
#include "sim/state.h"

enum { STEPS = 30, BALL = 77 };
#define TOLERANCE_M 1e-4

/* How the second of two worlds lies to the first: x' = turn x + at + velocity t. */
typedef struct world {
    double at[3], velocity[3], turn[4];
} world;

static const world same = {.turn = {0, 0, 0, 1}};

static void world_point(const world *w, double t, double position[3])
{
    dquat q = {w->turn[0], w->turn[1], w->turn[2], w->turn[3]}, p = {position[0], position[1], position[2], 0};
    dquat turned = dquat_mul(dquat_mul(q, p), dquat_conjugate(q));
    const double x[3] = {turned.x, turned.y, turned.z};
    for (int axis = 0; axis < 3; axis++) {
        position[axis] = x[axis] + w->at[axis] + w->velocity[axis] * t;
    }
}

static awt_pose world_pose(const world *w, double t, const awt_pose *pose)
{
    awt_pose result = *pose;
    world_point(w, t, result.position);
    orientation_mul(w->turn, pose->orientation, result.orientation);
    return result;
}

static awt_motion world_motion(const world *w, const awt_motion *motion)
{
    awt_motion result = *motion;
    double t = (double)motion->time_us * 1e-6;
    result.head = world_pose(w, t, &motion->head);
    result.body = world_pose(w, t, &motion->body);
    for (uint32_t k = 0; k < motion->collider_count; k++) {
        result.colliders[k].pose = world_pose(w, t, &motion->colliders[k].pose);
    }
    return result;
}

/* Gravity and wind of this world; directions only, so neither its place nor its velocity matter (the wind is told
 * relative to the head). */
static awt_params world_params(const world *w, const awt_params *params)
{
    awt_params result = *params;
    const world turn_only = {.turn = {w->turn[0], w->turn[1], w->turn[2], w->turn[3]}};
    double gravity[3] = {(double)params->gravity_x, (double)params->gravity_y, (double)params->gravity_z};
    double wind[3] = {(double)params->wind_x, (double)params->wind_y, (double)params->wind_z};
    world_point(&turn_only, 0, gravity);
    world_point(&turn_only, 0, wind);
    result.gravity_x = (float)gravity[0], result.gravity_y = (float)gravity[1], result.gravity_z = (float)gravity[2];
    result.wind_x = (float)wind[0], result.wind_y = (float)wind[1], result.wind_z = (float)wind[2];
    return result;
}

/* The motion of head, body, and a ball with a frame of its own that comes at the hair from the side. */
static awt_motion world_free_motion(uint64_t seed, bool ball, int64_t time_us)
{
    wild w = wild_make(seed, 1.0);
    awt_motion m = wild_at(&w, time_us);
    m.collider_count = ball;
    m.colliders[0].id = BALL;
    m.colliders[0].pose.position[0] = 0.30 - 0.5 * (double)time_us * 1e-6;
    m.colliders[0].pose.orientation[3] = 1;
    return m;
}

/* With obstacles (head, body and ball), or with none. */
static awt_forest *world_forest(const world *w, const awt_groom *groom, const awt_params *params, uint64_t seed,
                                bool obstacles)
{
    awt_forest_def def = awt_forest_def_default(groom);
    def.params = *params;
    def.colliders[def.collider_count++] =
        (awt_collider){.id = BALL, .frame = AWT_FRAME_OWN, .radius_a = 0.1f, .radius_b = 0.1f};
    def.collider_count = obstacles ? def.collider_count : 0;
    awt_motion start = world_free_motion(seed, obstacles, 0);
    def.start = world_motion(w, &start);
    awt_forest *f;
    ASSERT(awt_forest_create(groom, &def, &f, NULL) == AWT_OK);
    /* under way already: no input says so, every forest starts at rest in its world */
    dvec3 velocity = {w->velocity[0], w->velocity[1], w->velocity[2]};
    f->frame_velocity = velocity;
    for (uint32_t k = 0; k < TRACK_COUNT; k++) {
        f->track.last.pose[k].velocity = velocity;
    }
    return f;
}

typedef struct comparison {
    double greatest_m, moved_m; /* between the worlds; from rest */
    uint32_t splits, contacts;
} comparison;

/* `own` is the second world's parameters. */
static comparison compare_worlds(const awt_groom *groom, const awt_params *params, const world *w,
                                 const awt_params *own, uint64_t seed, bool obstacles)
{
    awt_forest *a = world_forest(&same, groom, params, seed, obstacles);
    awt_forest *b = world_forest(w, groom, own, seed, obstacles);
    strand_points rest = strand_points_of(a), of_a = strand_points_of(a), of_b = strand_points_of(b);
    comparison c = {0};
    for (int n = 1; n <= STEPS; n++) {
        awt_motion m = world_free_motion(seed, obstacles, (int64_t)n * AWT_STEP_US), moved = world_motion(w, &m);
        awt_step_stats stats;
        ASSERT(awt_forest_move(a, &m, NULL) == AWT_OK && awt_forest_move(b, &moved, NULL) == AWT_OK);
        ASSERT(awt_forest_advance(a, m.time_us, &stats, NULL) == AWT_OK);
        ASSERT(awt_forest_advance(b, m.time_us, NULL, NULL) == AWT_OK);
        strand_points_read(&of_a, a);
        strand_points_read(&of_b, b);
        double between = strand_points_greatest(&of_a, &of_b), moved_m = strand_points_greatest(&of_a, &rest);
        c.greatest_m = between > c.greatest_m ? between : c.greatest_m;
        c.moved_m = moved_m > c.moved_m ? moved_m : c.moved_m;
        c.splits += stats.splits;
        c.contacts += stats.contacts;
    }
    strand_points_fini(&rest), strand_points_fini(&of_a), strand_points_fini(&of_b);
    awt_forest_destroy(a);
    awt_forest_destroy(b);
    return c;
}

static awt_params windy_params(const char *style, bool contact)
{
    awt_params params = small_params(style);
    params.contact = contact ? 1.0f : 0.0f;
    params.split_threshold = 0.12f;
    params.rest_gravity = 0;
    params.gravity_x = 0.5f; /* along no axis */
    params.wind_x = 4.0f, params.wind_y = 1.0f, params.wind_z = -3.0f;
    params.drag = 1.0f;
    return params;
}

/* How many of `motions` agree. */
static int agreeing_motions(const char *style, const world *w, const awt_params *params, int motions, bool obstacles)
{
    awt_groom *groom = small_groom(style, 3);
    awt_params own = world_params(w, params);
    int agree = 0;
    for (int n = 0; n < motions; n++) {
        comparison c = compare_worlds(groom, params, w, &own, 91 + (uint64_t)n, obstacles);
        agree += c.greatest_m <= TOLERANCE_M;
        CHECK(c.moved_m > 100 * TOLERANCE_M); /* there was something to see */
        CHECK(c.splits > 10);
        CHECK_INT(c.contacts > 100, params->contact > 0);
    }
    awt_groom_destroy(groom);
    return agree;
}

static void check_world(const world *w, float rest_gravity)
{
    static const char *const styles[] = {"long", "short-curly"}; /* rigid links, and springs */
    for (size_t s = 0; s < 2; s++) {
        awt_params alone = windy_params(styles[s], false), touching = windy_params(styles[s], true);
        alone.rest_gravity = touching.rest_gravity = rest_gravity;
        CHECK_INT(agreeing_motions(styles[s], w, &alone, 2, false), 2);
        CHECK(agreeing_motions(styles[s], w, &alone, 3, true) >= 2);
        CHECK(agreeing_motions(styles[s], w, &touching, 3, true) >= 2);
    }
}

TEST(hair_does_not_know_how_fast_its_world_goes_nor_where_it_is)
{
    const world fast = {.velocity = {10, 0, 0}, .turn = {0, 0, 0, 1}};
    const world far_away = {.at = {1e5, 2e4, -1e5}, .velocity = {-7, 0, 7}, .turn = {0, 0, 0, 1}};
    check_world(&fast, 1);
    check_world(&far_away, 0);
}

TEST(hair_does_not_know_how_its_world_is_turned)
{
    const world askew = {.turn = {0.5, -0.1, 0.7, 0.5}}; /* of length 1 */
    check_world(&askew, 1);
}

/* What the two tests above would not notice, they could not: gravity or wind left as they were in a turned world. */
TEST(hair_knows_gravity_and_wind_in_a_turned_world)
{
    const world askew = {.turn = {0.5, -0.1, 0.7, 0.5}};
    awt_groom *groom = small_groom("long", 3);
    awt_params params = windy_params("long", false), wrong = world_params(&askew, &params);
    wrong.gravity_x = params.gravity_x, wrong.gravity_y = params.gravity_y, wrong.gravity_z = params.gravity_z;
    CHECK(compare_worlds(groom, &params, &askew, &wrong, 91, true).greatest_m > 100 * TOLERANCE_M);
    wrong = world_params(&askew, &params);
    wrong.wind_x = params.wind_x, wrong.wind_y = params.wind_y, wrong.wind_z = params.wind_z;
    CHECK(compare_worlds(groom, &params, &askew, &wrong, 91, true).greatest_m > 50 * TOLERANCE_M);
    awt_groom_destroy(groom);
}

/* Hair rests as it was drawn, upright; in a world whose gravity lies otherwise, it rests so too, if its head does. */
TEST(hair_at_rest_does_not_know_how_its_world_is_turned)
{
    const world askew = {.turn = {0.5, -0.1, 0.7, 0.5}};
    awt_groom *groom = small_groom("long", 3);
    awt_params params = small_params("long");
    params.rest_gravity = 1;
    awt_params own = world_params(&askew, &params);
    awt_forest_def def = awt_forest_def_default(groom);
    def.params = own;
    def.start = world_motion(&askew, &def.start);
    awt_forest *f;
    ASSERT(awt_forest_create(groom, &def, &f, NULL) == AWT_OK);
    strand_points rest = strand_points_of(f), now = strand_points_of(f);
    CHECK_INT(awt_forest_advance(f, 1000000, NULL, NULL), AWT_OK);
    strand_points_read(&now, f);
    CHECK_NEAR(strand_points_mean(&rest, &now), 0, 1e-3); /* as it does upright: test_forest.c */
    strand_points_fini(&rest), strand_points_fini(&now);
    awt_forest_destroy(f);
    awt_groom_destroy(groom);
}
