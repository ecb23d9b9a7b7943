/* test_options_layers.c: settings from a file's text and from the environment, and which of them counts. */
#include "base/options_layers.h"
#include "check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct values {
    bool quiet;
    const char *name;
    long long count;
    double rate;
    option_list files;
} values;

static option table[5];
static values now;

static const option_program *program(void)
{
    static option_program p = {.name = "prog", .summary = "", .options = table, .option_count = 5};
    now = (values){.name = "none", .count = 1, .rate = 0.5};
    memcpy(table,
           (const option[5]){{"quiet", OPTION_FLAG, NULL, &now.quiet, 0, 0, ""},
                             {"the-name", OPTION_TEXT, "NAME", &now.name, 0, 0, ""},
                             {"count", OPTION_INTEGER, "N", &now.count, 1, 9, ""},
                             {"rate", OPTION_REAL, "R", &now.rate, 0, 1, ""},
                             {"file", OPTION_LIST, "FILE", &now.files, 0, 0, ""}},
           sizeof table);
    return &p;
}

static char text[4096];

static bool take(const char *from, char *error, size_t size)
{
    snprintf(text, sizeof text, "%s", from);
    return options_take_text(program(), text, "some.conf", error, size);
}

TEST(options_text_sets_what_it_names)
{
    char error[256] = "";
    CHECK(
        take("# a comment\n\n  quiet=yes\r\nthe-name = a b#c # and why\n\tcount\t=\t7\nrate = 0.25\nfile = x\nfile = y",
             error, sizeof error));
    CHECK_TEXT(error, "");
    CHECK(now.quiet);
    CHECK_TEXT(now.name, "a b#c");
    CHECK_INT(now.count, 7);
    CHECK_NEAR(now.rate, 0.25, 0);
    CHECK_INT((int)now.files.count, 2);
    CHECK_TEXT(now.files.items[1], "y");
    CHECK(take("quiet = no", error, sizeof error));
    CHECK(!now.quiet);
    CHECK_TEXT(now.name, "none");
}

TEST(options_text_says_the_line_and_what_is_wrong_there)
{
    static const char *const wrong[][3] = {{"\n\ncount 3", "some.conf:3: ", "NAME = VALUE"},
                                           {"coumt = 3", "some.conf:1: ", "no setting \"coumt\""},
                                           {"rate = 1\ncount = 10", "some.conf:2: ", "from 1 to 9"},
                                           {"count = 3x", "some.conf:1: ", "not \"3x\""},
                                           {"quiet = maybe", "some.conf:1: ", "yes or no"},
                                           {"the-name =  # nothing", "some.conf:1: ", "no value"},
                                           {"count = 1\n#\ncount = 2", "some.conf:3: ", "twice"},
                                           {"= 2", "some.conf:1: ", "no setting"},
                                           {"--count = 2", "some.conf:1: ", "no setting"}};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        char error[256] = "";
        CHECK(!take(wrong[i][0], error, sizeof error));
        CHECK(strncmp(error, wrong[i][1], strlen(wrong[i][1])) == 0);
        CHECK(strstr(error, wrong[i][2]) != NULL);
    }
}

static char *fake_get(const char *name)
{
    static char seven[] = "7", empty[] = "", yes[] = "yes", bad[] = "10";
    return strcmp(name, "PROG_COUNT") == 0      ? seven
           : strcmp(name, "PROG_THE_NAME") == 0 ? empty
           : strcmp(name, "PROG_QUIET") == 0    ? yes
           : strcmp(name, "BAD_COUNT") == 0     ? bad
                                                : NULL;
}

TEST(options_environment_sets_what_is_not_empty)
{
    char error[256] = "";
    CHECK(options_take_environment(program(), "PROG", fake_get, error, sizeof error));
    CHECK_INT(now.count, 7);
    CHECK_TEXT(now.name, "none");
    CHECK(now.quiet);
    CHECK(!options_take_environment(program(), "BAD", fake_get, error, sizeof error));
    CHECK(strncmp(error, "$BAD_COUNT: ", 12) == 0);
}

TEST(options_printed_are_read_as_they_were)
{
    char error[256] = "", again[1024] = "";
    CHECK(take("quiet = yes\nthe-name = a b\ncount = 3\nrate = 0.1\nfile = x\nfile = y\n", error, sizeof error));
    FILE *to = fmemopen(again, sizeof again, "w");
    CHECK(to != NULL);
    const option_program p = {.name = "prog", .summary = "", .options = table, .option_count = 5};
    options_print(&p, to);
    fclose(to);
    CHECK_TEXT(again, "quiet = yes\nthe-name = a b\ncount = 3\nrate = 0.10000000000000001\nfile = x\nfile = y\n");
    CHECK(take(again, error, sizeof error));
    CHECK_NEAR(now.rate, 0.1, 0);
    CHECK_INT((int)now.files.count, 2);
}
