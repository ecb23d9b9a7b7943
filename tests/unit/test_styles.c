/* test_styles.c: the built-in styles: sizes of the paper, and hair that grows where hair grows. */
#include "check.h"

#include <math.h>
#include "awt.h"
#include "base/hash.h"
#include "base/vec.h"
#include "fixture.h"
#include "groom/groom.h"

enum { STYLE_STRANDS = 3000 };

static awt_strands grow(const awt_style *style, uint32_t strands, uint64_t seed)
{
    awt_strands grown = {0};
    awt_error error;
    awt_status status = awt_style_grow(style, strands, seed, &grown, &error);
    CHECK_TEXT(status == AWT_OK ? "grown" : error.text, "grown");
    return grown;
}

static vec3 point_of(const awt_strands *strands, size_t index)
{
    const float *p = strands->positions + 3 * index;
    return vec3_make(p[0], p[1], p[2]);
}

static uint64_t strands_hash(const awt_strands *strands)
{
    return hash_words(HASH_SEED, strands->positions, 3 * (size_t)strands->point_count);
}

TEST(styles_have_the_sizes_of_the_paper)
{
    static const struct {
        const char *name;
        int finest_nodes, levels;
        double split_threshold, style_omega;
    } paper[] = {{"short", 5149, 2, 0.26, 30.0},
                 {"short-curly", 4909, 2, 0.50, 20.0},
                 {"long", 6065, 3, 0.50, 20.0},
                 {"long-curly", 9853, 3, 0.50, 15.0}};
    CHECK_INT(awt_style_count(), 4);
    for (size_t i = 0; i < 4; i++) {
        const awt_style *style = awt_style_find(paper[i].name);
        CHECK(style && style == awt_style_at(i));
        awt_groom_info info;
        awt_groom_get_info(fixture_groom(paper[i].name, AWT_DEFAULT_STRANDS), &info);
        CHECK_INT(info.strand_count, AWT_DEFAULT_STRANDS);
        CHECK_INT(info.levels, paper[i].levels);
        CHECK_NEAR(info.finest_nodes, paper[i].finest_nodes, 0.02 * paper[i].finest_nodes);
        CHECK(info.coarse_nodes >= 500 && info.coarse_nodes <= 1200);
        CHECK(info.mass_kg >= 0.5 && info.mass_kg <= 2.0); /* §5 */
        CHECK_NEAR(style->params.split_threshold, paper[i].split_threshold, 1e-6);
        CHECK_NEAR(style->params.style_omega, paper[i].style_omega, 1e-6);
        awt_params usual = awt_params_default();
        CHECK(style->params.merge_velocity == usual.merge_velocity && style->params.gravity_y == usual.gravity_y &&
              style->params.link_iterations == usual.link_iterations);
    }
    CHECK(awt_style_find("mohawk") == NULL);
}

TEST(styles_grow_no_hair_on_the_face)
{
    for (size_t i = 0; i < awt_style_count(); i++) {
        awt_strands strands = grow(awt_style_at(i), STYLE_STRANDS, 1);
        uint32_t on_face = 0, off_scalp = 0, before_eyes = 0;
        for (uint32_t s = 0; s < strands.strand_count; s++) {
            vec3 root = point_of(&strands, strands.first_point[s]);
            off_scalp += fabs((double)vec3_length(root) - AWT_HEAD_RADIUS_M) > 0.005;
            on_face += root.z > 0.06f && root.y < 0.05f;
        }
        for (uint32_t p = 0; p < strands.point_count; p++) {
            vec3 at = point_of(&strands, p);
            before_eyes += fabsf(at.x) < 0.03f && at.y > -0.08f && at.y < 0.02f && at.z > 0.05f;
        }
        CHECK_INT(off_scalp, 0);
        CHECK_INT(on_face, 0);
        CHECK_INT(before_eyes, 0);
        awt_strands_fini(&strands);
    }
}

/* Distance from a collider's surface. */
static double distance_from(const awt_collider *c, vec3 point)
{
    vec3 a = {c->a[0], c->a[1], c->a[2]}, b = {c->b[0], c->b[1], c->b[2]}, axis = vec3_sub(b, a);
    float square = vec3_dot(axis, axis), along = square > 0.0f ? vec3_dot(vec3_sub(point, a), axis) / square : 0.0f;
    along = along < 0.0f ? 0.0f : along > 1.0f ? 1.0f : along;
    float radius = c->radius_a + (c->radius_b - c->radius_a) * along;
    return (double)(vec3_distance(point, vec3_mad(a, axis, along)) - radius);
}

TEST(styles_grow_outside_head_and_body)
{
    awt_collider colliders[AWT_MAX_COLLIDERS];
    uint32_t collider_count = awt_colliders_default(AWT_HEAD_RADIUS_M, colliders);
    for (size_t i = 0; i < awt_style_count(); i++) {
        awt_strands strands = grow(awt_style_at(i), STYLE_STRANDS, 1);
        double head = 1.0, body = 1.0;
        for (uint32_t p = 0; p < strands.point_count; p++) {
            vec3 at = point_of(&strands, p);
            head = fmin(head, (double)vec3_length(at) - AWT_HEAD_RADIUS_M);
            for (uint32_t k = 0; k < collider_count; k++) {
                body = fmin(body, distance_from(&colliders[k], at));
            }
        }
        CHECK(head > -0.0005);
        CHECK(body > -0.002);
        awt_strands_fini(&strands);
    }
}

/* The scalp is covered: seen from its centre, no place above the ears is far from a root. */
TEST(styles_cover_the_scalp_evenly)
{
    awt_strands strands = grow(awt_style_find("short"), STYLE_STRANDS, 1);
    double worst = 0.0;
    for (int u = 0; u < 20; u++) {
        for (int v = 0; v < 20; v++) {
            dvec3 place = {-0.6 + 1.2 * u / 19.0, 0.0, -0.8 + 1.2 * v / 19.0};
            double rest = 1.0 - place.x * place.x - place.z * place.z;
            if (rest < 0.15) {
                continue;
            }
            place.y = sqrt(rest);
            double least = 1.0;
            for (uint32_t s = 0; s < strands.strand_count; s++) {
                dvec3 root = dvec3_of_vec3(point_of(&strands, strands.first_point[s]));
                double away = dvec3_length(dvec3_sub(root, dvec3_scale(place, AWT_HEAD_RADIUS_M)));
                least = away < least ? away : least;
            }
            worst = least > worst ? least : worst;
        }
    }
    CHECK(worst < 0.005);
    awt_strands_fini(&strands);
}

/* Mean sine of the angle between one piece of a strand and the next, and how far strands bend in all, in turns. */
static double mean_bend(const awt_style *style, double *turns)
{
    awt_strands strands = grow(style, STYLE_STRANDS, 1);
    double sum = 0.0, count = 0.0;
    for (uint32_t s = 0; s < strands.strand_count; s++) {
        for (uint32_t p = strands.first_point[s] + 1; p + 1 < strands.first_point[s + 1]; p++) {
            vec3 a = vec3_sub(point_of(&strands, p), point_of(&strands, p - 1));
            vec3 b = vec3_sub(point_of(&strands, p + 1), point_of(&strands, p));
            sum += (double)(vec3_length(vec3_cross(a, b)) / (vec3_length(a) * vec3_length(b)));
            count += 1.0;
        }
    }
    *turns = sum / strands.strand_count / (2.0 * 3.14159);
    awt_strands_fini(&strands);
    return sum / count;
}

TEST(styles_curl_where_they_say_so)
{
    static const struct {
        const char *name;
        double least_turns, most_turns;
    } expected[] = {{"short", 0.0, 0.5}, {"long", 0.0, 0.6}, {"short-curly", 1.2, 4.0}, {"long-curly", 4.0, 9.0}};
    for (int i = 0; i < 4; i++) {
        double turns, bend = mean_bend(awt_style_find(expected[i].name), &turns);
        CHECK_NEAR(turns, 0.5 * (expected[i].least_turns + expected[i].most_turns),
                   0.5 * (expected[i].most_turns - expected[i].least_turns));
        CHECK(bend < 0.7071); /* at least eight points to a turn */
    }
}

TEST(styles_long_hair_falls_over_the_shoulders)
{
    awt_strands strands = grow(awt_style_find("long"), STYLE_STRANDS, 1);
    uint32_t below_chin = 0, left = 0, before = 0;
    for (uint32_t s = 0; s < strands.strand_count; s++) {
        vec3 tip = point_of(&strands, strands.first_point[s + 1] - 1);
        below_chin += tip.y < -0.2f;
        left += tip.x > 0.0f;
        before += tip.z > 0.0f;
    }
    CHECK(below_chin > STYLE_STRANDS * 9 / 10);
    CHECK(left > STYLE_STRANDS * 3 / 10 && left < STYLE_STRANDS * 7 / 10);
    CHECK(before > STYLE_STRANDS / 20 && before < STYLE_STRANDS / 2);
    awt_strands_fini(&strands);
}

TEST(styles_are_the_same_for_the_same_seed_only)
{
    for (size_t i = 0; i < awt_style_count(); i++) {
        awt_strands one = grow(awt_style_at(i), 500, 7), again = grow(awt_style_at(i), 500, 7);
        awt_strands other = grow(awt_style_at(i), 500, 8);
        CHECK_U64(strands_hash(&again), strands_hash(&one));
        CHECK(strands_hash(&other) != strands_hash(&one));
        awt_strands_fini(&one);
        awt_strands_fini(&again);
        awt_strands_fini(&other);
    }
}

/* A changed style or default collider gives other values: take them from the failing line, after a look at the hair. */
TEST(styles_are_the_same_on_every_compiler)
{
    static const uint64_t golden[4] = {UINT64_C(0xf42ab101cea854e5), UINT64_C(0x9508dd5b8834a3d3),
                                       UINT64_C(0x1ecc0bfb39c1e644), UINT64_C(0x507d344a8582d243)};
    for (size_t i = 0; i < 4; i++) {
        awt_strands strands = grow(awt_style_at(i), STYLE_STRANDS, 1);
        CHECK_U64(strands_hash(&strands), golden[i]);
        awt_strands_fini(&strands);
    }
}

TEST(styles_refuse_what_they_cannot_grow)
{
    const awt_style *style = awt_style_find("long");
    awt_strands untouched = {.strand_count = 77};
    awt_error error = {AWT_OK, ""};
    CHECK(awt_style_grow(style, 0, 1, &untouched, &error) == AWT_NO_STRANDS);
    CHECK(awt_style_grow(style, AWT_MAX_STRANDS + 1, 1, &untouched, &error) == AWT_LIMIT);
    CHECK_INT(error.status, AWT_LIMIT);
    awt_style finer = *style;
    finer.points_per_strand = AWT_MAX_POINTS_PER_STRAND;
    CHECK(awt_style_grow(&finer, AWT_MAX_STRANDS, 1, &untouched, &error) == AWT_LIMIT);
    finer.points_per_strand = 1;
    CHECK(awt_style_grow(&finer, 10, 1, &untouched, NULL) == AWT_LIMIT);
    CHECK_INT(untouched.strand_count, 77);
    CHECK(untouched.positions == NULL);
}

TEST(styles_grow_from_one_strand_up)
{
    for (size_t i = 0; i < awt_style_count(); i++) {
        for (uint32_t count = 1; count < 60; count += 29) {
            awt_strands strands = grow(awt_style_at(i), count, 3);
            CHECK_INT(strands.strand_count, count);
            for (uint32_t p = 0; p < strands.point_count; p++) {
                CHECK(vec3_finite(point_of(&strands, p)));
            }
            awt_strands_fini(&strands);
        }
    }
}
