/* test_invariants_contact.c: invariant 5 in a whole simulation: two straight wisps of one segment each, held at their
 * roots and thrown against each other without gravity, style or air. Sub-steps of 1 ms, so that the paper's equations
 * are followed closely. */
#include "check.h"
#include "groom_fixture.h"

#include "base/assert.h"
#include "base/trig.h"
#include "sim/state.h"

enum { RING = 12 };
#define RADIUS_M 0.01
#define SUB_STEP_US 1000

/* ---- two rods ------------------------------------------------------------------------------------------------- */

/* Strands in a ring of RADIUS_M about the axis from `root` to `tip`, which is level. */
static void put_rod(awt_strands *strands, uint32_t first, dvec3 root, dvec3 tip)
{
    dvec3 along = dvec3_sub(tip, root);
    double length = dvec3_length(along), ring = RADIUS_M / sqrt(2.0); /* a wisp as wide as a full disc of so many */
    for (uint32_t s = 0; s < RING; s++) {
        double sine, cosine;
        trig_sin_cos(2 * TRIG_PI * s / RING, &sine, &cosine);
        double x = -along.z / length * cosine * ring, y = sine * ring, z = along.x / length * cosine * ring;
        groom_fixture_put(strands, first + s, 0, root.x + x, root.y + y, root.z + z);
        groom_fixture_put(strands, first + s, 1, tip.x + x, tip.y + y, tip.z + z);
    }
}

typedef struct rods {
    awt_groom *groom;
    awt_forest *forest;
    uint32_t tip[2]; /* nodes */
} rods;

/* Two rods as they rest; both free of everything but each other. Rod 0 is the one with the lower root in x. */
static rods rods_make(const dvec3 root[2], const dvec3 tip[2], const awt_params *params)
{
    rods r;
    awt_strands strands = groom_fixture_strands(2 * RING, 2);
    for (uint32_t k = 0; k < 2; k++) {
        put_rod(&strands, RING * k, root[k], tip[k]);
    }
    awt_groom_def def = awt_groom_def_default();
    def.levels = 1, def.sections = 2, def.finest_wisps = 2;
    r.groom = groom_fixture_build(&strands, &def);
    awt_strands_fini(&strands);
    ASSERT(r.groom && r.groom->info.finest_nodes == 4);
    awt_forest_def forest_def = awt_forest_def_default(r.groom);
    forest_def.params = *params;
    forest_def.collider_count = 0;
    ASSERT(awt_forest_create(r.groom, &forest_def, &r.forest, NULL) == AWT_OK);
    bool in_order = r.groom->rest_position[0].x < r.groom->rest_position[2].x;
    r.tip[0] = in_order ? 1 : 3;
    r.tip[1] = in_order ? 3 : 1;
    for (uint32_t k = 0; k < 2; k++) {
        CHECK_INT(r.groom->gc_strand_count[k], RING);
        CHECK_NEAR(r.groom->rest_radius[2 * k + 1], RADIUS_M, 1e-4);
    }
    return r;
}

static void rods_free(rods *r)
{
    awt_forest_destroy(r->forest);
    awt_groom_destroy(r->groom);
}

static void rods_advance(rods *r, awt_step_stats *stats)
{
    ASSERT(awt_forest_advance(r->forest, awt_forest_time(r->forest) + SUB_STEP_US, stats, NULL) == AWT_OK);
}

static awt_params free_params(void)
{
    awt_params p = awt_params_default();
    p.gravity_x = p.gravity_y = p.gravity_z = 0;
    p.wind_x = p.wind_y = p.wind_z = 0;
    p.style_omega = p.rest_gravity = p.drag = p.settling = 0;
    p.links = 0;
    p.split_threshold = 1e9f;
    p.contact = 1;
    p.contact_angle = 35;
    p.relative_motion = 0; /* a rod that turns round in mid-contact does not stop touching there */
    return p;
}

/* ---- friction ------------------------------------------------------------------------------------------------- */

/* Relative to the other rod beside it: how far rod 0's tip still is from there, and how fast it comes nearer. */
typedef struct approach {
    double left_m, speed_m_s;
} approach;

static approach rods_approach(const rods *r)
{
    const awt_forest *f = r->forest;
    vec3 tip = f->position[r->tip[0]], root = f->position[r->tip[1] - 1], end = f->position[r->tip[1]];
    float share = (tip.z - root.z) / (end.z - root.z);
    float speed = f->velocity[r->tip[0]].x - share * f->velocity[r->tip[1]].x;
    return (approach){(double)(vec3_lerp(root, end, share).x - tip.x), (double)speed};
}

/* Two rods along z, 3 cm apart, and 2 mm in height, so that their axes never meet. The tip of the shorter one is thrown
 * at the other's side. Returns with what share of its first speed it passes through there; negative: it does not,
 * within 0.2 s. */
static double speed_of_passing(const awt_params *params)
{
    const dvec3 root[2] = {{-0.015, 0.300, 0}, {0.015, 0.302, 0}}, tip[2] = {{-0.015, 0.300, 0.2}, {0.015, 0.302, 0.3}};
    const float thrown = 3.0f;
    rods r = rods_make(root, tip, params);
    r.forest->velocity[r.tip[0]].x = thrown;
    approach now = {1, (double)thrown};
    for (int n = 0; n < 200 && now.left_m > 0; n++) {
        double before = now.speed_m_s;
        rods_advance(&r, NULL);
        now = rods_approach(&r);
        CHECK(now.speed_m_s > 0 && now.speed_m_s <= before); /* slower, never back */
    }
    rods_free(&r);
    return now.left_m > 0 ? -1 : now.speed_m_s / (double)thrown;
}

TEST(parallel_wisps_of_a_forest_pass_through_each_other_and_lose_speed)
{
    awt_params params = free_params();
    params.contact = 0;
    double free_speed = speed_of_passing(&params);
    CHECK_NEAR(free_speed, 1.0, 0.02);
    /* From where they touch to where they pass the way is 2 radii. There dv/dt = -c v, that is dv = -c dx. Eqs. (1) and
     * (3) give c = alpha (s0^2 + s1^2), with the shares s of the tips in the points that touch: 1 and 2/3 while the tip
     * touches; 1/2 and 1/3, the middle of where they lie abreast, as long as they are exactly parallel. */
    params.contact = 1;
    params.friction_alpha = 30;
    double way = 2 * RADIUS_M, slowed = speed_of_passing(&params);
    CHECK_NEAR(slowed, free_speed - 30 * (1 + 4.0 / 9.0) * way / 3.0, 0.05);
    params.friction_alpha = 15;
    CHECK_NEAR(free_speed - speed_of_passing(&params), 0.5 * (free_speed - slowed), 0.1 * (free_speed - slowed));
    params.friction_alpha = 0;
    CHECK_NEAR(speed_of_passing(&params), free_speed, 1e-6);
}

/* ---- repulsion ------------------------------------------------------------------------------------------------ */

typedef struct crossing {
    bool through;   /* the lower rod is above the other at the end, or was */
    double nearest; /* of the axes' middles, in height */
    double at_end, speed_at_end;
} crossing;

/* Two rods of 0.6 m, one 22 mm above the other, whose axes cross in their middles at this angle; the lower one's middle
 * rises at 0.15 m/s. Long rods, so that rising 44 mm hardly tilts them. */
static crossing rods_cross(double degrees, const awt_params *params)
{
    double sine, cosine;
    trig_sin_cos(0.5 * degrees * TRIG_PI / 180, &sine, &cosine);
    /* rod 0 runs to +x and +z, rod 1 the other way round in x: it begins on the right */
    const dvec3 root[2] = {{-0.3 * sine, 0.300, -0.3 * cosine}, {0.3 * sine, 0.322, -0.3 * cosine}};
    const dvec3 tip[2] = {{0.3 * sine, 0.300, 0.3 * cosine}, {-0.3 * sine, 0.322, 0.3 * cosine}};
    rods r = rods_make(root, tip, params);
    awt_forest *f = r.forest;
    f->velocity[r.tip[0]].y = 0.3f;
    crossing c = {.nearest = 1};
    for (int n = 0; n < 250; n++) {
        rods_advance(&r, NULL);
        double before = c.at_end;
        c.at_end = 0.5 * ((double)f->position[r.tip[1]].y + 0.322 - (double)f->position[r.tip[0]].y - 0.300);
        c.speed_at_end = (c.at_end - before) / (SUB_STEP_US * 1e-6);
        c.nearest = c.at_end < c.nearest ? c.at_end : c.nearest;
        c.through = c.through || c.at_end < 0;
    }
    rods_free(&r);
    return c;
}

TEST(crossing_wisps_of_a_forest_separate)
{
    awt_params params = free_params();
    params.friction_alpha = 0;
    params.repulsion_omega = 30;
    crossing c = rods_cross(90, &params);
    CHECK(!c.through);
    /* Eq. (2) on both middles, half of it on each tip: a spring of omega^2 / 2 on the overlap, which 0.15 m/s presses
     * together by 0.15 / (30 / sqrt 2) = 7.1 mm before it throws them back at 0.15 m/s. */
    CHECK_NEAR(c.nearest, 2 * RADIUS_M - 0.15 * sqrt(2.0) / 30, 0.0005);
    CHECK(c.at_end > 2 * RADIUS_M);
    CHECK_NEAR(c.speed_at_end, 0.15, 0.02);
    params.repulsion_omega = 0;
    CHECK(rods_cross(90, &params).through);
    params.repulsion_omega = 30;
    params.friction_alpha = 30; /* with both, they still do not pass */
    c = rods_cross(90, &params);
    CHECK(!c.through);
    CHECK(c.nearest > 2 * RADIUS_M - 0.15 * sqrt(2.0) / 30);
}

TEST(wisps_of_a_forest_begin_to_separate_at_the_threshold_angle)
{
    static const float thresholds[] = {20, 35, 50};
    awt_params params = free_params();
    params.friction_alpha = 0;
    params.repulsion_omega = 30;
    for (size_t n = 0; n < sizeof thresholds / sizeof thresholds[0]; n++) {
        params.contact_angle = thresholds[n];
        double angle = (double)thresholds[n];
        CHECK(rods_cross(angle - 3, &params).through);
        CHECK(!rods_cross(angle + 3, &params).through);
        /* axes have no direction */
        CHECK(rods_cross(180 - angle + 3, &params).through);
        CHECK(!rods_cross(180 - angle - 3, &params).through);
    }
}

/* PHYSICS: sleeping trees wake on contact with something that moves. Rod 1 falls asleep while rod 0 is on its way. */
TEST(a_sleeping_wisp_that_is_hit_wakes_and_takes_its_share_of_the_motion)
{
    const dvec3 root[2] = {{-0.3, 0.300, 0}, {0, 0.360, -0.3}}, tip[2] = {{0.3, 0.300, 0}, {0, 0.360, 0.3}};
    awt_params params = free_params();
    rods r = rods_make(root, tip, &params);
    awt_forest *f = r.forest;
    f->velocity[r.tip[0]].y = 0.08f; /* its middle at half of that: 40 mm to go in 1 s */
    awt_step_stats stats = {0};
    bool slept = false;
    uint32_t contacts = 0;
    for (int n = 0; n < 1500; n++) {
        rods_advance(&r, &stats);
        slept = slept || stats.asleep_trees == 1;
        contacts += stats.contacts;
    }
    CHECK(slept);
    CHECK(contacts > 50);
    CHECK_INT(stats.asleep_trees, 0);
    CHECK(f->velocity[r.tip[1]].y > 0.01f);
    rods_free(&r);
}
