/* test_bench.c: what awt-bench paper says, as far as it does not depend on the clock. */
#include "check.h"

#include "geom/json.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

/* Runs awt-bench paper with its output thrown away; the exit code, or -1. */
static int run_paper(const char *arguments)
{
    char command[600];
    int length = snprintf(command, sizeof command, "'%s/awt-bench' paper %s >/dev/null 2>&1", check_build_directory(),
                          arguments);
    int status = length > 0 && (size_t)length < sizeof command ? system(command) : -1;
    return status != -1 && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static bool bench_is_built(void)
{
    bool built = run_paper("--version") == 0;
    if (!built) {
        check_skip("awt-bench is not built");
    }
    return built;
}

static double number_at(const json_document *json, uint32_t object, const char *name)
{
    double value = -1;
    CHECK(json_real(json, json_member(json, object, name), &value));
    return value;
}

TEST(bench_writes_the_figures_of_each_style_as_json)
{
    char path[300], arguments[400];
    if (!bench_is_built()) {
        return;
    }
    snprintf(path, sizeof path, "%s/bench-test.json", check_build_directory());
    snprintf(arguments, sizeof arguments,
             "--styles long --strands 1000 --points 8 --seconds 1.8 --theta 0.05 --workers 2 --json '%s'", path);
    CHECK_INT(run_paper(arguments), 0);
    size_t size;
    char *text = (char *)check_read_file(path, &size);
    json_document json = {0};
    CHECK(text != NULL);
    if (text && json_read(text, size, &json, NULL) == AWT_OK) {
        uint32_t styles = json_member(&json, 0, "styles"), style = styles + 1;
        CHECK_INT(json_items(&json, styles), 1);
        CHECK(json_is_text(&json, json_member(&json, style, "name"), "long"));
        double finest = number_at(&json, style, "finest_nodes"), coarse = number_at(&json, style, "coarse_nodes");
        double active = number_at(&json, json_member(&json, style, "active"), "max");
        double single = number_at(&json, json_member(&json, style, "single_active"), "mean");
        CHECK(coarse < active && active < single && single < finest);
        CHECK(number_at(&json, style, "splits") > 10); /* the clip was played */
        CHECK(number_at(&json, json_member(&json, style, "awt_ms"), "max") > 0);
        CHECK(number_at(&json, style, "ns_per_strand_point") > 0);
    } else {
        CHECK(json.count > 0); /* it is no JSON */
    }
    json_fini(&json);
    free(text);
    remove(path);
}

TEST(bench_refuses_what_it_cannot_measure)
{
    static const char *const wrong[] = {
        "--styles short,bald",   "--links rubber", "--motion /no/such/motion.bvh", "--seconds 0.001",
        "--motion-up sideways",  "--workers 0",    "--time-unit fortnights",       "--theta x",
        "--styles short --oops",
    };
    if (!bench_is_built()) {
        return;
    }
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        CHECK_INT(run_paper(wrong[k]), 2);
    }
}
