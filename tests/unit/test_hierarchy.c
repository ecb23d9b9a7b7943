/* test_hierarchy.c: a hierarchy that comes with the strands: its file, and the groom that is built on it. */
#include "check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "awt.h"
#include "base/assert.h"
#include "base/bytes.h"
#include "groom/groom.h"
#include "groom_fixture.h"

enum { STRANDS = 60, LEVELS = 3 };

/* Strands scattered over 3 trees, 6 and 12 wisps, so that none of them is a run of strands. The numbers are `base` and
 * more, rising or falling with `step`. */
static awt_hierarchy hierarchy_scattered(uint32_t base, uint32_t step)
{
    awt_hierarchy h = {.levels = LEVELS, .strand_count = STRANDS};
    h.wisps = calloc((size_t)STRANDS * LEVELS, sizeof *h.wisps);
    ASSERT(h.wisps);
    for (uint32_t s = 0; s < STRANDS; s++) {
        for (uint32_t level = 0; level < LEVELS; level++) {
            h.wisps[s * LEVELS + level] = base + step * (s * 7 % (3u << level));
        }
    }
    return h;
}

static awt_status build(const awt_strands *strands, const awt_hierarchy *hierarchy, awt_groom **groom, awt_error *error)
{
    awt_groom_def def = awt_groom_def_default();
    def.hierarchy = hierarchy;
    return awt_groom_build(strands, &def, NULL, NULL, groom, error);
}

/* Builds on a patch of strands; NULL after a failed check. */
static awt_groom *build_patch(const awt_hierarchy *hierarchy)
{
    awt_strands strands = groom_fixture_patch(STRANDS);
    awt_groom *groom = NULL;
    awt_error error = {0};
    CHECK_TEXT(build(&strands, hierarchy, &groom, &error) == AWT_OK ? "built" : error.text, "built");
    awt_strands_fini(&strands);
    return groom;
}

/* Which strand of the input is strand k of the groom, by its root. */
static uint32_t strand_at(const awt_strands *strands, const awt_groom *groom, const float *rest, uint32_t k)
{
    const float *root = rest + 3 * (size_t)k * groom->info.points_per_strand;
    uint32_t nearest = 0;
    float least = 1e30f;
    for (uint32_t s = 0; s < strands->strand_count; s++) {
        const float *p = strands->positions + 3 * (size_t)strands->first_point[s];
        float d = vec3_distance(vec3_make(p[0], p[1], p[2]), vec3_make(root[0], root[1], root[2]));
        nearest = d < least ? s : nearest;
        least = d < least ? d : least;
    }
    return nearest;
}

/* ---- the groom --------------------------------------------------------------------------------------------------- */

TEST(hierarchy_of_the_file_is_the_groom_s)
{
    awt_hierarchy h = hierarchy_scattered(0, 1);
    awt_strands strands = groom_fixture_patch(STRANDS);
    awt_groom *groom = build_patch(&h);
    groom_fixture_check_sound(groom);
    CHECK_INT(groom->info.levels, LEVELS);
    float *rest = groom_fixture_rest(groom);
    for (uint32_t level = 0; level < LEVELS; level++) {
        CHECK_INT(groom->info.wisp_count[level], 3 << level);
        uint32_t k = 0, first_before = 0;
        for (uint32_t g = groom->level_first[level]; g < groom->level_first[level + 1]; g++) {
            const uint32_t first = strand_at(&strands, groom, rest, k);
            CHECK_INT(groom->gc_strand_count[g], STRANDS / (3 << level));
            /* wisps in the order of their first strands, inside the wisp above */
            CHECK(g == groom->level_first[level] || groom->gc_super[g] != groom->gc_super[g - 1] ||
                  first > first_before);
            first_before = first;
            uint32_t before = first;
            for (uint32_t n = 0; n < groom->gc_strand_count[g]; n++, k++) {
                uint32_t s = strand_at(&strands, groom, rest, k);
                CHECK_INT(h.wisps[s * LEVELS + level], h.wisps[first * LEVELS + level]);
                CHECK(n == 0 || level + 1 < LEVELS || s > before); /* a finest wisp's strands in their own order */
                before = s;
            }
        }
        CHECK_INT(k, STRANDS);
    }
    free(rest);
    awt_groom_destroy(groom);
    awt_strands_fini(&strands);
    awt_hierarchy_fini(&h);
}

TEST(hierarchy_with_other_numbers_is_the_same_groom)
{
    awt_hierarchy h = hierarchy_scattered(0, 1), renamed = hierarchy_scattered(UINT32_MAX, UINT32_MAX);
    awt_groom *groom = build_patch(&h), *other = build_patch(&renamed);
    CHECK_U64(groom_fixture_hash(other), groom_fixture_hash(groom));
    awt_groom_destroy(other);
    renamed.wisps[LEVELS * 5 + LEVELS - 1] = 77; /* one strand alone: another groom */
    other = build_patch(&renamed);
    CHECK_INT(other->info.wisp_count[LEVELS - 1], 13);
    CHECK(groom_fixture_hash(other) != groom_fixture_hash(groom));
    awt_groom_destroy(other);
    awt_groom_destroy(groom);
    awt_hierarchy_fini(&renamed);
    awt_hierarchy_fini(&h);
}

TEST(hierarchy_may_have_one_level_and_a_wisp_for_every_strand)
{
    uint32_t own[STRANDS];
    for (uint32_t s = 0; s < STRANDS; s++) {
        own[s] = 1000 - s;
    }
    awt_hierarchy h = {.levels = 1, .strand_count = STRANDS, .wisps = own};
    awt_groom *groom = build_patch(&h);
    CHECK_INT(groom->info.wisp_count[0], STRANDS);
    groom_fixture_check_sound(groom);
    awt_groom_destroy(groom);
}

static void check_refused(const awt_hierarchy *h, const char *what)
{
    awt_strands strands = groom_fixture_patch(STRANDS);
    awt_groom *groom = NULL;
    awt_error error = {0};
    CHECK_INT(build(&strands, h, &groom, &error), AWT_BAD_VALUE);
    CHECK(groom == NULL);
    CHECK_TEXT(strstr(error.text, what) ? what : error.text, what);
    awt_strands_fini(&strands);
}

TEST(hierarchy_that_does_not_fit_is_refused_with_strand_and_level)
{
    awt_hierarchy h = hierarchy_scattered(0, 1);
    h.wisps[LEVELS * 36 + 1] += 100; /* with strands 0, 12, 24, 48 at the finest level, but not at the one above */
    check_refused(&h, "strand 36 is in wisp 0 of level 3, as strand 0 is, but in another wisp of level 2");
    h.wisps[LEVELS * 12 + 0] += 1;
    check_refused(&h, "strand 12 is in wisp 0 of level 2, as strand 0 is, but in another wisp of level 1");
    awt_hierarchy_fini(&h);
    h = hierarchy_scattered(0, 1);
    h.strand_count = STRANDS - 1;
    check_refused(&h, "the hierarchy is of 59 strands, but there are 60");
    h.strand_count = STRANDS, h.levels = 0;
    check_refused(&h, "0 levels");
    h.levels = AWT_MAX_LEVELS + 1;
    check_refused(&h, "5 levels");
    awt_hierarchy_fini(&h);
}

/* A TressFX 4.0 file of two-point strands, of which those that `flat` names have no length. */
static void tfx_write(unsigned char *bytes, uint32_t strands, const bool *flat)
{
    memset(bytes, 0, 160);
    store_f32(bytes, 4.0f);
    store_u32(bytes + 4, strands);
    store_u32(bytes + 8, 2);
    store_u32(bytes + 12, 160);
    for (uint32_t s = 0; s < strands; s++) {
        for (uint32_t i = 0; i < 2; i++) {
            const float point[4] = {0.01f * (float)s, i && !flat[s] ? 0.2f : 0.1f, 0.0f, 1.0f};
            for (size_t axis = 0; axis < 4; axis++) {
                store_f32(bytes + 160 + (2 * s + i) * 16 + 4 * axis, point[axis]);
            }
        }
    }
}

TEST(hierarchy_has_rows_for_strands_that_are_left_out)
{
    const bool flat[6] = {true, false, false, true, false, true};
    unsigned char bytes[160 + 6 * 32];
    tfx_write(bytes, 6, flat);
    awt_strands strands = {0};
    CHECK_INT(awt_strands_read(bytes, sizeof bytes, &strands, NULL), AWT_OK);
    CHECK_INT(strands.skipped_count, 3);
    const uint32_t kept[3] = {1, 2, 4};
    CHECK_BYTES(strands.file_strand, kept, sizeof kept);

    uint32_t wisps[6] = {9, 5, 6, 8, 5, 7}; /* of those that are kept: 5 6 5 */
    awt_hierarchy h = {.levels = 1, .strand_count = 6, .wisps = wisps};
    awt_groom *groom = NULL;
    awt_error error = {0};
    CHECK_INT(build(&strands, &h, &groom, &error), AWT_OK);
    CHECK_INT(groom->info.wisp_count[0], 2);
    CHECK_INT(groom->gc_strand_count[0], 2);
    awt_groom_destroy(groom);

    h.strand_count = 3; /* a row for each strand that is kept is not enough: nobody knows them beforehand */
    CHECK_INT(build(&strands, &h, &groom, &error), AWT_BAD_VALUE);
    CHECK_TEXT(error.text, "the hierarchy is of 3 strands, but there are 6, counting those that are left out");
    h.strand_count = 6, strands.file_strand[2] = 6;
    CHECK_INT(build(&strands, &h, &groom, &error), AWT_BAD_VALUE);
    awt_strands_fini(&strands);
}

/* ---- the file ---------------------------------------------------------------------------------------------------- */

static awt_status read_text(const char *text, awt_hierarchy *out, awt_error *error)
{
    return awt_hierarchy_read(text, strlen(text), out, error);
}

TEST(hierarchy_file_takes_what_people_write)
{
    static const char *const texts[] = {
        "0 3 17\n0 3 18\n1 4294967295 19\n",
        "0,3,17\r\n0,3,18\r\n1,4294967295,19",
        "\xEF\xBB\xBF# tree, wisp, lock\n\n  0;\t3 ; 17 # the first\n0 3 18,\n   \n1, 4294967295, 0019\n#\n",
    };
    const uint32_t expected[9] = {0, 3, 17, 0, 3, 18, 1, UINT32_MAX, 19};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        awt_hierarchy h = {0};
        awt_error error = {0};
        CHECK_TEXT(read_text(texts[i], &h, &error) == AWT_OK ? "read" : error.text, "read");
        CHECK_INT(h.levels, 3);
        CHECK_INT(h.strand_count, 3);
        if (h.wisps && h.levels * h.strand_count == 9) {
            CHECK_BYTES(h.wisps, expected, sizeof expected);
        }
        awt_hierarchy_fini(&h);
    }
}

TEST(hierarchy_file_that_is_none_is_refused_with_its_line)
{
    static const struct {
        const char *text;
        awt_status status;
        const char *says;
    } bad[] = {
        {"", AWT_BAD_VALUE, "no line"},
        {"# nothing\n\n", AWT_BAD_VALUE, "no line"},
        {"1 2\n\n1 2 3\n", AWT_BAD_VALUE, "line 3 of the hierarchy has 3 numbers where the first has 2"},
        {"1 2\n1\n", AWT_BAD_VALUE, "line 2"},
        {"1 2\n1 -2\n", AWT_BAD_VALUE, "line 2"},
        {"tree,wisp\n1,2\n", AWT_BAD_VALUE, "line 1"},
        {"1 2.5\n", AWT_BAD_VALUE, "line 1"},
        {"1 4294967296\n", AWT_BAD_VALUE, "line 1"},
        {"1 99999999999999999999999999\n", AWT_BAD_VALUE, "line 1"},
        {"\x00\x00\x80\x40", AWT_BAD_VALUE, "no line"},
        {"1 2 3 4 5\n", AWT_LIMIT, "line 1 of the hierarchy has more than 4 numbers"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        awt_hierarchy h = {.levels = 99};
        awt_error error = {0};
        CHECK_INT(read_text(bad[i].text, &h, &error), bad[i].status);
        CHECK_TEXT(strstr(error.text, bad[i].says) ? bad[i].says : error.text, bad[i].says);
        CHECK_INT(h.levels, 99);
    }
    awt_error error = {0};
    awt_hierarchy h = {0};
    CHECK_INT(awt_hierarchy_read("1 2\n1 \x00\n", 7, &h, &error), AWT_BAD_VALUE); /* a NUL in the text */
}

TEST(hierarchy_file_has_no_more_lines_than_a_groom_strands)
{
    const size_t size = 2 * ((size_t)AWT_MAX_STRANDS + 1);
    char *text = malloc(size);
    ASSERT(text);
    for (size_t i = 0; i < size; i++) {
        text[i] = i % 2 ? '\n' : '7';
    }
    awt_hierarchy h = {0};
    CHECK_INT(awt_hierarchy_read(text, size, &h, NULL), AWT_LIMIT);
    CHECK_INT(awt_hierarchy_read(text, size - 2, &h, NULL), AWT_OK);
    CHECK_INT(h.strand_count, AWT_MAX_STRANDS);
    awt_hierarchy_fini(&h);
    free(text);
}

/* Exactly as many bytes as there are, so that a sanitizer sees a read beyond them. */
TEST(hierarchy_file_cut_anywhere_is_read_or_refused)
{
    static const char text[] = "\xEF\xBB\xBF# ids\n10, 20 ,30\n11,21 31# x\r\n12 22;32";
    for (size_t size = 0; size < sizeof text; size++) {
        char *bytes = malloc(size ? size : 1);
        ASSERT(bytes);
        memcpy(bytes, text, size);
        awt_hierarchy h = {0};
        awt_status status = awt_hierarchy_read(bytes, size, &h, NULL);
        CHECK(status == AWT_OK || (status == AWT_BAD_VALUE && !h.wisps));
        awt_hierarchy_fini(&h);
        free(bytes);
    }
}
