/* test_geom_reader.c: frames from strangers: cut short, damaged, lying about themselves. */
#include "check.h"

#include "base/rng.h"
#include "geom/buffer.h"
#include "geom/draco_shim.h"
#include "geom/glb.h"
#include "geom/json.h"
#include "geom/json_number.h"
#include "geom/read.h"
#include "unit/geom_fixture.h"

#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static awt_status read_bytes(const unsigned char *bytes, size_t size)
{
    geom_strands strands = {0};
    awt_error error = {0};
    awt_status status = geom_read_frame(bytes, size, &strands, &error);
    CHECK((status == AWT_OK) == (error.text[0] == '\0'));
    CHECK((status == AWT_OK) == (strands.positions != NULL));
    geom_strands_fini(&strands);
    return status;
}

/* Reads a copy of exactly that size, so that the sanitizers see each byte read beyond it. */
static awt_status read_copy(const unsigned char *bytes, size_t size)
{
    unsigned char *copy = malloc(size ? size : 1);
    CHECK(copy != NULL);
    if (size > 0) {
        memcpy(copy, bytes, size);
    }
    awt_status status = read_bytes(copy, size);
    free(copy);
    return status;
}

TEST(geom_reader_refuses_every_truncation)
{
    geom_fixture f;
    geom_fixture_init(&f, 20, 8, 2);
    geom_fixture_encode(&f, NULL);
    CHECK_INT(read_copy(f.frame.bytes, f.frame.size), AWT_OK);
    for (size_t size = 0; size < f.frame.size; size++) {
        CHECK_INT(read_copy(f.frame.bytes, size), AWT_TRUNCATED);
    }
    /* the same with a header that agrees with the shorter length */
    for (size_t size = 12; size < f.frame.size; size++) {
        uint32_t length = (uint32_t)size;
        memcpy(f.frame.bytes + 8, &length, 4);
        CHECK_INT(read_copy(f.frame.bytes, size), AWT_BAD_FORMAT);
    }
    geom_fixture_fini(&f);
}

TEST(geom_reader_refuses_trailing_bytes)
{
    geom_fixture f;
    geom_fixture_init(&f, 20, 8, 2);
    geom_fixture_encode(&f, NULL);
    unsigned char *longer = calloc(1, f.frame.size + 4);
    memcpy(longer, f.frame.bytes, f.frame.size);
    CHECK_INT(read_bytes(longer, f.frame.size + 4), AWT_BAD_FORMAT);
    uint32_t length = (uint32_t)f.frame.size + 4;
    memcpy(longer + 8, &length, 4);
    CHECK_INT(read_bytes(longer, f.frame.size + 4), AWT_BAD_FORMAT);
    free(longer);
    geom_fixture_fini(&f);
}

/* Seeded flips of 1 to 4 bytes anywhere, then as many in the Draco data alone. What is read well in spite of them
 * (a position moved, another time) must hold finite numbers, which geom_read_frame promises. */
TEST(geom_reader_survives_random_damage)
{
    geom_fixture f;
    geom_fixture_init(&f, 24, 8, 2);
    geom_fixture_encode(&f, NULL);
    uint32_t json_size = 0;
    memcpy(&json_size, f.frame.bytes + 12, 4);
    size_t data = 20 + json_size + 8;
    rng r = rng_seed(7);
    int read = 0;
    for (int round = 0; round < 3000; round++) {
        size_t first = round % 2 ? data : 0, places[4];
        unsigned char kept[4];
        int flips = 1 + (int)(rng_u32(&r) % 4);
        for (int k = 0; k < flips; k++) {
            places[k] = first + rng_u32(&r) % (f.frame.size - first);
            kept[k] = f.frame.bytes[places[k]];
            f.frame.bytes[places[k]] = (unsigned char)rng_u32(&r);
        }
        read += read_bytes(f.frame.bytes, f.frame.size) == AWT_OK;
        for (int k = flips; k-- > 0;) {
            f.frame.bytes[places[k]] = kept[k];
        }
    }
    CHECK(read > 0 && read < 3000);
    CHECK_INT(read_bytes(f.frame.bytes, f.frame.size), AWT_OK);
    geom_fixture_fini(&f);
}

/* Puts `with` (of the same length) where `what` stands in the JSON and reads; then puts it back. */
static awt_status read_with(geom_buffer *frame, const char *what, const char *with)
{
    size_t length = strlen(what);
    CHECK_U64(strlen(with), length);
    for (size_t i = 20; i + length < frame->size; i++) {
        if (memcmp(frame->bytes + i, what, length) == 0) {
            memcpy(frame->bytes + i, with, length);
            awt_status status = read_bytes(frame->bytes, frame->size);
            memcpy(frame->bytes + i, what, length);
            return status;
        }
    }
    check_true(__FILE__, __LINE__, what, false);
    return AWT_OK;
}

TEST(geom_reader_refuses_a_json_that_lies)
{
    geom_fixture f;
    geom_fixture_init(&f, 3000, 16, 3);
    geom_fixture_encode(&f, NULL);
    geom_buffer *frame = &f.frame;
    CHECK_INT(read_with(frame, "\"strands\":3000", "\"strands\":3000"), AWT_OK);
    CHECK_INT(read_with(frame, "\"strands\":3000", "\"strands\":3001"), AWT_BAD_VALUE);
    CHECK_INT(read_with(frame, "\"strands\":3000", "\"strands\":9e99"), AWT_BAD_VALUE);
    CHECK_INT(read_with(frame, "\"strands\":3000", "\"strands\":-300"), AWT_BAD_VALUE);
    CHECK_INT(read_with(frame, "\"strands\":3000", "\"strands\":2e+5"), AWT_BAD_VALUE);
    CHECK_INT(read_with(frame, "\"full_strands\":3000", "\"full_strands\":3001"), AWT_BAD_VALUE);
    CHECK_INT(read_with(frame, "\"level\":\"full\"", "\"level\":\"wide\""), AWT_BAD_VALUE);
    CHECK_INT(read_with(frame, "\"strands\":1000", "\"strands\":1001"), AWT_BAD_FORMAT);
    CHECK_INT(read_with(frame, "\"strands\":1000", "\"strands\":0000"), AWT_BAD_FORMAT);
    CHECK_INT(read_with(frame, "\"points_per_strand\":16", "\"points_per_strand\":17"), AWT_BAD_VALUE);
    CHECK_INT(read_with(frame, "\"points_per_strand\":16", "\"points_per_strand\":00"), AWT_BAD_VALUE);
    CHECK_INT(read_with(frame, "\"points_per_strand\":16", "\"points_per_strand\":1 "), AWT_BAD_VALUE);
    CHECK_INT(read_with(frame, "\"first_strand\":2000", "\"first_strand\":1999"), AWT_BAD_FORMAT);
    CHECK_INT(read_with(frame, "\"bufferView\":1", "\"bufferView\":3"), AWT_BAD_FORMAT);
    CHECK_INT(read_with(frame, "\"kind\":\"ribbon\"", "\"kind\":\"rabbit\""), AWT_BAD_VALUE);
    CHECK_INT(read_with(frame, "\"kind\":", "\"kink\":"), AWT_BAD_VALUE);
    CHECK_INT(read_with(frame, "\"widths\":[0", "\"widths\":[-"), AWT_BAD_VALUE);
    CHECK_INT(read_with(frame, "\"mode\":4", "\"mode\":5"), AWT_BAD_FORMAT);
    CHECK_INT(read_with(frame, "\"indices\":2", "\"indices\":7"), AWT_BAD_FORMAT);
    CHECK_INT(read_with(frame, "\"indices\":2", "\"indices\":1"), AWT_BAD_FORMAT);
    CHECK_INT(read_with(frame, "\"POSITION\":3", "\"POSITION\":9"), AWT_BAD_FORMAT);
    CHECK_INT(read_with(frame, "\"count\":32000", "\"count\":32001"), AWT_BAD_FORMAT);
    CHECK_INT(read_with(frame, "\"byteLength\":", "\"byteLengzh\":"), AWT_BAD_FORMAT);
    CHECK_INT(read_with(frame, "\"time_us\":5000000123  ", "\"time_us\":5000000123.5"), AWT_BAD_VALUE);
    CHECK_INT(read_with(frame, "\"time_us\":5000000123", "\"time_us\":1e99999999"), AWT_BAD_VALUE);
    CHECK_INT(read_with(frame, "\"rotation\":[0.1", "\"rotation\":[9.1"), AWT_BAD_VALUE);
    CHECK_INT(read_with(frame, "\"translation\":[1", "\"translation\":[x"), AWT_BAD_FORMAT);
    CHECK_INT(read_with(frame, "\"name\":\"hair\",\"rotation\"", "\"name\":\"hare\",\"rotation\""), AWT_BAD_FORMAT);
    geom_fixture_fini(&f);
}

TEST(geom_reader_refuses_data_beyond_the_binary_chunk)
{
    geom_fixture f;
    geom_fixture_init(&f, 300, 16, 3);
    geom_fixture_encode(&f, NULL);
    char *view = strstr((char *)f.frame.bytes + 20, "\"byteLength\":");
    CHECK(view != NULL);
    if (view) {
        char *digit = view + strlen("\"byteLength\":");
        CHECK(*digit < '9');
        *digit = '9';
        CHECK_INT(read_bytes(f.frame.bytes, f.frame.size), AWT_BAD_FORMAT);
    }
    geom_fixture_fini(&f);
}

TEST(geom_buffers_end_at_the_limit_of_a_frame)
{
    geom_buffer full = {.size = GEOM_MAX_GLB, .capacity = GEOM_MAX_GLB};
    awt_error error = {0};
    CHECK_INT(geom_buffer_append(&full, "x", 1, &error), AWT_LIMIT);
    CHECK(strstr(error.text, "64 MiB") != NULL);
    CHECK_INT(geom_buffer_append(&full, "", 0, &error), AWT_OK);
    geom_buffer grown = {0};
    for (int i = 0; i < 1000; i++) {
        CHECK_INT(geom_buffer_append(&grown, "abc", 3, NULL), AWT_OK);
    }
    CHECK_U64(grown.size, 3000);
    CHECK_BYTES(grown.bytes + 2997, "abc", 3);
    geom_buffer_fini(&grown);
}

/* ---- the Draco data by itself */

typedef struct mesh_case {
    unsigned char bytes[8192];
    size_t size;
} mesh_case;

static void mesh_put(mesh_case *mesh, const char *bytes, size_t size)
{
    memcpy(mesh->bytes + mesh->size, bytes, size);
    mesh->size += size;
}

#define MESH_PUT(mesh, text) mesh_put((mesh), (text), sizeof(text) - 1)

/* Header, 2 triangles, 4 vertices, and whatever the test puts then: one ribbon of 2 points. */
static mesh_case mesh_begin(void)
{
    mesh_case mesh = {.size = 0};
    MESH_PUT(&mesh, "DRACO\2\2\1\0\0\0\2\4");
    return mesh;
}

static awt_status decode(const mesh_case *mesh)
{
    const uint16_t indices[6] = {0, 1, 2, 3, 2, 1};
    float positions[12];
    unsigned char *copy = malloc(mesh->size);
    memcpy(copy, mesh->bytes, mesh->size);
    awt_status status = draco_shim_decode(copy, mesh->size, indices, 4, 2, positions, NULL);
    free(copy);
    return status;
}

/* Raw triangles, a position attribute, no prediction, 1-byte values; origin 0, range and bits as given. */
static mesh_case plain_mesh(float range, char bits)
{
    mesh_case mesh = mesh_begin();
    MESH_PUT(&mesh, "\1\0\1\2\3\2\1");
    MESH_PUT(&mesh, "\1\1\0\x9\3\0\0\2\xfe\0\1");
    MESH_PUT(&mesh, "\0\0\0\0\0\0\0\0\0\0\0\0");
    MESH_PUT(&mesh, "\0\0\0\0\0\0\0\0\0\0\0\0");
    mesh_put(&mesh, (const char *)&range, sizeof range);
    mesh_put(&mesh, &bits, 1);
    return mesh;
}

TEST(geom_reader_takes_a_plain_draco_mesh_and_no_truncation_of_it)
{
    mesh_case mesh = plain_mesh(1.0f, 14);
    CHECK_INT(decode(&mesh), AWT_OK);
    while (--mesh.size > 0) {
        CHECK_INT(decode(&mesh), AWT_BAD_FORMAT);
    }
}

TEST(geom_reader_refuses_positions_that_are_not_finite)
{
    mesh_case mesh = plain_mesh(NAN, 14);
    awt_status status = decode(&mesh);
    CHECK(status == AWT_BAD_FORMAT || status == AWT_BAD_VALUE);
    mesh = plain_mesh(INFINITY, 14);
    status = decode(&mesh);
    CHECK(status == AWT_BAD_FORMAT || status == AWT_BAD_VALUE);
}

TEST(geom_reader_refuses_other_draco_kinds_before_libdraco_sees_them)
{
    const size_t places[] = {5, 6, 7, 8, 10, 11, 12}; /* version, kind, method, flags, counts */
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        mesh_case mesh = plain_mesh(1.0f, 14);
        mesh.bytes[places[i]]++;
        CHECK_INT(decode(&mesh), AWT_BAD_FORMAT);
    }
    for (size_t place = 20; place < 28; place++) { /* the attribute's description */
        mesh_case mesh = plain_mesh(1.0f, 14);
        mesh.bytes[place]++;
        CHECK_INT(decode(&mesh), AWT_BAD_FORMAT);
    }
}

TEST(geom_reader_refuses_symbol_tables_no_encoder_writes)
{
    mesh_case triangles = mesh_begin();
    MESH_PUT(&triangles, "\0\1\x12\xff\xff\xff\x7f"); /* compressed, raw scheme, 18 bits, 2^28 symbols */
    MESH_PUT(&triangles, "\0\0\0\0\0\0\0\0\0\0\0\0");
    CHECK_INT(decode(&triangles), AWT_BAD_FORMAT);
    mesh_case values = mesh_begin();
    MESH_PUT(&values, "\1\0\1\2\3\2\1");
    MESH_PUT(&values, "\1\1\0\x9\3\0\0\2\xfe\1\1\x12\xff\xff\xff\x7f");
    MESH_PUT(&values, "\0\0\0\0\0\0\0\0\0\0\0\0");
    CHECK_INT(decode(&values), AWT_BAD_FORMAT);
}

TEST(geom_reader_refuses_triangles_that_are_not_the_ribbons)
{
    for (size_t place = 14; place < 20; place++) {
        mesh_case mesh = plain_mesh(1.0f, 14);
        mesh.bytes[place] = (unsigned char)(3 - mesh.bytes[place]);
        CHECK_INT(decode(&mesh), AWT_BAD_FORMAT);
    }
}

/* A well-formed mesh whose coded values are all symbol 0 of a table of 1 + 64 * `runs` symbols. */
static mesh_case mesh_of_symbols(int runs)
{
    uint32_t symbols = 1 + 64 * (uint32_t)runs;
    const unsigned char count[3] = {(unsigned char)(symbols | 0x80), (unsigned char)(symbols >> 7 | 0x80),
                                    (unsigned char)(symbols >> 14)};
    mesh_case mesh = mesh_begin();
    MESH_PUT(&mesh, "\1\0\1\2\3\2\1");
    MESH_PUT(&mesh, "\1\1\0\x9\3\0\0\2\xfe\1\1\x12");
    mesh_put(&mesh, (const char *)count, sizeof count);
    MESH_PUT(&mesh, "\2\0\x40"); /* symbol 0 has all the probability, 2^20 */
    for (int i = 0; i < runs; i++) {
        MESH_PUT(&mesh, "\xff"); /* 64 symbols of none */
    }
    MESH_PUT(&mesh, "\1\0"); /* coded data: 1 byte, the first state */
    MESH_PUT(&mesh, "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x3f\xe");
    return mesh;
}

TEST(geom_reader_bounds_the_symbol_table)
{
    mesh_case largest = mesh_of_symbols(4095), larger = mesh_of_symbols(4096);
    CHECK_INT(decode(&largest), AWT_OK);
    CHECK_INT(decode(&larger), AWT_BAD_FORMAT);
}

/* ---- the JSON by itself */

static awt_status parse(const char *text)
{
    json_document json = {0};
    size_t size = strlen(text);
    char *copy = malloc(size ? size : 1);
    memcpy(copy, text, size);
    awt_status status = json_read(copy, size, &json, NULL);
    json_fini(&json);
    free(copy);
    return status;
}

TEST(geom_json_takes_json_and_nothing_else)
{
    const char *good[] = {"{}", "[]", " [ 1 , {\"a\":[]} , \"x\\\"y\" ] ", "0", "\"\"", "[true,false,null]", "[[],[]]"};
    const char *bad[] = {
        "",      "{",     "[",   "[1",        "[1,",   "[1,]",     "{\"a\"}", "{\"a\":}", "{\"a\":1,}",
        "{a:1}", "[1 2]", "]",   "[}",        "{]",    "\"",       "\"\\",    "[tru]",    "nul",
        "[1]]",  "{,}",   "[,]", "{\"a\" 1}", "{1:2}", "[\"\n\"]", "[1][2]",  "+1",       "{\"a\":1 \"b\":2}"};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        check_int(__FILE__, __LINE__, good[i], parse(good[i]), AWT_OK);
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        check_int(__FILE__, __LINE__, bad[i], parse(bad[i]), AWT_BAD_FORMAT);
    }
}

TEST(geom_json_finds_members_and_reads_numbers)
{
    const char text[] = "{\"skip\":[{\"n\":1},[2,3]],\"n\":-1.5e-3,\"whole\":7.0,\"half\":0.5,\"many\":[1,2,3],"
                        "\"mixed\":[1,[2],3],\"text\":\"hair\",\"hex\":0x10,\"huge\":4294967295}";
    json_document json = {0};
    CHECK_INT(json_read(text, sizeof text - 1, &json, NULL), AWT_OK);
    double number = 0, three[3] = {0};
    uint32_t whole = 0;
    CHECK(json_real(&json, json_member(&json, 0, "n"), &number) && number == -1.5e-3);
    CHECK(json_whole(&json, json_member(&json, 0, "whole"), &whole) && whole == 7);
    CHECK(!json_whole(&json, json_member(&json, 0, "half"), &whole));
    CHECK(!json_whole(&json, json_member(&json, 0, "n"), &whole));
    CHECK(!json_whole(&json, json_member(&json, 0, "huge"), &whole));
    CHECK(!json_real(&json, json_member(&json, 0, "hex"), &number));
    CHECK(!json_real(&json, json_member(&json, 0, "text"), &number));
    CHECK(json_reals(&json, json_member(&json, 0, "many"), 3, three) && three[2] == 3);
    CHECK(!json_reals(&json, json_member(&json, 0, "many"), 2, three));
    CHECK(!json_reals(&json, json_member(&json, 0, "mixed"), 3, three));
    CHECK(json_is_text(&json, json_member(&json, 0, "text"), "hair"));
    CHECK(json_member(&json, 0, "absent") == JSON_NONE);
    CHECK(json_member(&json, JSON_NONE, "n") == JSON_NONE);
    CHECK_INT(json_items(&json, json_member(&json, 0, "skip")), 2);
    json_fini(&json);
}

static bool number_of(const char *text, double *out)
{
    return json_number(text, text + strlen(text), out);
}

/* Also under a locale that writes commas, where the machine has one. */
TEST(geom_json_numbers_are_json_numbers_only)
{
    const char *bad[] = {"",     "-",   "1.",  ".5", "1e", "1e+",   "+1",   "1,5",
                         "0x10", "inf", "nan", "1 ", " 1", "1e400", "1.5.5"};
    const char *locales[] = {"C", "de_DE.UTF-8", "fr_FR.UTF-8"};
    char *kept = strdup(setlocale(LC_NUMERIC, NULL));
    for (size_t l = 0; l < sizeof locales / sizeof locales[0]; l++) {
        double number = 0;
        if (!setlocale(LC_NUMERIC, locales[l])) {
            continue;
        }
        for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
            check_true(__FILE__, __LINE__, bad[i], !number_of(bad[i], &number));
        }
        CHECK(number_of("-1.2345678901234567e-300", &number) && number == -1.2345678901234567e-300);
        CHECK(number_of("0.1", &number) && number == 0.1);
        CHECK(number_of("1E3", &number) && number == 1000);
        CHECK(number_of("9007199254740993", &number) && number == 9007199254740992.0);
    }
    setlocale(LC_NUMERIC, kept);
    free(kept);
}

TEST(geom_json_limits_depth_members_and_size)
{
    char deep[4 * JSON_MAX_DEPTH];
    memset(deep, '[', sizeof deep);
    CHECK_INT(json_read(deep, sizeof deep, &(json_document){0}, NULL), AWT_LIMIT);
    char wide[16 * (JSON_MAX_MEMBERS + 2)] = "{";
    for (int i = 0; i <= JSON_MAX_MEMBERS; i++) {
        strcat(wide, i ? ",\"a\":1" : "\"a\":1");
    }
    strcat(wide, "}");
    CHECK_INT(parse(wide), AWT_LIMIT);
    char *large = malloc(JSON_MAX_SIZE + 1);
    memset(large, ' ', JSON_MAX_SIZE + 1);
    CHECK_INT(json_read(large, JSON_MAX_SIZE + 1, &(json_document){0}, NULL), AWT_LIMIT);
    free(large);
}
