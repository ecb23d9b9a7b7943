/* test_contact.c: wisps that touch (AWT §4.1, §4.2), on loose segments made by hand. */
#include "check.h"
#include "fixture.h"

#include "base/nearest.h"
#include "base/rng.h"
#include "base/trig.h"
#include "sim/contact.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Loose segments, each with both ends free: trees of three nodes, whose first segment has no width that is a number and
 * so touches nothing. Slots and nodes are the same. */
typedef struct soup {
    awt_groom groom;
    awt_forest forest;
    uint32_t count;
} soup;

static void soup_lay_out(soup *s, arena *a)
{
    size_t slots = 3 * (size_t)s->count;
    s->groom.rest_position = ARENA_PUSH(a, vec3, slots);
    s->groom.rest_room = ARENA_PUSH(a, float, slots);
    s->forest.position = ARENA_PUSH(a, vec3, slots);
    s->forest.velocity = ARENA_PUSH(a, vec3, slots);
    s->forest.radius = ARENA_PUSH(a, float, slots);
    s->forest.trees = ARENA_PUSH(a, tree, s->count);
    s->forest.active_node = ARENA_PUSH(a, uint32_t, slots);
    s->forest.active_parent = ARENA_PUSH(a, uint32_t, slots);
    s->forest.active_mass = ARENA_PUSH(a, float, slots);
    contact_lay_out(&s->forest, a, slots);
}

static soup *soup_make(uint32_t count)
{
    soup *s = calloc(1, sizeof *s);
    s->count = count;
    s->groom.info.wisp_count[0] = count;
    s->forest.groom = &s->groom;
    s->forest.params = awt_params_default();
    s->forest.params.contact = 1;
    s->forest.params.contact_packing = 0;
    arena counting = arena_counting();
    soup_lay_out(s, &counting);
    CHECK(arena_init(&s->forest.memory, counting.used));
    soup_lay_out(s, &s->forest.memory);
    for (uint32_t t = 0; t < count; t++) {
        s->forest.trees[t] = (tree){.first = 3 * t, .count = 3};
        for (uint32_t k = 3 * t; k < 3 * t + 3; k++) {
            s->forest.active_node[k] = k;
            s->forest.active_parent[k] = k == 3 * t ? k : k - 1;
            s->forest.active_mass[k] = 1.0f;
        }
    }
    return s;
}

static void soup_free(soup *s)
{
    arena_fini(&s->forest.memory);
    free(s);
}

/* Segment t from a to b; at rest it is far from all others. */
static void soup_put(soup *s, uint32_t t, vec3 a, vec3 b, float radius, vec3 velocity)
{
    for (uint32_t i = 0; i < 3; i++) {
        uint32_t k = 3 * t + i;
        s->forest.position[k] = i == 2 ? b : a;
        s->forest.velocity[k] = i == 0 ? (vec3){0, 0, 0} : velocity;
        s->forest.radius[k] = i == 2 ? radius : NAN; /* the first segment of the tree is none */
        s->groom.rest_position[k] = vec3_make((float)t * 10.0f, (float)i, 0);
    }
}

static vec3 soup_velocity(const soup *s, uint32_t t, uint32_t end)
{
    uint32_t k = 3 * t + 1 + end;
    return vec3_add(s->forest.velocity[k], s->forest.active_push[k]);
}

/* Lets the pushes act: velocities, and positions where `moves`. */
static uint32_t soup_step(soup *s, float dt_s, bool moves)
{
    uint32_t contacts = contact_resolve(&s->forest, dt_s);
    for (uint32_t t = 0; t < s->count; t++) {
        for (uint32_t k = 3 * t + 1; k < 3 * t + 3; k++) {
            s->forest.velocity[k] = vec3_add(s->forest.velocity[k], s->forest.active_push[k]);
            s->forest.active_push[k] = (vec3){0, 0, 0};
            if (moves) {
                s->forest.position[k] = vec3_mad(s->forest.position[k], s->forest.velocity[k], dt_s);
            }
        }
    }
    return contacts;
}

static vec3 soup_momentum(const soup *s)
{
    vec3 sum = {0, 0, 0};
    for (uint32_t k = 0; k < 3 * s->count; k++) {
        sum = vec3_mad(sum, s->forest.active_push[k], s->forest.active_mass[k]);
    }
    return sum;
}

static vec3 random_vec3(rng *r, double reach)
{
    double x = rng_between(r, -reach, reach), y = rng_between(r, -reach, reach), z = rng_between(r, -reach, reach);
    return vec3_make((float)x, (float)y, (float)z);
}

static soup *soup_random(uint32_t count, uint64_t seed, double reach)
{
    rng r = rng_seed(seed);
    soup *s = soup_make(count);
    for (uint32_t t = 0; t < count; t++) {
        vec3 a = random_vec3(&r, reach);
        soup_put(s, t, a, vec3_add(a, random_vec3(&r, 0.03)), (float)rng_between(&r, 0.002, 0.02),
                 random_vec3(&r, t % 3 == 0 ? 0.0 : 1.0));
        s->forest.active_mass[3 * t + 2] = (float)(1 + rng_u32(&r) % 20);
        s->forest.active_mass[3 * t + 1] = s->forest.active_mass[3 * t + 2] * (float)(1 + rng_u32(&r) % 3);
    }
    return s;
}

TEST(friction_of_an_isolated_pair_decays_at_the_analytic_rate)
{
    const float dt_s = 0.001f, alpha = 30.0f;
    soup *s = soup_make(2);
    /* crossed at right angles in their middles: each point has a share of 1/2 of both nodes, so W = 4 / (4 m) = 1 / m
     */
    soup_put(s, 0, vec3_make(-0.01f, 0, 0), vec3_make(0.01f, 0, 0), 0.01f, vec3_make(0, 1, 0));
    soup_put(s, 1, vec3_make(0, 0.001f, -0.01f), vec3_make(0, 0.001f, 0.01f), 0.01f, vec3_make(0, 0, 0));
    s->forest.params.friction_alpha = alpha;
    s->forest.params.repulsion_omega = 0;
    for (int n = 0; n < 50; n++) {
        CHECK_INT(soup_step(s, dt_s, false), 1);
    }
    double left = (double)(soup_velocity(s, 0, 0).y - soup_velocity(s, 1, 0).y);
    CHECK_NEAR(left, exp(-(double)alpha * 50 * (double)dt_s), 0.01);
    CHECK_NEAR(s->forest.velocity[2].y, 0.5 * (1 + left), 0.02);
    soup_free(s);
}

TEST(contact_impulses_sum_to_zero)
{
    for (uint64_t seed = 1; seed <= 5; seed++) {
        soup *s = soup_random(300, seed, 0.06);
        CHECK(contact_resolve(&s->forest, 0.01f) > 300);
        double moved = 0;
        for (uint32_t k = 0; k < 900; k++) {
            moved += (double)(vec3_length(s->forest.active_push[k]) * s->forest.active_mass[k]);
        }
        CHECK(moved > 10);
        CHECK_NEAR(vec3_length(soup_momentum(s)), 0, 1e-6 * moved);
        soup_free(s);
    }
}

TEST(friction_never_reverses_relative_motion_with_thirty_contacts_on_a_node)
{
    enum { BUNDLE = 30 };
    static const float alphas[] = {30.0f, 1000.0f};
    for (size_t n = 0; n < sizeof alphas / sizeof alphas[0]; n++) {
        soup *s = soup_make(BUNDLE + 1);
        for (uint32_t t = 1; t <= BUNDLE; t++) { /* still ones all along the one that moves */
            float x = 0.0001f * (float)t;
            soup_put(s, t, vec3_make(x, 0.002f, 0), vec3_make(x, 0.002f, 0.02f), 0.01f, vec3_make(0, 0, 0));
        }
        soup_put(s, 0, vec3_make(0, 0, 0), vec3_make(0, 0, 0.02f), 0.01f, vec3_make(1, 0, 0));
        s->forest.params.friction_alpha = alphas[n];
        float before = 1.0f;
        for (int step = 0; step < 20; step++) {
            soup_step(s, 0.01f, false);
            for (uint32_t end = 0; end < 2; end++) {
                for (uint32_t t = 1; t <= BUNDLE; t++) {
                    CHECK(soup_velocity(s, 0, end).x - soup_velocity(s, t, end).x > -1e-6f);
                }
            }
            float now = vec3_length(vec3_lerp(soup_velocity(s, 0, 0), soup_velocity(s, 0, 1), 0.5f));
            CHECK(now <= before);
            before = now;
        }
        CHECK(before < 0.9f);
        soup_free(s);
    }
}

/* Kinetic energy never grows by friction alone, whatever the masses, alpha and the step. */
TEST(friction_never_adds_energy)
{
    soup *s = soup_random(200, 7, 0.04);
    s->forest.params.repulsion_omega = 0;
    s->forest.params.friction_alpha = 1000;
    double before = INFINITY;
    for (int step = 0; step < 20; step++) {
        double energy = 0;
        for (uint32_t k = 0; k < 600; k++) {
            energy += (double)(s->forest.active_mass[k] * vec3_dot(s->forest.velocity[k], s->forest.velocity[k]));
        }
        CHECK(energy <= before * (1 + 1e-6));
        before = energy;
        soup_step(s, 0.01f, false);
    }
    soup_free(s);
}

/* Two segments whose axes make this angle, 2 mm apart along y and moving past each other along x. */
static soup *soup_crossing(double angle_rad, float speed_y)
{
    double sine, cosine;
    trig_sin_cos(0.5 * angle_rad, &sine, &cosine);
    vec3 a = vec3_scale(vec3_make((float)sine, 0, (float)cosine), 0.01f);
    vec3 b = vec3_scale(vec3_make((float)-sine, 0, (float)cosine), 0.01f), up = {0, 0.002f, 0};
    soup *s = soup_make(2);
    soup_put(s, 0, vec3_sub(up, a), vec3_add(up, a), 0.005f, vec3_make(0.1f, -speed_y, 0));
    soup_put(s, 1, vec3_scale(b, -1), b, 0.005f, vec3_make(-0.1f, speed_y, 0));
    return s;
}

TEST(parallel_wisps_interpenetrate_and_slow_each_other)
{
    soup *s = soup_crossing(0, 0.1f);
    CHECK_INT(contact_resolve(&s->forest, 0.01f), 1);
    vec3 v = soup_velocity(s, 0, 1);
    CHECK(v.x > 0 && v.x < 0.1f);
    CHECK(v.y < 0 && v.y > -0.1f); /* slower, and still on its way through */
    for (int n = 0; n < 6; n++) {
        soup_step(s, 0.01f, true);
    }
    CHECK(s->forest.position[2].y < s->forest.position[5].y);
    soup_free(s);
}

TEST(crossing_wisps_separate_but_no_farther_than_contact)
{
    static const float omegas[] = {30.0f, 300.0f};
    for (size_t n = 0; n < 2; n++) {
        soup *s = soup_crossing(TRIG_PI / 2, 0);
        s->forest.params.repulsion_omega = omegas[n];
        CHECK_INT(contact_resolve(&s->forest, 0.01f), 1);
        float speed = soup_velocity(s, 0, 1).y + soup_velocity(s, 0, 0).y;
        CHECK(speed > 0);
        CHECK_NEAR(soup_momentum(s).y, 0, 1e-9);
        /* one step takes them no farther apart than the radii are wide together */
        CHECK(speed * 0.01f < 0.010f - 0.002f);
        soup_free(s);
    }
}

TEST(repulsion_begins_at_the_threshold_angle)
{
    static const struct {
        double degrees, threshold;
        bool repels;
    } cases[] = {{34.9, 35, false}, {35.1, 35, true}, {144.9, 35, true}, {145.1, 35, false},
                 {89.5, 90, false}, {60, 59.9, true}, {60, 60.1, false}};
    for (size_t n = 0; n < sizeof cases / sizeof cases[0]; n++) {
        soup *s = soup_crossing(cases[n].degrees * TRIG_PI / 180, 0);
        s->forest.params.contact_angle = (float)cases[n].threshold;
        CHECK_INT(contact_resolve(&s->forest, 0.01f), 1);
        CHECK_INT(soup_velocity(s, 0, 1).y + soup_velocity(s, 0, 0).y > 1e-6f, cases[n].repels);
        soup_free(s);
    }
}

TEST(crossing_wisps_that_rest_overlapping_are_pushed_no_farther_than_they_rest)
{
    soup *s = soup_crossing(TRIG_PI / 2, 0);
    memcpy(s->groom.rest_position, s->forest.position, 6 * sizeof(vec3));
    CHECK_INT(contact_resolve(&s->forest, 0.01f), 1);
    CHECK_NEAR(soup_velocity(s, 0, 1).y, 0, 1e-6);
    soup_free(s);
}

TEST(wisps_without_relative_motion_do_not_touch)
{
    soup *s = soup_crossing(TRIG_PI / 2, 0);
    for (uint32_t k = 0; k < 6; k++) {
        s->forest.velocity[k] = vec3_make(3, 0.001f * (float)(k / 3), 1);
    }
    CHECK_INT(contact_resolve(&s->forest, 0.01f), 0);
    /* nor where both turn with the head */
    s->forest.head_spin = vec3_make(4, -3, 7);
    for (uint32_t k = 0; k < 6; k++) {
        s->forest.velocity[k] = vec3_cross(s->forest.head_spin, s->forest.position[k]);
    }
    CHECK_INT(contact_resolve(&s->forest, 0.01f), 0);
    for (uint32_t k = 0; k < 6; k++) {
        CHECK(vec3_length(s->forest.active_push[k]) == 0);
    }
    soup_free(s);
}

enum { BOXES = 1100 };

static void count_pairs(void *context, const grid_pair *pairs, uint32_t count)
{
    unsigned char(*met)[BOXES] = context;
    CHECK(count <= GRID_PAIRS);
    for (uint32_t n = 0; n < count; n++) {
        CHECK(pairs[n].a < pairs[n].b && pairs[n].b < BOXES);
        met[pairs[n].a][pairs[n].b]++;
    }
}

TEST(the_grid_visits_every_pair_of_overlapping_boxes_once)
{
    static const double reaches[] = {0.05, 0.3, 1.0};
    for (size_t n = 0; n < sizeof reaches / sizeof reaches[0]; n++) {
        rng r = rng_seed(11 + n);
        static grid_box boxes[BOXES];
        static unsigned char met[BOXES][BOXES];
        memset(met, 0, sizeof met);
        for (uint32_t i = 0; i < BOXES; i++) {
            vec3 a = random_vec3(&r, reaches[n]);
            float size = (float)rng_between(&r, 0.0, i % 50 == 0 ? 0.4 : 0.04);
            boxes[i] = (grid_box){a, vec3_add(a, vec3_make(size, 0.5f * size, i % 7 == 0 ? 0.0f : size))};
        }
        const uint32_t moving = BOXES / 2;
        grid g = {0};
        arena counting = arena_counting(), memory;
        grid_lay_out(&g, &counting, BOXES);
        CHECK(arena_init(&memory, counting.used));
        grid_lay_out(&g, &memory, BOXES);
        grid_build(&g, boxes, moving, BOXES, n % 2 ? 1.3f : 2.4f);
        grid_visit_pairs(&g, boxes, moving, count_pairs, met);
        uint32_t overlapping = 0, missed = 0, wrong = 0;
        for (uint32_t i = 0; i < moving; i++) {
            for (uint32_t j = i + 1; j < BOXES; j++) {
                const grid_box *a = &boxes[i], *b = &boxes[j];
                bool overlap = grid_overlap(a, b);
                overlapping += overlap;
                missed += overlap && met[i][j] == 0;
                wrong += met[i][j] > 1 || (met[i][j] == 1 && !overlap);
            }
        }
        CHECK(overlapping > 0);
        CHECK_INT(missed, 0);
        CHECK_INT(wrong, 0);
        arena_fini(&memory);
    }
}

/* The same pairs as when any two segments of the soup are put alone. */
TEST(contacts_are_those_of_all_pairs_tested_alone)
{
    enum { COUNT = 80 };
    soup *s = soup_random(COUNT, 3, 0.05), *pair = soup_make(2);
    uint32_t alone = 0;
    for (uint32_t a = 0; a < COUNT; a++) {
        for (uint32_t b = a + 1; b < COUNT; b++) {
            const awt_forest *f = &s->forest;
            soup_put(pair, 0, f->position[3 * a + 1], f->position[3 * a + 2], f->radius[3 * a + 2],
                     f->velocity[3 * a + 1]);
            soup_put(pair, 1, f->position[3 * b + 1], f->position[3 * b + 2], f->radius[3 * b + 2],
                     f->velocity[3 * b + 1]);
            alone += contact_resolve(&pair->forest, 0.01f);
        }
    }
    CHECK(alone > COUNT);
    CHECK_INT(contact_resolve(&s->forest, 0.01f), alone);
    soup_free(s);
    soup_free(pair);
}

TEST(coincident_and_pointlike_segments_give_finite_pushes)
{
    soup *s = soup_make(6);
    vec3 zero = {0, 0, 0}, z = {0, 0, 0.02f}, x = {0.02f, 0, 0};
    soup_put(s, 0, zero, z, 0.01f, vec3_make(1, 0, 0));
    soup_put(s, 1, zero, z, 0.01f, vec3_make(-1, 0, 0));
    soup_put(s, 2, zero, zero, 0.01f, vec3_make(0, 1, 0));
    soup_put(s, 3, zero, zero, 0.0f, vec3_make(0, -1, 0));
    soup_put(s, 4, z, zero, 0.01f, vec3_make(0, 0, 1));
    soup_put(s, 5, vec3_scale(x, -1), x, 0.01f, vec3_make(0, 0, -1));
    CHECK(contact_resolve(&s->forest, 0.01f) > 6);
    for (uint32_t k = 0; k < 18; k++) {
        CHECK(vec3_finite(s->forest.active_push[k]));
    }
    CHECK_NEAR(vec3_length(soup_momentum(s)), 0, 1e-6);
    soup_free(s);
}

TEST(a_segment_touches_with_what_its_neighbours_leave_room_for)
{
    soup *s = soup_crossing(0, 0.1f); /* 2 mm apart */
    for (uint32_t k = 0; k < 6; k++) {
        s->groom.rest_room[k] = 0.0009f;
    }
    CHECK_INT(contact_resolve(&s->forest, 0.01f), 1); /* all of the radius, as in the paper */
    s->forest.params.contact_packing = 1;
    CHECK_INT(contact_resolve(&s->forest, 0.01f), 0);
    s->groom.rest_room[2] = s->groom.rest_room[5] = 0.0011f;
    CHECK_INT(contact_resolve(&s->forest, 0.01f), 1);
    soup_free(s);
}

/* Every finest segment against all others, one by one. */
TEST(room_is_half_the_way_to_the_sixth_nearest_wisp)
{
    const awt_groom *groom = fixture_groom("long", 1000);
    const uint32_t sections = groom->info.sections, first = groom_finest_first(groom);
    uint32_t less = 0, wrong = 0;
    for (uint32_t g = first; g < groom->gc_count; g += 5) {
        for (uint32_t i = 1; i < sections; i++) {
            const vec3 *a = groom->rest_position + g * sections + i - 1;
            float nearest[6] = {1e9f, 1e9f, 1e9f, 1e9f, 1e9f, 1e9f};
            for (uint32_t other = first; other < groom->gc_count; other++) {
                float least = other == g ? 1e9f : 1e8f;
                for (uint32_t j = 1; other != g && j < sections; j++) {
                    const vec3 *b = groom->rest_position + other * sections + j - 1;
                    float d = nearest_distance(a[0], vec3_sub(a[1], a[0]), b[0], vec3_sub(b[1], b[0]));
                    least = d < least ? d : least;
                }
                for (int k = 0; k < 6; k++) {
                    float swap = nearest[k];
                    nearest[k] = least < swap ? least : swap;
                    least = least < swap ? swap : least;
                }
            }
            float radius = groom->rest_radius[g * sections + i], room = groom->rest_room[g * sections + i];
            float expected = 0.5f * nearest[5] < radius ? 0.5f * nearest[5] : radius;
            less += expected < radius;
            wrong += fabsf(room - expected) > 1e-6f;
        }
    }
    CHECK(less > 100);
    CHECK_INT(wrong, 0);
}
