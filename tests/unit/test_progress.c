/* test_progress.c: the lines that say how far something has come, where no terminal is. */
#include "check.h"
#include "progress.h"

/* The line for a share and a text after so many seconds; static storage. */
static const char *line_of(double share, const char *text, int64_t taken_s)
{
    static char line[200];
    FILE *file = tmpfile();
    line[0] = '\0';
    if (file) {
        progress p = progress_begin(file, "work", false);
        p.began_us -= taken_s * 1000000;
        p.shown_us = p.began_us - 10000000;
        progress_show(&p, share, text);
        rewind(file);
        if (!fgets(line, sizeof line, file)) {
            line[0] = '\0';
        }
        fclose(file);
    }
    return line;
}

TEST(progress_lines_have_commas_between_parts_alone)
{
    CHECK_TEXT(line_of(0.37, "12 of 30", 0), "work:  37 %, 12 of 30\n");
    CHECK_TEXT(line_of(0.37, "", 0), "work:  37 %\n");
    CHECK_TEXT(line_of(0.5, "12 of 30", 64), "work:  50 %, 12 of 30, 1:04 left\n");
    CHECK_TEXT(line_of(0.5, "", 64), "work:  50 %, 1:04 left\n");
}
