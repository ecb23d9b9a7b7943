/* JSON out, whole files, quantiles: the clients' small tools. */
#include "check.h"
#include "files.h"
#include "jsonout.h"
#include "quantile.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The text that `write` makes; `*done` what jsonout_done said. Heap. */
static char *written(void (*write)(jsonout *), bool *done)
{
    char *text = NULL;
    size_t size;
    FILE *file = open_memstream(&text, &size);
    jsonout j = jsonout_begin(file);
    j.compact = true;
    write(&j);
    *done = jsonout_done(&j);
    fclose(file);
    return text;
}

static void check_written(void (*write)(jsonout *), const char *expected)
{
    bool done;
    char *text = written(write, &done);
    CHECK(done);
    CHECK_TEXT(text, expected);
    free(text);
}

static void write_values(jsonout *j)
{
    const double numbers[] = {0.1, -2};
    jsonout_object(j, NULL);
    jsonout_text(j, "t", "a");
    jsonout_text(j, "n", NULL);
    jsonout_bool(j, "b", true);
    jsonout_integer(j, "i", INT64_MIN);
    jsonout_unsigned(j, "u", UINT64_MAX);
    jsonout_reals(j, "r", numbers, 2);
    jsonout_array(j, "empty");
    jsonout_close(j);
    jsonout_close(j);
}

TEST(json_out_writes_every_kind_of_value)
{
    check_written(write_values, "{ \"t\": \"a\", \"n\": null, \"b\": true, \"i\": -9223372036854775808, "
                                "\"u\": 18446744073709551615, \"r\": [ 0.1, -2 ], \"empty\": [] }\n");
}

static void write_escapes(jsonout *j)
{
    jsonout_array(j, NULL);
    jsonout_text(j, NULL, "\"\\/\n\t\x01\x7f");
    jsonout_text(j, NULL, "h\xc3\xa9 \xf0\x9f\x92\x87");          /* UTF-8 stays */
    jsonout_text(j, NULL, "\xff|\xc0\xaf|\xed\xa0\x80|\xe2\x82"); /* bytes that are not UTF-8 do not */
    jsonout_close(j);
}

TEST(json_out_escapes_text)
{
    check_written(
        write_escapes,
        "[ \"\\\"\\\\/\\u000a\\u0009\\u0001\\u007f\", \"h\xc3\xa9 \xf0\x9f\x92\x87\", "
        "\"\xef\xbf\xbd|\xef\xbf\xbd\xef\xbf\xbd|\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd|\xef\xbf\xbd\xef\xbf\xbd\" "
        "]\n");
}

static void write_numbers(jsonout *j)
{
    jsonout_array(j, NULL);
    jsonout_real(j, NULL, 1.0 / 3);
    jsonout_real(j, NULL, 1e-300);
    jsonout_float(j, NULL, 0.1f);
    jsonout_real(j, NULL, NAN);
    jsonout_real(j, NULL, -HUGE_VAL);
    jsonout_float(j, NULL, HUGE_VALF);
    jsonout_close(j);
}

TEST(json_out_numbers_read_back_and_are_finite)
{
    check_written(write_numbers, "[ 0.3333333333333333, 1e-300, 0.1, null, null, null ]\n");
}

static void write_key_in_array(jsonout *j)
{
    jsonout_array(j, NULL);
    jsonout_bool(j, "key", true);
    jsonout_close(j);
}

static void write_no_key_in_object(jsonout *j)
{
    jsonout_object(j, NULL);
    jsonout_bool(j, NULL, true);
    jsonout_close(j);
}

static void write_unclosed(jsonout *j)
{
    jsonout_array(j, NULL);
}

static void write_closed_twice(jsonout *j)
{
    jsonout_array(j, NULL);
    jsonout_close(j);
    jsonout_close(j);
}

static void write_two(jsonout *j)
{
    jsonout_bool(j, NULL, true);
    jsonout_bool(j, NULL, true);
}

static void write_nothing(jsonout *j)
{
    (void)j;
}

static void write_too_deep(jsonout *j)
{
    for (int i = 0; i <= JSONOUT_MAX_DEPTH; i++) {
        jsonout_array(j, NULL);
    }
    for (int i = 0; i <= JSONOUT_MAX_DEPTH; i++) {
        jsonout_close(j);
    }
}

TEST(json_out_that_is_no_document_is_not_done)
{
    void (*const wrong[])(jsonout *) = {write_key_in_array, write_no_key_in_object, write_unclosed, write_closed_twice,
                                        write_two,          write_nothing,          write_too_deep};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        bool done = true;
        free(written(wrong[i], &done));
        CHECK(!done);
    }
}

TEST(json_out_notices_a_full_disk)
{
    FILE *full = fopen("/dev/full", "w");
    if (!full) {
        check_skip("there is no /dev/full here");
        return;
    }
    setvbuf(full, NULL, _IONBF, 0);
    jsonout j = jsonout_begin(full);
    jsonout_bool(&j, NULL, true);
    CHECK(!jsonout_done(&j));
    fclose(full);
}

TEST(files_are_written_whole_into_folders_that_are_made)
{
    char folder[64], path[128], error[256] = "";
    size_t size = 0;
    snprintf(folder, sizeof folder, "/tmp/awtd-files-%ld/a/b", (long)getpid());
    snprintf(path, sizeof path, "%s/f", folder);
    CHECK(!files_write(path, "x", 1, error, sizeof error));
    CHECK(strstr(error, path) != NULL);
    CHECK(files_make_folder(folder, error, sizeof error));
    CHECK(files_make_folder(folder, error, sizeof error));
    CHECK(files_write(path, "first", 5, error, sizeof error));
    FILE *first = fopen(path, "rb");
    CHECK(files_write(path, "hair", 4, error, sizeof error));
    CHECK(first && fgetc(first) == 'f'); /* who has the old file open still sees it whole */
    if (first) {
        fclose(first);
    }
    unsigned char *bytes = files_read(path, 4, &size, error, sizeof error);
    CHECK(bytes && size == 4 && memcmp(bytes, "hair", 4) == 0);
    free(bytes);
    CHECK(files_read(path, 3, &size, error, sizeof error) == NULL);
    CHECK(files_read(folder, 100, &size, error, sizeof error) == NULL);
    CHECK(!files_make_folder(path, error, sizeof error));
    unlink(path);
    for (int i = 0; i < 3; i++) {
        CHECK_INT(rmdir(folder), 0); /* fails where a temporary file was left behind */
        *strrchr(folder, '/') = '\0';
    }
}

TEST(quantiles_are_values_of_the_list)
{
    double values[] = {5, 1, 4, 2, 3};
    quantile_sort(values, 5);
    CHECK_NEAR(quantile_at(values, 5, 0), 1, 0);
    CHECK_NEAR(quantile_at(values, 5, 0.5), 3, 0);
    CHECK_NEAR(quantile_at(values, 5, 0.8), 4, 0);
    CHECK_NEAR(quantile_at(values, 5, 0.99), 5, 0);
    CHECK_NEAR(quantile_at(values, 5, 1), 5, 0);
    CHECK_NEAR(quantile_at(values, 0, 0.5), 0, 0);
}
