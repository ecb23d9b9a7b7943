/* test_load_parts.c: what awt-load counts with: the histogram, the times at which requests are due, the book of what
 * came, and the JSON of it. No clock is asked. */
#include "check.h"

#include "geom/json.h"
#include "load/report.h"

#include <stdlib.h>
#include <string.h>

/* ---- the histogram ----------------------------------------------------------------------------------------------- */

TEST(load_histogram_keeps_three_digits_of_every_time)
{
    CHECK_INT(hdr_bucket_of(0), 0);
    CHECK_INT(hdr_bucket_of(-5), 0);
    CHECK_INT(hdr_bucket_of(2047), 2047);
    CHECK_INT(hdr_bucket_of(2048), 2048);
    CHECK_INT(hdr_bucket_of(INT64_MAX), HDR_BUCKETS - 1);
    CHECK_INT(hdr_bucket_end(HDR_BUCKETS - 1), (INT64_C(1) << HDR_BITS) - 1);
    unsigned last = 0;
    for (int64_t ns = 1; ns < INT64_C(1) << HDR_BITS; ns += 1 + ns / 700) {
        const unsigned bucket = hdr_bucket_of(ns);
        const int64_t end = hdr_bucket_end(bucket);
        CHECK(bucket >= last && bucket < HDR_BUCKETS);
        CHECK(end >= ns && (double)(end - ns) <= 1e-3 * (double)ns);
        CHECK_INT(hdr_bucket_of(end), bucket);
        CHECK(bucket == HDR_BUCKETS - 1 || hdr_bucket_of(end + 1) == bucket + 1);
        last = bucket;
    }
}

TEST(load_histogram_finds_ranks)
{
    hdr *h = hdr_create(), *other = hdr_create();
    CHECK_INT(hdr_at(h, 0.5), 0);
    for (int64_t ns = 1; ns <= 1000; ns++) {
        hdr_add(ns % 2 ? h : other, ns);
    }
    hdr_merge(h, other);
    CHECK_U64(hdr_count(h), 1000);
    CHECK_INT(hdr_at(h, 0), 1);
    CHECK_INT(hdr_at(h, 0.5), 500);
    CHECK_INT(hdr_at(h, 0.99), 990);
    CHECK_INT(hdr_at(h, 0.999), 999);
    CHECK_INT(hdr_at(h, 1), 1000);
    hdr_add(h, 123456789);
    CHECK_INT(hdr_at(h, 1), 123456789); /* to the nanosecond, though its bucket is wider */
    CHECK_INT(hdr_at(h, 0.9999), 123456789);
    hdr_destroy(h);
    hdr_destroy(other);
}

TEST(load_histogram_writes_percentiles_to_the_last_one)
{
    hdr *h = hdr_create();
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    for (int i = 1; i <= 4; i++) {
        hdr_add(h, i * 1000);
    }
    CHECK(hdr_write(h, file));
    fclose(file);
    double value, share, inverse, last_share = 0;
    unsigned long long count, last_count = 0;
    int lines = 0;
    for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n")) {
        const int fields = sscanf(line, "%lf %lf %llu %lf", &value, &share, &count, &inverse);
        if (fields >= 3) {
            CHECK(share > last_share && count > last_count);
            CHECK_NEAR(value, (double)count, 1e-3);        /* microseconds: the n-th value is n */
            CHECK(count == 4 ? fields == 3 : fields == 4); /* nothing is beyond the last one */
            last_share = share;
            last_count = count;
            lines++;
        }
    }
    CHECK_INT(lines, 4);
    CHECK_NEAR(last_share, 1, 0);
    free(text);
    hdr_destroy(h);
}

/* ---- when requests are due --------------------------------------------------------------------------------------- */

TEST(load_times_are_the_rate_asked_for_in_the_turns_of_each_side)
{
    timeline t;
    timeline_make(&t, 0, INT64_C(10000000000), true, false, 0);
    CHECK_INT(t.slices, 20);
    CHECK_INT(t.slice_ns, 1000000000);
    for (uint32_t s = 0; s < t.slices; s++) {
        CHECK_INT(t.modes[s], s % 2 ? LOAD_FLOOR : LOAD_PLAIN);
    }
    for (int side = 0; side < LOAD_SIDES; side++) {
        const int64_t period_ns = 16666667, phase_ns = 5000000;
        int64_t due_ns, before_ns = -1;
        uint32_t slice, ticks = 0;
        for (; timeline_due(&t, (load_side)side, phase_ns, period_ns, ticks, &due_ns, &slice); ticks++) {
            CHECK(due_ns > before_ns && timeline_slice_at(&t, due_ns) == slice);
            CHECK_INT(timeline_side((load_mode)t.modes[slice]), side);
            CHECK(due_ns - slice * t.slice_ns < t.busy_ns); /* the rest of a slice is quiet */
            before_ns = due_ns;
        }
        CHECK_INT(ticks, 540); /* 60 a second of 10 times 0.9 s */
    }
    CHECK_NEAR(timeline_busy_s(&t, LOAD_PLAIN), 9, 1e-9);
    CHECK_NEAR(timeline_busy_s(&t, LOAD_FLOOR), 9, 1e-9);
    CHECK_INT(timeline_slice_at(&t, -1), 0);
    CHECK_INT(timeline_slice_at(&t, 20 * t.slice_ns), t.slices);
}

TEST(load_times_hold_for_slow_rates_and_long_and_short_runs)
{
    timeline t;
    int64_t due_ns;
    uint32_t slice, ticks = 0;
    timeline_make(&t, 0, INT64_C(10000000000), true, true, 0);
    while (timeline_due(&t, LOAD_DAEMON, 0, INT64_C(4000000000), ticks, &due_ns, &slice)) {
        CHECK_INT(t.modes[slice], LOAD_LADEN);
        ticks++;
    }
    CHECK_INT(ticks, 3); /* after 0, 4 and 8 of 9 busy seconds */
    CHECK(!timeline_due(&t, LOAD_DAEMON, INT64_C(9000000000), 1, 0, &due_ns, &slice));
    CHECK(!timeline_due(&t, LOAD_DAEMON, 0, 1000, UINT64_MAX, &due_ns, &slice));
    timeline_make(&t, 0, INT64_C(86400000000000), true, false, 0);
    CHECK(t.slices <= TIMELINE_MAX_SLICES && t.slices * t.slice_ns > INT64_C(172000000000000));
    timeline_make(&t, INT64_C(2500000000), INT64_C(10000000000), true, false, 0);
    CHECK_INT(t.slices, 23);
    CHECK_INT(t.modes[2], LOAD_SETTLE);
    CHECK_INT(t.modes[3], LOAD_PLAIN);
    CHECK_NEAR(timeline_busy_s(&t, LOAD_PLAIN), 9, 1e-9);
    timeline_make(&t, 0, 400000000, false, false, 0);
    CHECK_INT(t.slices, 2);
    CHECK_INT(t.slice_ns, 200000000);
    CHECK(!timeline_due(&t, LOAD_BARE, 0, 1000, 0, &due_ns, &slice)); /* it has no turns */
}

TEST(load_pairs_change_their_order_each_time)
{
    timeline t;
    static const uint8_t expected[] = {LOAD_PLAIN, LOAD_FLOOR, LOAD_LADEN, LOAD_FLOOR,
                                       LOAD_LADEN, LOAD_FLOOR, LOAD_PLAIN, LOAD_FLOOR};
    timeline_make(&t, 0, INT64_C(20000000000), true, false, 10);
    CHECK_INT(t.slices, 40);
    CHECK_BYTES(t.modes, expected, sizeof expected);
    CHECK_NEAR(timeline_busy_s(&t, LOAD_PLAIN), timeline_busy_s(&t, LOAD_LADEN), 0);
    timeline_make(&t, 0, INT64_C(20000000000), true, false, TIMELINE_MAX_SLICES);
    CHECK(t.slices <= TIMELINE_MAX_SLICES);
}

/* ---- the book ---------------------------------------------------------------------------------------------------- */

TEST(load_book_compares_each_pair_of_slices_and_takes_the_median)
{
    book b;
    timeline t;
    static const int64_t laden_us[] = {110, 500, 90}; /* against 100 without: of all three the first is the median */
    timeline_make(&t, 0, 6000000000, true, false, 3);
    CHECK(book_init(&b, TIMELINE_MAX_SLICES));
    CHECK_NEAR(book_pair_ratio(&b, &t), 0, 0);
    CHECK_U64(book_mean_bytes(&b, LOAD_LADEN), 0);
    for (uint32_t s = 0; s < t.slices; s++) {
        const int64_t us = t.modes[s] == LOAD_LADEN ? laden_us[s / 4] : 100;
        book_answer(&b, (load_mode)t.modes[s], s, us * 1000, -1, 20000);
    }
    CHECK_NEAR(book_pair_ratio(&b, &t), 1.1, 2e-3);
    CHECK_U64(book_mean_bytes(&b, LOAD_LADEN), 20000);
    book_fini(&b);
}

TEST(load_book_counts_late_requests_and_keeps_the_first_error)
{
    book b;
    CHECK(book_init(&b, 0));
    CHECK_TEXT(book_error_text(&b), "");
    book_sent(&b, LOAD_PLAIN, BOOK_LATE_NS, 3);
    book_sent(&b, LOAD_PLAIN, BOOK_LATE_NS + 1, 2);
    CHECK_U64(atomic_load(&b.due[LOAD_PLAIN]), 5);
    CHECK_U64(atomic_load(&b.late[LOAD_PLAIN]), 1);
    book_error(&b, "number %d", 1);
    book_error(&b, "number %d", 2);
    CHECK_U64(atomic_load(&b.errors), 2);
    CHECK_TEXT(book_error_text(&b), "number 1");
    book_fini(&b);
}

/* ---- the JSON ---------------------------------------------------------------------------------------------------- */

static char *json_of(const load_run *run)
{
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    CHECK(report_json(run, file));
    fclose(file);
    return text;
}

static void check_times(const json_document *json, const char *name, double p50, double max)
{
    static const char *const keys[] = {"p50", "p90", "p99", "p999", "p9999", "max"};
    const uint32_t times = json_member(json, 0, name);
    double last = 0, value;
    CHECK_INT(times == JSON_NONE ? 0 : json->tokens[times].count, 6);
    for (int k = 0; k < 6; k++) {
        CHECK(json_real(json, json_member(json, times, keys[k]), &value) && value >= last);
        CHECK(k > 0 || (value >= p50 && value < p50 * 1.001));
        last = value;
    }
    CHECK_NEAR(last, max, 1e-9);
}

TEST(load_writes_its_figures_as_the_json_that_was_promised)
{
    static const char *const keys[] = {"scenario", "connections",  "offered_per_s", "achieved_per_s", "latency_us",
                                       "floor_us", "frame_age_us", "late_sends",    "errors"};
    const load_plan plan = {.scenario = LOAD_SLOW_VIEWER, .connections = 7};
    load_run *run = calloc(1, sizeof *run);
    double value = 0;
    run->plan = &plan;
    CHECK(book_init(&run->book, 0));
    run->busy_s[LOAD_PLAIN] = run->busy_s[LOAD_FLOOR] = 2;
    for (int i = 1; i <= 10; i++) {
        book_sent(&run->book, LOAD_PLAIN, 0, 2);
        book_answer(&run->book, LOAD_PLAIN, 0, i * 10000, i * 20000, 100);
        book_answer(&run->book, LOAD_FLOOR, 0, i * 1000, -1, 100);
    }
    char *text = json_of(run);
    json_document json = {0};
    CHECK(json_read(text, strlen(text), &json, NULL) == AWT_OK);
    CHECK_INT(json.tokens[0].count, 9);
    for (size_t k = 0; k < sizeof keys / sizeof keys[0]; k++) {
        CHECK(json_member(&json, 0, keys[k]) != JSON_NONE);
    }
    CHECK(json_is_text(&json, json_member(&json, 0, "scenario"), "slow-viewer"));
    CHECK(json_real(&json, json_member(&json, 0, "offered_per_s"), &value));
    CHECK_NEAR(value, 10, 0);
    CHECK(json_real(&json, json_member(&json, 0, "achieved_per_s"), &value));
    CHECK_NEAR(value, 5, 0);
    check_times(&json, "latency_us", 50, 100);
    check_times(&json, "floor_us", 5, 10);
    check_times(&json, "frame_age_us", 100, 200);
    json_fini(&json);
    free(text);
    book_fini(&run->book);
    free(run);
}

TEST(load_json_says_null_of_what_was_not_measured)
{
    const load_plan plan = {.scenario = LOAD_QUERY, .connections = 1};
    load_run *run = calloc(1, sizeof *run);
    run->plan = &plan;
    CHECK(book_init(&run->book, 0));
    char *text = json_of(run);
    json_document json = {0};
    CHECK(json_read(text, strlen(text), &json, NULL) == AWT_OK);
    CHECK(strstr(text, "nan") == NULL && strstr(text, "\"p50\": null") != NULL);
    json_fini(&json);
    free(text);
    book_fini(&run->book);
    free(run);
}
