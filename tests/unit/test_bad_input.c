/* test_bad_input.c: numbers and files that are wrong: each is refused by name or left out and counted, and what was
 * there before is there after, to the bit. */
#include "check.h"
#include "groom_fixture.h"
#include "invariant_fixture.h"

#include "base/assert.h"
#include "base/bytes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- parameters ------------------------------------------------------------------------------------------------- */

enum { WRONG = 5 };

static void wrong_values(const awt_param_info *info, float wrong[WRONG])
{
    wrong[0] = NAN;
    wrong[1] = INFINITY;
    wrong[2] = -INFINITY;
    wrong[3] = nextafterf(info->least, -INFINITY);
    wrong[4] = nextafterf(info->greatest, INFINITY);
}

/* Parameter `index` of the list, which struct awt_params follows. */
static void put_param(awt_params *params, size_t index, float value)
{
    memcpy((char *)params + index * sizeof value, &value, sizeof value);
}

static awt_forest *moved_forest(const awt_groom *groom)
{
    awt_params params = small_params("short");
    awt_forest *f = small_forest(groom, &params);
    wild w = wild_make(2, 1.0);
    for (int n = 1; n <= 5; n++) {
        wild_advance(f, &w, (int64_t)n * AWT_STEP_US, NULL);
    }
    return f;
}

/* Nor does anything that was refused come to light later. */
static void check_they_go_on_alike(awt_forest *f, awt_forest *untouched)
{
    wild w = wild_make(2, 1.0);
    for (int n = 6; n <= 20; n++) {
        wild_advance(f, &w, (int64_t)n * AWT_STEP_US, NULL);
        wild_advance(untouched, &w, (int64_t)n * AWT_STEP_US, NULL);
    }
    CHECK_U64(awt_forest_hash(f), awt_forest_hash(untouched));
}

TEST(every_parameter_has_a_range_with_its_default_inside)
{
    CHECK_INT(sizeof(awt_params), awt_param_count() * sizeof(float));
    const awt_params defaults = awt_params_default();
    for (size_t k = 0; k < awt_param_count(); k++) {
        const awt_param_info *info = awt_param_at(k);
        CHECK(isfinite(info->least) && isfinite(info->greatest) && info->least < info->greatest);
        CHECK(info->value >= info->least && info->value <= info->greatest);
        CHECK(info->name[0] && info->text[0]);
        awt_params params = defaults, expected = defaults;
        put_param(&expected, k, info->least);
        CHECK_INT(awt_params_set(&params, info->name, info->least, NULL), AWT_OK);
        CHECK_BYTES(&params, &expected, sizeof params); /* it alone */
        put_param(&expected, k, info->greatest);
        CHECK_INT(awt_params_set(&params, info->name, info->greatest, NULL), AWT_OK);
        CHECK_BYTES(&params, &expected, sizeof params);
    }
}

TEST(every_parameter_out_of_range_is_refused_by_name_and_changes_nothing)
{
    awt_groom *groom = small_groom("short", 5);
    awt_forest *f = moved_forest(groom), *untouched = moved_forest(groom);
    const uint64_t hash = awt_forest_hash(f);
    const awt_params good = awt_forest_params(f);
    for (size_t k = 0; k < awt_param_count(); k++) {
        const awt_param_info *info = awt_param_at(k);
        float wrong[WRONG];
        wrong_values(info, wrong);
        for (int n = 0; n < WRONG; n++) {
            awt_error set = {AWT_OK, ""}, replaced = {AWT_OK, ""}, created = {AWT_OK, ""};
            awt_params params = good;
            CHECK_INT(awt_params_set(&params, info->name, wrong[n], &set), AWT_BAD_VALUE);
            CHECK_BYTES(&params, &good, sizeof params);
            put_param(&params, k, wrong[n]);
            CHECK_INT(awt_forest_set_params(f, &params, &replaced), AWT_BAD_VALUE);
            awt_forest_def def = awt_forest_def_default(groom);
            def.params = params;
            awt_forest *half_made = f;
            CHECK_INT(awt_forest_create(groom, &def, &half_made, &created), AWT_BAD_VALUE);
            CHECK(half_made == NULL);
            CHECK(strstr(set.text, info->name) && strstr(replaced.text, info->name) &&
                  strstr(created.text, info->name));
        }
        const awt_params after = awt_forest_params(f);
        CHECK_BYTES(&after, &good, sizeof after);
    }
    CHECK_U64(awt_forest_hash(f), hash);
    check_they_go_on_alike(f, untouched);
    awt_forest_destroy(f), awt_forest_destroy(untouched);
    awt_groom_destroy(groom);
}

TEST(a_forest_refuses_bad_motion_and_goes_on_as_if_it_had_never_come)
{
    awt_groom *groom = small_groom("short", 5);
    awt_forest *f = moved_forest(groom), *untouched = moved_forest(groom);
    wild w = wild_make(2, 1.0);
    const awt_motion good = wild_at(&w, 6 * AWT_STEP_US);
    awt_motion bad[8];
    for (int k = 0; k < 8; k++) {
        bad[k] = good;
    }
    for (int axis = 0; axis < 4; axis++) { /* of length 1.01, and of none */
        bad[0].head.orientation[axis] *= 1.01;
        bad[1].body.orientation[axis] *= 1.01;
        bad[2].head.orientation[axis] = 0;
    }
    bad[3].body.orientation[2] = (double)NAN;
    bad[4].head.position[1] = (double)INFINITY;
    bad[5].time_us = 5 * AWT_STEP_US; /* now */
    bad[6].collider_count = AWT_MAX_COLLIDERS + 1;
    bad[7].collider_count = 1, bad[7].colliders[0].id = 12345; /* nothing has that name */
    bad[7].colliders[0].pose = good.head;
    const uint64_t hash = awt_forest_hash(f);
    for (int k = 0; k < 8; k++) {
        awt_error error = {AWT_OK, ""};
        CHECK(awt_forest_move(f, &bad[k], &error) != AWT_OK);
        CHECK(error.status != AWT_OK && error.text[0]);
        CHECK_U64(awt_forest_hash(f), hash);
    }
    check_they_go_on_alike(f, untouched);
    awt_forest_destroy(f), awt_forest_destroy(untouched);
    awt_groom_destroy(groom);
}

/* ---- strand files ---------------------------------------------------------------------------------------------------
 */

enum { HAIR_HEADER = 128, TFX3_HEADER = 296, TFX4_HEADER = 160 };

TEST(ten_million_strands_announced_are_refused_before_anything_is_taken)
{
    static unsigned char bytes[3][400];
    store_f32(bytes[0], 3.0f), store_u32(bytes[0] + 8, 4), store_u32(bytes[0] + 144, TFX3_HEADER);
    store_f32(bytes[1], 4.0f), store_u32(bytes[1] + 8, 4), store_u32(bytes[1] + 12, TFX4_HEADER);
    memcpy(bytes[2], "HAIR", 4), store_u32(bytes[2] + 8, 40000000), store_u32(bytes[2] + 12, 2);
    store_u32(bytes[2] + 16, 3);
    for (int k = 0; k < 3; k++) {
        store_u32(bytes[k] + 4, 10000000);
        awt_strands strands = {0};
        awt_error error = {AWT_OK, ""};
        CHECK_INT(awt_strands_read(bytes[k], sizeof bytes[k], &strands, &error), AWT_LIMIT);
        CHECK(strstr(error.text, "10000000") != NULL);
        CHECK(strands.positions == NULL && strands.first_point == NULL);
    }
}

/* A cyHair file of `count` strands 1 cm apart and `short_ones` of a single point between them. */
static size_t hair_with_single_points(unsigned char *bytes, uint32_t count, uint32_t short_ones)
{
    size_t at = HAIR_HEADER;
    memset(bytes, 0, HAIR_HEADER);
    memcpy(bytes, "HAIR", 4);
    store_u32(bytes + 4, count + short_ones);
    store_u32(bytes + 8, 3 * count + short_ones);
    store_u32(bytes + 12, 3); /* it has segments, and points */
    for (uint32_t s = 0; s < count + short_ones; s++) {
        bytes[at++] = s < short_ones ? 0 : 2;
        bytes[at++] = 0;
    }
    for (uint32_t s = 0; s < count + short_ones; s++) {
        for (uint32_t i = 0; i < (s < short_ones ? 1u : 3u); i++, at += 12) {
            store_f32(bytes + at, 0.01f * (float)s);
            store_f32(bytes + at + 4, 0.1f + 0.05f * (float)i);
            store_f32(bytes + at + 8, 0);
        }
    }
    return at;
}

TEST(strands_of_one_point_in_a_file_are_left_out_and_counted)
{
    static unsigned char bytes[1024];
    awt_strands strands = {0};
    awt_error error = {AWT_OK, ""};
    size_t size = hair_with_single_points(bytes, 6, 4);
    CHECK_INT(awt_strands_read(bytes, size, &strands, &error), AWT_OK);
    CHECK_TEXT(error.text, "");
    CHECK_INT(strands.strand_count, 6);
    CHECK_INT(strands.skipped_count, 4);
    CHECK_INT(strands.point_count, 18);
    awt_strands_fini(&strands);
    size = hair_with_single_points(bytes, 0, 4);
    CHECK_INT(awt_strands_read(bytes, size, &strands, &error), AWT_NO_STRANDS);
    CHECK(strands.positions == NULL);
}

TEST(a_groom_of_strands_of_one_point_is_refused)
{
    awt_strands strands = groom_fixture_strands(5, 1);
    awt_groom_def def = awt_groom_def_default();
    awt_groom *groom = (awt_groom *)(void *)&def;
    awt_error error = {AWT_OK, ""};
    CHECK_INT(awt_groom_build(&strands, &def, NULL, NULL, &groom, &error), AWT_BAD_VALUE);
    CHECK(groom == NULL);
    CHECK(error.text[0] != 0);
    awt_strands_fini(&strands);
}

/* All roots in one point: no head can be guessed from them; told where it is, they are hair like any. */
TEST(strands_with_coincident_roots_need_to_be_told_their_head)
{
    awt_strands strands = groom_fixture_strands(40, 4);
    for (uint32_t s = 0; s < 40; s++) {
        for (uint32_t i = 0; i < 4; i++) {
            groom_fixture_put(&strands, s, i, 0.002 * i * (s % 7), 0.095 + 0.03 * i, 0.002 * i * (s % 5));
        }
    }
    const size_t size = 3 * (size_t)strands.point_count * sizeof(float);
    float *before = malloc(size);
    ASSERT(before);
    memcpy(before, strands.positions, size);
    awt_placement guess = {0};
    awt_error error = {AWT_OK, ""};
    CHECK_INT(awt_strands_place(&strands, &guess, &error), AWT_NO_HEAD);
    CHECK_BYTES(strands.positions, before, size);
    CHECK(!guess.guessed_head && guess.head_radius_m == 0);
    awt_placement told = {.scale = 1, .up = AWT_UP_Y, .head_radius = AWT_HEAD_RADIUS_M};
    CHECK_INT(awt_strands_place(&strands, &told, &error), AWT_OK);
    awt_groom_def def = awt_groom_def_default();
    awt_groom *groom = groom_fixture_build(&strands, &def);
    groom_fixture_check_sound(groom);
    awt_groom_destroy(groom);
    free(before);
    awt_strands_fini(&strands);
}
