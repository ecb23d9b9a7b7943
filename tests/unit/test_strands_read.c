/* test_strands_read.c: strand files in: the real ones, and hostile ones made here byte by byte. */
#include "check.h"

#include "awt.h"
#include "base/bytes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STRANDS = 12, POINTS = 5, HAIR_HEADER = 128, TFX3_HEADER = 296, TFX4_HEADER = 160 };

/* A file in the making: fixed room, grown from the front. */
typedef struct bytes_file {
    unsigned char bytes[4096];
    size_t size;
} bytes_file;

static void file_f32(bytes_file *file, float value)
{
    store_f32(file->bytes + file->size, value);
    file->size += 4;
}

static void file_u16(bytes_file *file, uint32_t value)
{
    file->bytes[file->size++] = (unsigned char)value;
    file->bytes[file->size++] = (unsigned char)(value >> 8);
}

/* Strand s rises from (s, 0, 0); x of its points tells strand and point. */
static void file_strand(bytes_file *file, uint32_t strand, uint32_t points, bool with_w)
{
    for (uint32_t i = 0; i < points; i++) {
        file_f32(file, (float)strand + 0.125f * (float)i);
        file_f32(file, 0.25f * (float)i);
        file_f32(file, -1.0f);
        if (with_w) {
            file_f32(file, i == 0 ? 0.0f : 1.0f);
        }
    }
}

static bytes_file tfx_make(float version)
{
    bytes_file file = {.size = version == 4.0f ? TFX4_HEADER : TFX3_HEADER};
    store_f32(file.bytes, version);
    store_u32(file.bytes + 4, STRANDS);
    store_u32(file.bytes + 8, POINTS);
    store_u32(file.bytes + (version == 4.0f ? 12 : 144), (uint32_t)file.size);
    for (uint32_t s = 0; s < STRANDS; s++) {
        file_strand(&file, s, POINTS, version == 4.0f);
    }
    return file;
}

/* With segments, strand s has 2 + s % 3 points. */
static bytes_file hair_make(bool with_segments)
{
    bytes_file file = {.size = HAIR_HEADER};
    uint32_t points = 0;
    memcpy(file.bytes, "HAIR", 4);
    for (uint32_t s = 0; s < STRANDS; s++) {
        points += with_segments ? 2 + s % 3 : POINTS;
        if (with_segments) {
            file_u16(&file, 1 + s % 3);
        }
    }
    store_u32(file.bytes + 4, STRANDS);
    store_u32(file.bytes + 8, points);
    store_u32(file.bytes + 12, with_segments ? 3 : 2);
    store_u32(file.bytes + 16, POINTS - 1);
    for (uint32_t s = 0; s < STRANDS; s++) {
        file_strand(&file, s, with_segments ? 2 + s % 3 : POINTS, false);
    }
    return file;
}

/* Reads from a heap block of exactly the file's size, so that the sanitizer sees every byte read beyond it. */
static awt_status read_exactly(const bytes_file *file, size_t size, awt_strands *out, awt_error *error)
{
    unsigned char *block = malloc(size ? size : 1);
    *out = (awt_strands){0};
    if (!block) {
        return AWT_NO_MEMORY;
    }
    memcpy(block, file->bytes, size);
    awt_status status = awt_strands_read(block, size, out, error);
    free(block);
    return status;
}

static void check_refused(const bytes_file *file, awt_status expected)
{
    awt_strands strands;
    awt_error error = {AWT_OK, ""};
    CHECK_INT(read_exactly(file, file->size, &strands, &error), expected);
    CHECK_INT(error.status, expected);
    CHECK(error.text[0] != '\0');
    CHECK(strands.positions == NULL);
    awt_strands_fini(&strands);
}

static void check_real_file(const char *name, uint32_t strands, uint32_t points_per_strand)
{
    const char *path = check_data(name);
    if (!path) {
        check_skip(name);
        return;
    }
    size_t size;
    unsigned char *bytes = check_read_file(path, &size);
    awt_strands read = {0};
    awt_error error = {AWT_OK, ""};
    CHECK_INT(awt_strands_read(bytes, size, &read, &error), AWT_OK);
    CHECK_TEXT(error.text, "");
    CHECK_INT(read.strand_count, strands);
    CHECK_INT(read.point_count, strands * points_per_strand);
    CHECK_INT(read.skipped_count, 0);
    for (uint32_t s = 0; s <= read.strand_count && read.first_point; s++) {
        if (read.first_point[s] != s * points_per_strand) {
            CHECK_INT(read.first_point[s], s * points_per_strand);
            break;
        }
    }
    awt_strands_fini(&read);
    free(bytes);
}

TEST(strands_read_sintel)
{
    check_real_file("hair/sintel_16pt.v4.tfx", 11400, 16);
}

TEST(strands_read_ratboy)
{
    check_real_file("hair/ratboy_mohawk.v4.tfx", 2228, 32);
}

TEST(strands_read_ponytail_tail)
{
    check_real_file("hair/ponytail_tail.v3.tfx", 474, 16);
}

TEST(strands_read_ponytail_front)
{
    check_real_file("hair/ponytail_front_top.v3.tfx", 876, 16);
}

TEST(strands_read_yuksel)
{
    check_real_file("hair/yuksel_straight.hair", 10000, 16);
}

TEST(strands_read_every_format_gives_its_points)
{
    bytes_file files[] = {tfx_make(3.0f), tfx_make(4.0f), hair_make(false), hair_make(true)};
    for (size_t f = 0; f < 4; f++) {
        awt_strands strands;
        CHECK_INT(read_exactly(&files[f], files[f].size, &strands, NULL), AWT_OK);
        CHECK_INT(strands.strand_count, STRANDS);
        uint32_t point = 0;
        for (uint32_t s = 0; s < strands.strand_count; s++) {
            uint32_t points = f == 3 ? 2 + s % 3 : POINTS;
            CHECK_INT(strands.first_point[s + 1] - strands.first_point[s], points);
            for (uint32_t i = 0; i < points; i++, point++) {
                CHECK_NEAR(strands.positions[3 * point], s + 0.125 * i, 0);
                CHECK_NEAR(strands.positions[3 * point + 1], 0.25 * i, 0);
                CHECK_NEAR(strands.positions[3 * point + 2], -1, 0);
            }
        }
        CHECK_INT(strands.point_count, point);
        awt_strands_fini(&strands);
    }
}

TEST(strands_read_refuses_every_truncation)
{
    bytes_file files[] = {tfx_make(3.0f), tfx_make(4.0f), hair_make(false), hair_make(true)};
    for (size_t f = 0; f < 4; f++) {
        for (size_t size = 0; size < files[f].size; size++) {
            awt_strands strands;
            awt_status status = read_exactly(&files[f], size, &strands, NULL);
            CHECK_INT(status, size < 4 ? AWT_BAD_FORMAT : AWT_TRUNCATED);
            awt_strands_fini(&strands);
        }
    }
}

TEST(strands_read_refuses_lying_counts)
{
    static const uint32_t lies[] = {0,          STRANDS + 1, 0x10000,    0x10000000,
                                    0x40000000, 0x7fffffff,  0x80000000, 0xffffffff};
    bytes_file files[] = {tfx_make(3.0f), tfx_make(4.0f), hair_make(false), hair_make(true)};
    for (size_t f = 0; f < 4; f++) {
        for (size_t field = 4; field <= 8; field += 4) {
            for (size_t i = 0; i < sizeof lies / sizeof lies[0]; i++) {
                bytes_file file = files[f];
                awt_strands strands;
                store_u32(file.bytes + field, lies[i]);
                CHECK(read_exactly(&file, file.size, &strands, NULL) != AWT_OK);
                awt_strands_fini(&strands);
            }
        }
    }
}

TEST(strands_read_says_what_did_not_fit)
{
    bytes_file file = tfx_make(4.0f);
    awt_strands strands;
    awt_error error;
    store_u32(file.bytes + 4, 11400);
    store_u32(file.bytes + 8, 16);
    CHECK_INT(read_exactly(&file, 1000, &strands, &error), AWT_TRUNCATED);
    CHECK_TEXT(error.text, "the header announces 11400 strands of 16 points, 2918400 bytes at offset 160, but the file "
                           "has 1000");
}

TEST(strands_read_counts_whose_product_wraps_are_refused)
{
    bytes_file file = tfx_make(4.0f);
    store_u32(file.bytes + 4, 0x10000000); /* 2^28 strands of 16 points of 16 bytes: 2^36 bytes, 0 in 32 bits */
    store_u32(file.bytes + 8, 16);
    check_refused(&file, AWT_LIMIT);
    store_u32(file.bytes + 4, AWT_MAX_STRANDS);
    store_u32(file.bytes + 8, AWT_MAX_POINTS_PER_STRAND); /* each within its limit, together not */
    check_refused(&file, AWT_LIMIT);
    store_u32(file.bytes + 4, 1);
    store_u32(file.bytes + 8, AWT_MAX_POINTS_PER_STRAND + 1);
    check_refused(&file, AWT_LIMIT);
}

TEST(strands_read_refuses_offsets_outside_the_data)
{
    bytes_file file = tfx_make(4.0f);
    store_u32(file.bytes + 12, TFX4_HEADER - 4);
    check_refused(&file, AWT_BAD_VALUE);
    store_u32(file.bytes + 12, TFX4_HEADER + 2);
    check_refused(&file, AWT_BAD_VALUE);
    store_u32(file.bytes + 12, 0xfffffffc);
    check_refused(&file, AWT_TRUNCATED);
    store_u32(file.bytes + 12, TFX4_HEADER + 4);
    check_refused(&file, AWT_TRUNCATED);
}

TEST(strands_read_refuses_a_number_that_is_not_finite)
{
    awt_strands strands;
    awt_error error;
    for (int axis = 0; axis < 3; axis++) {
        bytes_file file = hair_make(false);
        store_f32(file.bytes + HAIR_HEADER + 12 * (POINTS + 2) + 4 * axis, axis == 1 ? INFINITY : NAN);
        CHECK_INT(read_exactly(&file, file.size, &strands, &error), AWT_BAD_VALUE);
        CHECK_TEXT(error.text, "strand 1, point 2 (counted from 0): a coordinate is not a finite number");
    }
}

TEST(strands_read_skips_and_counts_strands_without_length)
{
    bytes_file file = tfx_make(3.0f);
    for (size_t i = 1; i < POINTS; i++) { /* strand 0: all points at its root */
        memcpy(file.bytes + TFX3_HEADER + 12 * i, file.bytes + TFX3_HEADER, 12);
    }
    memcpy(file.bytes + TFX3_HEADER + 12 * (POINTS + 1), file.bytes + TFX3_HEADER + 12 * POINTS,
           12); /* 1: one repeat */
    awt_strands strands;
    CHECK_INT(read_exactly(&file, file.size, &strands, NULL), AWT_OK);
    CHECK_INT(strands.strand_count, STRANDS - 1);
    CHECK_INT(strands.skipped_count, 1);
    CHECK_INT(strands.first_point[1], POINTS);
    CHECK_NEAR(strands.positions[0], 1, 0);
    CHECK_INT(strands.point_count, (STRANDS - 1) * POINTS);
    awt_strands_fini(&strands);
}

TEST(strands_read_refuses_a_file_of_strands_without_length)
{
    bytes_file file = tfx_make(4.0f);
    memset(file.bytes + TFX4_HEADER, 0, file.size - TFX4_HEADER);
    check_refused(&file, AWT_NO_STRANDS);
    store_u32(file.bytes + 8, 1);
    check_refused(&file, AWT_NO_STRANDS);
    store_u32(file.bytes + 4, 0);
    check_refused(&file, AWT_NO_STRANDS);
}

TEST(strands_read_cyhair_needs_points_that_add_up)
{
    bytes_file file = hair_make(true);
    file.bytes[HAIR_HEADER] = 2; /* strand 0: one segment more */
    check_refused(&file, AWT_BAD_VALUE);
    file.bytes[HAIR_HEADER + 1] = 0xff; /* 65282 segments */
    check_refused(&file, AWT_LIMIT);
    file = hair_make(false);
    store_u32(file.bytes + 16, POINTS); /* default segments */
    check_refused(&file, AWT_BAD_VALUE);
    store_u32(file.bytes + 16, POINTS - 2);
    check_refused(&file, AWT_BAD_VALUE);
    store_u32(file.bytes + 16, 0xffffffff); /* + 1 is 0 in 32 bits */
    check_refused(&file, AWT_LIMIT);
    file = hair_make(false);
    store_u32(file.bytes + 12, 0x1c); /* everything but the points */
    check_refused(&file, AWT_BAD_FORMAT);
}

static void check_colour(const bytes_file *file, float red, float green, float blue)
{
    const float expected[3] = {red, green, blue};
    awt_strands strands;
    CHECK_INT(read_exactly(file, file->size, &strands, NULL), AWT_OK);
    for (int k = 0; k < 3; k++) {
        CHECK(fabsf(strands.colour[k] - expected[k]) < 2e-3f);
    }
    awt_strands_fini(&strands);
}

TEST(strands_read_cyhair_has_the_colour_of_its_points_or_of_its_header)
{
    bytes_file file = hair_make(false);
    check_colour(&file, 0, 0, 0);
    store_f32(file.bytes + 28, 1.0f);
    store_f32(file.bytes + 32, 0.5f);
    check_colour(&file, 1, 0.2140f, 0); /* a screen's half is a fifth of the light */
    store_u32(file.bytes + 12, 0x12);
    for (uint32_t i = 0; i < STRANDS * POINTS; i++) {
        file_f32(&file, 0.0f);
        file_f32(&file, i % 2 ? 1.0f : 0.6f);
        file_f32(&file, 1.0f);
    }
    check_colour(&file, 0, 0.6038f, 1);
    store_f32(file.bytes + file.size - 4, NAN);
    check_colour(&file, 0, 0, 0);
    store_f32(file.bytes + file.size - 4, 1.001f);
    check_colour(&file, 0, 0, 0);
}

TEST(strands_read_refuses_what_is_no_strand_file)
{
    bytes_file file = {.bytes = "glTF, or some other file that awt does not read", .size = 48};
    check_refused(&file, AWT_BAD_FORMAT);
    file = tfx_make(4.0f);
    store_f32(file.bytes, 4.5f);
    check_refused(&file, AWT_BAD_FORMAT);
    store_f32(file.bytes, NAN);
    check_refused(&file, AWT_BAD_FORMAT);
}

TEST(strands_read_fini_leaves_a_zeroed_object)
{
    bytes_file file = tfx_make(4.0f);
    awt_strands strands;
    CHECK_INT(read_exactly(&file, file.size, &strands, NULL), AWT_OK);
    awt_strands_fini(&strands);
    CHECK(strands.positions == NULL && strands.first_point == NULL);
    awt_strands_fini(&strands);
}

TEST(bytes_are_little_endian)
{
    static const unsigned char bytes[] = {0x00, 0x00, 0x80, 0xbf, 0x34, 0x12};
    CHECK_INT(load_u16(bytes + 4), 0x1234);
    CHECK_INT(load_u32(bytes + 2), 0x1234bf80);
    CHECK_NEAR(load_f32(bytes), -1, 0);
}
