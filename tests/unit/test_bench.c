/* test_bench.c: what awt-bench says, as far as it does not depend on the clock. */
#include "check.h"

#include "geom/json.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

/* Runs awt-bench with its output thrown away; the exit code, or -1. */
static int run_bench(const char *subcommand, const char *arguments)
{
    char command[600];
    int length = snprintf(command, sizeof command, "'%s/awt-bench' %s %s >/dev/null 2>&1", check_build_directory(),
                          subcommand, arguments);
    int status = length > 0 && (size_t)length < sizeof command ? system(command) : -1;
    return status != -1 && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static bool bench_is_built(void)
{
    bool built = run_bench("paper", "--version") == 0;
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
    CHECK_INT(run_bench("paper", arguments), 0);
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
        CHECK_INT(run_bench("paper", wrong[k]), 2);
    }
}

/* Row number `index` of whole frames: level by level a kind after the other. */
static void check_row(const json_document *json, uint32_t row, int index)
{
    static const char *const levels[] = {"full", "fifth", "guides"}, *const movings[] = {"all", "quarter", "none"};
    const int level = index / 6;
    const bool ribbon = index % 6 < 3;
    const double points = number_at(json, row, "points");
    CHECK(json_is_text(json, json_member(json, row, "kind"), ribbon ? "ribbon" : "strands"));
    CHECK(json_is_text(json, json_member(json, row, "moving"), movings[index % 3]));
    CHECK(json_is_text(json, json_member(json, row, "level"), levels[level]));
    CHECK_NEAR(number_at(json, row, "quantisation_bits"), ribbon ? 14 : 12, 0);
    CHECK(level == 0 ? points == 16000 : level == 1 ? points == 3200 : points >= 16 && points < 16000);
    CHECK(number_at(json, row, "evaluate_ms") > 0);
    double bytes = number_at(json, row, "bytes_per_point"), entropy = number_at(json, row, "entropy_bits_per_point");
    CHECK(bytes < 1.03 * number_at(json, row, "stock_bytes_per_point"));
    CHECK(entropy > 8 && entropy < 8.5 * bytes);
    CHECK_NEAR(number_at(json, row, "mbit_s_at_60hz"), bytes * points * 8 * 60e-6, 1e-9);
    double error_mm = number_at(json, row, "max_error_mm");
    CHECK(error_mm > 0.01 && error_mm < 0.5);
    CHECK(number_at(json, row, "encode_ms") > 0 && number_at(json, row, "stock_encode_ms") > 0);
    CHECK(number_at(json, row, "decode_ms") > 0 && number_at(json, row, "stock_decode_ms") > 0);
}

/* One row of deltas. */
static void check_delta_row(const json_document *json, uint32_t row, int age, const char *moving)
{
    const uint32_t delta = json_member(json, row, "delta");
    CHECK(delta != JSON_NONE && json->text[json->tokens[delta].begin] == 't');
    CHECK(json_is_text(json, json_member(json, row, "kind"), "strands"));
    CHECK(json_is_text(json, json_member(json, row, "moving"), moving));
    CHECK_NEAR(number_at(json, row, "base_age_frames"), age, 0);
    double bytes = number_at(json, row, "bytes_per_point"), entropy = number_at(json, row, "entropy_bits_per_point");
    bool none = strcmp(moving, "none") == 0;
    CHECK(none ? bytes < 0.05 && entropy == 0 : bytes < 1.1 && entropy > 0.1 && entropy < 8 * bytes);
    CHECK(bytes < 1.03 * number_at(json, row, "stock_bytes_per_point") + 0.06);
    CHECK(number_at(json, row, "max_error_mm") < 0.5);
    CHECK(number_at(json, row, "encode_ms") > 0 && number_at(json, row, "decode_ms") > 0);
}

TEST(bench_writes_what_frames_cost_as_json)
{
    char path[300], arguments[400];
    if (!bench_is_built()) {
        return;
    }
    snprintf(path, sizeof path, "%s/bench-encode.json", check_build_directory());
    snprintf(arguments, sizeof arguments, "--strands 1000 --frames 2 --stride 5 --json '%s'", path);
    CHECK_INT(run_bench("encode", arguments), 0);
    size_t size;
    char *text = (char *)check_read_file(path, &size);
    json_document json = {0};
    CHECK(text != NULL);
    if (text && json_read(text, size, &json, NULL) == AWT_OK) {
        static const char *const movings[] = {"all", "quarter", "none"};
        uint32_t rows = json_member(&json, 0, "rows"), row = rows + 1;
        CHECK_INT(json_items(&json, rows), 24);
        for (int i = 0; i < 24 && json_items(&json, rows) == 24; i++, row = json.tokens[row].after) {
            if (i < 18) {
                check_row(&json, row, i);
            } else {
                check_delta_row(&json, row, i < 21 ? 1 : 3, movings[i % 3]);
            }
        }
        static const char *const guides[] = {"guides", "guides whole", "guides delta", "nodes"};
        rows = json_member(&json, 0, "guides"), row = rows + 1;
        CHECK_INT(json_items(&json, rows), 4);
        for (int i = 0; i < 4 && json_items(&json, rows) == 4; i++, row = json.tokens[row].after) {
            CHECK(json_is_text(&json, json_member(&json, row, "name"), guides[i]));
            CHECK(json_is_text(&json, json_member(&json, row, "kind"), i < 3 ? "guides" : "nodes"));
            CHECK(number_at(&json, row, "nodes") > 100 && number_at(&json, row, "encode_ms") > 0);
            CHECK(number_at(&json, row, "receive_ms") > 0 && number_at(&json, row, "max_error_mm") <= 0.2);
            CHECK_NEAR(number_at(&json, row, "mbit_s_at_60hz"), number_at(&json, row, "bytes") * 8 * 60e-6, 1e-9);
        }
    } else {
        CHECK(json.count > 0); /* it is no JSON */
    }
    json_fini(&json);
    free(text);
    remove(path);
    CHECK_INT(run_bench("encode", "--style bald"), 2);
    CHECK_INT(run_bench("encode", "--motion /no/such/motion.bvh"), 2);
    CHECK_INT(run_bench("encode", "--groom /no/such/hair.tfx"), 1);
}

/* A style's heads, by what its steps and its frames (strands, guides: the last ones) cost; each has two viewers. */
static void check_heads(const json_document *json, uint32_t row)
{
    uint32_t frames = json_member(json, row, "frames"), frame = frames + 1,
             heads = json_member(json, row, "heads_per_core");
    CHECK_INT(json_items(json, frames), 6);
    CHECK_INT(json_items(json, json_member(json, row, "guides")), 4);
    CHECK_INT(json_items(json, heads), 3);
    for (int i = 0; i < 5 && json_items(json, frames) == 6; i++) {
        frame = json->tokens[frame].after;
    }
    const double awake = number_at(json, row, "step_awake_ms"), asleep = number_at(json, row, "step_asleep_ms");
    const double write = 2 * number_at(json, frame, "write_ms");
    const double moving = number_at(json, row, "frame_moving_ms") + write;
    const double still = number_at(json, row, "frame_still_ms") + write;
    CHECK(asleep > 0 && awake > asleep && still > write && moving > still);
    CHECK(number_at(json, frame, "bytes") > 1000 && number_at(json, row, "sections_ms") > 0);
    CHECK(number_at(json, frame, "encode_moving_ms") > 0 && number_at(json, frame, "encode_still_ms") > 0);
    CHECK_NEAR(number_at(json, row, "moving_ms_a_second"), 100 * awake + 60 * moving, 1e-9);
    CHECK_NEAR(number_at(json, row, "still_ms_a_second"), 100 * asleep + 4 * still, 1e-9);
    const double second[3] = {100 * asleep + 4 * still,
                              0.1 * (100 * awake + 60 * moving) + 0.9 * (100 * asleep + 4 * still),
                              100 * awake + 60 * moving};
    for (uint32_t k = 0, item = heads + 1; k < 3 && json_items(json, heads) == 3;
         k++, item = json->tokens[item].after) {
        double count = 0;
        CHECK(json_real(json, item, &count));
        CHECK_NEAR(count * second[k], 1000, 1e-6);
    }
}

TEST(bench_writes_what_heads_cost_as_json)
{
    char path[300], arguments[400];
    if (!bench_is_built()) {
        return;
    }
    snprintf(path, sizeof path, "%s/bench-capacity.json", check_build_directory());
    snprintf(arguments, sizeof arguments,
             "--style short --heads 2 --strands 300 --frames 1 --level guides --viewers 2 --json '%s'", path);
    CHECK_INT(run_bench("capacity", arguments), 0);
    size_t size;
    char *text = (char *)check_read_file(path, &size);
    json_document json = {0};
    CHECK(text != NULL);
    if (text && json_read(text, size, &json, NULL) == AWT_OK) {
        const uint32_t styles = json_member(&json, 0, "styles");
        CHECK_INT(json_items(&json, styles), 1);
        CHECK(json_is_text(&json, json_member(&json, styles + 1, "style"), "short"));
        CHECK_NEAR(number_at(&json, 0, "heads"), 2, 0);
        check_heads(&json, styles + 1);
    } else {
        CHECK(json.count > 0); /* it is no JSON */
    }
    json_fini(&json);
    free(text);
    remove(path);
    CHECK_INT(run_bench("capacity", "--kind wool"), 2);
    CHECK_INT(run_bench("capacity", "--style bald"), 2);
    CHECK_INT(run_bench("capacity", "--heads 65"), 2);
    CHECK_INT(run_bench("capacity", "--level deep"), 2);
}
