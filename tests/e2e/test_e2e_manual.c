/* test_e2e_manual.c: the manual pages list the options that the programs' --help lists, with the same arguments, and no
 * others. */
#include "check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MANUAL_OPTIONS = 64, MANUAL_NAME = 96 };

/* "name ARGUMENT" of each. */
typedef struct option_set {
    char items[MANUAL_OPTIONS][MANUAL_NAME];
    size_t count;
} option_set;

static void add(option_set *set, const char *text, size_t length)
{
    CHECK(set->count < MANUAL_OPTIONS && length < MANUAL_NAME);
    if (set->count < MANUAL_OPTIONS && length < MANUAL_NAME) {
        memcpy(set->items[set->count], text, length);
        set->items[set->count++][length] = '\0';
    }
}

static bool holds(const option_set *set, const char *item)
{
    for (size_t i = 0; i < set->count; i++) {
        if (strcmp(set->items[i], item) == 0) {
            return true;
        }
    }
    return false;
}

/* What `program --help` lists: lines "  --name ARGUMENT   text". */
static void read_help(const char *program, option_set *set)
{
    char command[256], line[512];
    snprintf(command, sizeof command, "%s/%s --help", check_build_directory(), program);
    FILE *said = popen(command, "r");
    CHECK(said != NULL);
    while (said && fgets(line, sizeof line, said)) {
        const char *end = strstr(line + 2, "  ");
        if (strncmp(line, "  --", 4) == 0 && end) {
            add(set, line + 4, (size_t)(end - line) - 4);
        }
    }
    CHECK(said && pclose(said) == 0);
}

/* A line of a page without what the formatter takes for itself: macro and escapes. */
static void plain(const char *line, char *out, size_t size)
{
    size_t used = 0;
    line = *line == '.' ? strchr(line, ' ') + 1 : line;
    for (; *line != '\n' && *line != '\0' && used + 1 < size; line++) {
        if (line[0] == '\\' && line[1] == 'f') {
            line += 2;
        } else if (line[0] == '\\' || (line[0] == ' ' && line[1] == ' ')) {
            continue;
        } else {
            out[used++] = *line;
        }
    }
    out[used] = '\0';
}

/* What a page lists, a tag ("--name ARGUMENT" after .TP) each, between the heading and the next one. */
static void read_page(const char *path, const char *heading, option_set *set)
{
    char line[512], text[MANUAL_NAME + 2];
    FILE *page = fopen(path, "r");
    CHECK(page != NULL);
    bool here = false, tag = false, found = false;
    while (page && fgets(line, sizeof line, page)) {
        if (strncmp(line, ".S", 2) == 0) {
            here = strncmp(line + 4, heading, strlen(heading)) == 0 && line[4 + strlen(heading)] == '\n';
            found = found || here;
        } else if (tag && here) {
            plain(line, text, sizeof text);
            CHECK(strncmp(text, "--", 2) == 0);
            add(set, text + 2, strlen(text + 2));
        }
        tag = strncmp(line, ".TP", 3) == 0;
    }
    CHECK_TEXT(found ? heading : "no such heading", heading);
    if (page) {
        fclose(page);
    }
}

static void check_listed(const option_set *all, const option_set *in, const char *place)
{
    for (size_t i = 0; i < all->count; i++) {
        char text[2 * MANUAL_NAME];
        snprintf(text, sizeof text, "%s, %s", all->items[i], place);
        CHECK_TEXT(holds(in, all->items[i]) ? text : "not there", text);
    }
}

TEST(e2e_manual_of_awtd_lists_its_options)
{
    option_set help = {.count = 0}, page = {.count = 0};
    read_help("awtd", &help);
    read_page("server/awtd.8", "OPTIONS", &page);
    CHECK(help.count > 20);
    check_listed(&help, &page, "awtd.8");
    check_listed(&page, &help, "awtd --help");
}

TEST(e2e_manual_of_awtctl_lists_its_subcommands_and_their_options)
{
    char line[256], program[64];
    FILE *said;
    size_t subcommands = 0;
    snprintf(line, sizeof line, "%s/awtctl --help", check_build_directory());
    said = popen(line, "r");
    CHECK(said != NULL);
    while (said && fgets(line, sizeof line, said)) {
        if (strncmp(line, "  ", 2) != 0) {
            continue;
        }
        line[2 + strcspn(line + 2, " ")] = '\0';
        option_set help = {.count = 0}, page = {.count = 0}, own = {.count = 0};
        snprintf(program, sizeof program, "awtctl %.40s", line + 2);
        read_help(program, &help);
        read_page("clients/awtctl.1", "COMMON OPTIONS", &page);
        read_page("clients/awtctl.1", line + 2, &page);
        read_page("clients/awtctl.1", line + 2, &own);
        check_listed(&help, &page, "awtctl.1");
        check_listed(&own, &help, program);
        CHECK(help.count >= 3);
        subcommands++;
    }
    CHECK(said && pclose(said) == 0);
    CHECK(subcommands >= 6);
}
