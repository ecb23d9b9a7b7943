/* test_groom_build.c: what holds of every groom, whatever its strands. */
#include "check.h"

#include <math.h>
#include <stdlib.h>
#include "awt.h"
#include "base/trig.h"
#include "fixture.h"
#include "groom/groom.h"
#include "groom_fixture.h"

/* ---- the hierarchy ---- */

TEST(groom_every_strand_is_in_one_wisp_of_each_level)
{
    for (uint32_t levels = 1; levels <= AWT_MAX_LEVELS; levels++) {
        awt_groom *groom = groom_fixture_build_patch(700, levels, levels > 1 ? 5 : 0, 60);
        CHECK_INT(groom->info.wisp_count[levels - 1], 60);
        CHECK_INT(groom->info.wisp_count[0], levels > 1 ? 5 : 60);
        CHECK_INT(groom->info.finest_nodes, 60 * groom->info.sections);
        groom_fixture_check_partition(groom);
        awt_groom_destroy(groom);
    }
    groom_fixture_check_partition(fixture_groom("long", AWT_DEFAULT_STRANDS));
}

TEST(groom_levels_between_refine_by_equal_factors)
{
    awt_groom *groom = groom_fixture_build_patch(700, 4, 5, 320);
    CHECK_INT(groom->info.wisp_count[1], 20);
    CHECK_INT(groom->info.wisp_count[2], 80);
    awt_groom_destroy(groom);
}

TEST(groom_super_wisp_is_the_centre_of_mass_and_contains_its_subs)
{
    const awt_groom *groom = fixture_groom("long", AWT_DEFAULT_STRANDS);
    const uint32_t sections = groom->info.sections;
    double worst_centre = 0.0, worst_radius = 0.0;
    for (uint32_t g = 0; g < groom_finest_first(groom); g++) {
        for (uint32_t i = 0; i < sections; i++) {
            vec3 centre = groom->rest_position[g * sections + i];
            dvec3 sum = {0, 0, 0};
            for (uint32_t k = 0; k < groom->gc_sub_count[g]; k++) {
                uint32_t sub = groom->gc_sub_first[g] + k;
                vec3 place = groom->rest_position[sub * sections + i];
                sum = dvec3_add(sum, dvec3_scale(dvec3_of_vec3(place), groom->gc_strand_count[sub]));
                double out = (double)(vec3_distance(centre, place) + groom->rest_radius[sub * sections + i] -
                                      groom->rest_radius[g * sections + i]);
                worst_radius = out > worst_radius ? out : worst_radius;
            }
            dvec3 mean = dvec3_scale(sum, 1.0 / groom->gc_strand_count[g]);
            double off = dvec3_length(dvec3_sub(mean, dvec3_of_vec3(centre)));
            worst_centre = off > worst_centre ? off : worst_centre;
        }
    }
    CHECK_NEAR(worst_centre, 0.0, 1e-6);
    CHECK_NEAR(worst_radius, 0.0, 1e-6);
}

TEST(groom_mass_is_whole_units_of_a_power_of_two)
{
    const awt_groom *groom = fixture_groom("long", AWT_DEFAULT_STRANDS);
    int exponent;
    CHECK(frexpf(groom->mass_unit_kg, &exponent) == 0.5f);
    for (uint32_t level = 0; level < groom->info.levels; level++) {
        float mass = 0.0f;
        for (uint32_t g = groom->level_first[level]; g < groom->level_first[level + 1]; g++) {
            mass += (float)groom->gc_strand_count[g] * groom->mass_unit_kg;
        }
        CHECK((double)mass * groom->info.sections == groom->info.mass_kg);
    }
    double coarse_node_kg = groom->info.mass_kg / groom->info.coarse_nodes;
    CHECK(coarse_node_kg >= 0.001 && coarse_node_kg < 0.002);
}

TEST(groom_has_no_more_wisps_than_strands)
{
    awt_groom *groom = groom_fixture_build_patch(7, 3, 10, 100);
    CHECK_INT(groom->info.wisp_count[0], 7);
    CHECK_INT(groom->info.wisp_count[2], 7);
    groom_fixture_check_partition(groom);
    awt_groom_destroy(groom);
}

/* ---- the wisps' shape and the strands' binding ---- */

TEST(groom_at_rest_evaluates_to_the_strands_it_was_built_from)
{
    awt_strands strands = groom_fixture_patch(600);
    awt_groom_def def = awt_groom_def_default();
    awt_groom *groom = groom_fixture_build(&strands, &def);
    groom_fixture_check_strands(&strands, groom, 1e-6);
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);

    CHECK(awt_style_grow(awt_style_find("long-curly"), 500, 1, &strands, NULL) == AWT_OK);
    def = awt_groom_def_of_style(awt_style_find("long-curly"));
    groom = groom_fixture_build(&strands, &def);
    groom_fixture_check_strands(&strands, groom, 1e-6);
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
}

TEST(groom_keeps_the_file_order_inside_a_wisp)
{
    awt_strands strands = groom_fixture_patch(300);
    awt_groom_def def = awt_groom_def_default();
    def.levels = 1, def.finest_wisps = 1;
    awt_groom *groom = groom_fixture_build(&strands, &def);
    float *rest = groom_fixture_rest(groom);
    for (size_t i = 0; i < (size_t)strands.point_count * 3; i++) {
        if (!(fabsf(rest[i] - strands.positions[i]) < 1e-6f)) {
            CHECK_INT(i / 3, -1);
            break;
        }
    }
    free(rest);
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
}

/* Strands of one wisp differ in length; their points are as far ahead of their stations as their own length asks for.
 */
TEST(groom_points_lie_beside_their_stations)
{
    const awt_groom *groom = fixture_groom("long", AWT_DEFAULT_STRANDS);
    const uint32_t points = groom->info.points_per_strand;
    double ahead = 0.0;
    for (size_t s = 0; s < groom->info.strand_count; s++) {
        for (uint32_t i = 0; i < points; i++) {
            ahead += (double)fabsf(groom->strand_offset[(3 * s + 1) * points + i]) / points / groom->info.strand_count;
        }
    }
    CHECK(ahead < 0.05 * groom->info.median_strand_m);
}

TEST(groom_section_frames_turn_with_the_curve_and_no_more)
{
    const awt_groom *groom = fixture_groom("long", AWT_DEFAULT_STRANDS);
    const uint32_t sections = groom->info.sections, first = groom_finest_first(groom);
    double worst_length = 0.0, worst_along = 0.0, worst_twist = 0.0;
    for (uint32_t w = 0; w < groom->info.wisp_count[groom->info.levels - 1]; w++) {
        const vec3 *centre = groom->rest_position + (size_t)(first + w) * sections;
        const quat *frame = groom->rest_frame + (size_t)w * sections;
        for (uint32_t i = 1; i + 1 < sections; i++) {
            mat3 axes = mat3_of_quat(frame[i]), before = mat3_of_quat(frame[i - 1]);
            vec3 along = vec3_unit(vec3_sub(centre[i + 1], centre[i - 1]), vec3_make(0, 0, 0));
            worst_length = fmax(worst_length, fabs((double)vec3_length(axes.y) - 1.0));
            worst_along = fmax(worst_along, (double)vec3_distance(axes.y, along));
            /* turning the frame before by the least turn of its axis must give this one */
            vec3 carried = quat_rotate(quat_between(before.y, axes.y), before.x);
            worst_twist = fmax(worst_twist, (double)vec3_distance(carried, axes.x));
        }
    }
    CHECK_NEAR(worst_length, 0.0, 1e-5);
    CHECK_NEAR(worst_along, 0.0, 1e-4);
    CHECK_NEAR(worst_twist, 0.0, 1e-3);
}

/* Strands that curl in one phase, eight turns of 50 mm, about a straight line down from the side of the head. */
static awt_strands strands_ringlet(uint32_t strand_count, double curl_m)
{
    enum { RINGLET_POINTS = 128 };
    awt_strands strands = groom_fixture_strands(strand_count, RINGLET_POINTS);
    for (uint32_t s = 0; s < strand_count; s++) {
        for (uint32_t i = 0; i < RINGLET_POINTS; i++) {
            double way = 0.4 * i / (RINGLET_POINTS - 1), sine, cosine;
            double grown = way < 0.05 ? way / 0.05 : 1.0;
            trig_sin_cos(2.0 * TRIG_PI * way / 0.05, &sine, &cosine);
            groom_fixture_put(&strands, s, i, 0.1 + 0.0002 * s + curl_m * grown * cosine, -way, curl_m * grown * sine);
        }
    }
    return strands;
}

TEST(groom_wisp_follows_the_axis_of_a_curl_and_holds_the_curl_in_its_radius)
{
    awt_strands strands = strands_ringlet(12, 0.010);
    awt_groom_def def = awt_groom_def_default();
    def.levels = 1, def.finest_wisps = 1, def.sections = 16;
    awt_groom *groom = groom_fixture_build(&strands, &def);
    for (uint32_t i = 3; i < 13; i++) {
        CHECK_NEAR(groom->rest_position[i].x, 0.1 + 0.0002 * 5.5, 0.003);
        CHECK_NEAR(groom->rest_position[i].z, 0.0, 0.003);
        CHECK(groom->rest_radius[i] > 0.010f && groom->rest_radius[i] < 0.020f);
    }
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
}

TEST(groom_box_holds_the_strands_and_the_head)
{
    const awt_groom *groom = fixture_groom("short", 2000);
    awt_groom_info info;
    awt_groom_get_info(groom, &info);
    float *rest = groom_fixture_rest(groom);
    for (size_t i = 0; i < (size_t)info.strand_count * info.points_per_strand * 3; i++) {
        CHECK(rest[i] > info.box_min[i % 3] && rest[i] < info.box_max[i % 3]);
    }
    for (int axis = 0; axis < 3; axis++) {
        CHECK((double)info.box_min[axis] <= -AWT_HEAD_RADIUS_M && (double)info.box_max[axis] >= AWT_HEAD_RADIUS_M);
        CHECK((double)(info.box_max[axis] - info.box_min[axis]) > 2.0 * 1.5625 * info.longest_strand_m);
    }
    CHECK(info.longest_strand_m >= info.median_strand_m && info.median_strand_m > 0.0);
    CHECK(info.bytes > (size_t)info.strand_count * info.points_per_strand * (sizeof(vec3) + sizeof(uint16_t)));
    free(rest);
}

/* ---- the same every time ---- */

TEST(groom_is_the_same_whenever_it_is_built)
{
    const uint64_t hash = groom_fixture_hash(fixture_groom("short", 2000));
    awt_strands strands;
    CHECK(awt_style_grow(awt_style_find("short"), 2000, 1, &strands, NULL) == AWT_OK);
    awt_groom_def def = awt_groom_def_of_style(awt_style_find("short"));
    awt_groom *groom = groom_fixture_build(&strands, &def);
    CHECK_U64(groom_fixture_hash(groom), hash);
    awt_groom_destroy(groom);
    strands.positions[4] += 1e-6f;
    groom = groom_fixture_build(&strands, &def);
    CHECK(groom_fixture_hash(groom) != hash);
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
}

TEST(groom_is_the_same_on_every_compiler)
{
    awt_groom *groom = groom_fixture_build_patch(700, 3, 5, 60);
    CHECK_U64(groom_fixture_hash(groom), UINT64_C(0x13c953fc7226b476));
    awt_groom_destroy(groom);
}

typedef struct heard {
    double last;
    int count;
    bool fell;
} heard;

static void hear(void *context, double share)
{
    heard *h = context;
    h->fell = h->fell || share < h->last || share < 0.0 || share > 1.0;
    h->last = share;
    h->count++;
}

TEST(groom_progress_rises_to_one)
{
    awt_strands strands = groom_fixture_patch(3000);
    awt_groom_def def = awt_groom_def_default();
    awt_groom *groom = NULL;
    heard h = {0};
    CHECK(awt_groom_build(&strands, &def, hear, &h, &groom, NULL) == AWT_OK);
    CHECK(!h.fell && h.last == 1.0 && h.count > 6);
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
}

TEST(groom_of_a_film_head_of_hair)
{
    const char *path = check_data("hair/sintel_16pt.v4.tfx");
    if (!path) {
        check_skip("the real strand files are not on this machine");
        return;
    }
    size_t size = 0;
    unsigned char *bytes = check_read_file(path, &size);
    awt_strands strands = {0};
    awt_placement placement = {0};
    CHECK(bytes && awt_strands_read(bytes, size, &strands, NULL) == AWT_OK);
    CHECK(awt_strands_place(&strands, &placement, NULL) == AWT_OK);
    awt_groom_def def = awt_groom_def_default();
    def.head_radius_m = placement.head_radius_m;
    awt_groom *groom = groom_fixture_build(&strands, &def);
    if (groom) {
        CHECK_INT(groom->info.points_per_strand, 16);
        CHECK_INT(groom->info.sections, 6); /* segments of about 2 cm */
        CHECK_INT(groom->info.finest_nodes, 6000);
        groom_fixture_check_sound(groom);
    }
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
    free(bytes);
}
