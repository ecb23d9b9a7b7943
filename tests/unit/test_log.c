/* test_log.c: how a line of the log looks, and how many there are of one kind. */
#include "check.h"
#include "log_limit.h"
#include "log_line.h"

#include <stdio.h>
#include <string.h>

static const char *line_of(log_format format, const char *details)
{
    static char line[LOG_LINE_BYTES];
    size_t size = log_line_write(format, "2025-03-01T12:00:00.123Z", LOG_WARN, "wrong token", details, line);
    CHECK(size > 0 && size < sizeof line && line[size - 1] == '\n');
    line[size - 1] = '\0';
    CHECK(strchr(line, '\n') == NULL);
    return line;
}

TEST(log_text_is_pairs_alone)
{
    CHECK_TEXT(line_of(LOG_TEXT, "peer=1.2.3.4:5 code=3"),
               "time=2025-03-01T12:00:00.123Z level=warn msg=\"wrong token\" peer=1.2.3.4:5 code=3");
    CHECK_TEXT(line_of(LOG_TEXT, ""), "time=2025-03-01T12:00:00.123Z level=warn msg=\"wrong token\"");
}

TEST(log_json_has_the_same_pairs)
{
#define HEAD "{\"time\":\"2025-03-01T12:00:00.123Z\",\"level\":\"warn\",\"msg\":\"wrong token\""
    CHECK_TEXT(line_of(LOG_JSON, ""), HEAD "}");
    CHECK_TEXT(line_of(LOG_JSON, "peer=[::1]:5 code=3 n=-12 z=0"),
               HEAD ",\"peer\":\"[::1]:5\",\"code\":3,\"n\":-12,\"z\":0}");
    CHECK_TEXT(line_of(LOG_JSON, "a=007 b=1234567890123456 c=- d="),
               HEAD ",\"a\":\"007\",\"b\":\"1234567890123456\",\"c\":\"-\",\"d\":\"\"}");
    CHECK_TEXT(line_of(LOG_JSON, "a=x\"y\\z"), HEAD ",\"a\":\"x\\u0022y\\u005cz\"}");
    CHECK_TEXT(line_of(LOG_JSON, "stray a=1  b=2 "), HEAD ",\"a\":1,\"b\":2}");
}

TEST(log_json_takes_a_strangers_text_whole)
{
    char quoted[LOG_QUOTED], details[LOG_QUOTED + 32];
    snprintf(details, sizeof details, "name=%s n=1", log_quote("a\" b=2 \\\n\xe9", 10, quoted));
    CHECK_TEXT(line_of(LOG_JSON, details), HEAD ",\"name\":\"a\\u0022 b=2 \\u005c\\u000a\\u00e9\",\"n\":1}");
}

TEST(log_json_closes_what_was_cut)
{
    CHECK_TEXT(line_of(LOG_JSON, "a=1 name=\"half of it"), HEAD ",\"a\":1,\"name\":\"half of it\"}");
    CHECK_TEXT(line_of(LOG_JSON, "a=1 name=\"half\\"), HEAD ",\"a\":1,\"name\":\"half\\u005c\"}");
    CHECK_TEXT(line_of(LOG_JSON, "a=1 name=\"half\\x0"), HEAD ",\"a\":1,\"name\":\"halfx0\"}");
    CHECK_TEXT(line_of(LOG_JSON, "a=1 nam"), HEAD ",\"a\":1}");
#undef HEAD
}

TEST(log_longest_details_find_room_in_both_formats)
{
    char details[LIMIT_LOG_LINE];
    memset(details, '"', sizeof details);
    details[0] = 'a';
    details[1] = '=';
    details[sizeof details - 1] = '\0';
    line_of(LOG_JSON, details);
    line_of(LOG_TEXT, details);
    memset(details + 2, '\x01', sizeof details - 3);
    CHECK(strlen(line_of(LOG_JSON, details)) > 6 * (sizeof details - 3));
}

TEST(log_takes_so_many_lines_of_a_kind_and_says_how_many_it_left_out)
{
    static log_limiter limiter;
    uint64_t left_out = 99;
    int64_t now_us = 5000000;
    limiter = (log_limiter){0};
    for (int i = 0; i < LIMIT_LOG_BURST; i++) {
        CHECK(log_limit_take(&limiter, "flood", now_us, &left_out));
        CHECK_U64(left_out, 0);
    }
    for (int i = 0; i < 1000; i++) {
        CHECK(!log_limit_take(&limiter, "flood", now_us, &left_out));
    }
    CHECK(log_limit_take(&limiter, "another", now_us, &left_out));
    now_us += 1000000 / LIMIT_LOG_PER_S;
    CHECK(log_limit_take(&limiter, "flood", now_us, &left_out));
    CHECK_U64(left_out, 1000);
    CHECK(!log_limit_take(&limiter, "flood", now_us, &left_out));
    now_us += 1000000;
    int taken = 0;
    for (int i = 0; i < 1000; i++) {
        taken += log_limit_take(&limiter, "flood", now_us, &left_out);
    }
    CHECK_INT(taken, LIMIT_LOG_PER_S);
}

TEST(log_kinds_beyond_the_room_share_one_place)
{
    static log_limiter limiter;
    static char names[LIMIT_LOG_EVENTS + 8][8];
    uint64_t left_out = 0;
    limiter = (log_limiter){0};
    for (int i = 0; i < LIMIT_LOG_EVENTS + 8; i++) {
        snprintf(names[i], sizeof names[i], "e%d", i);
        CHECK(log_limit_take(&limiter, names[i], 1, &left_out));
    }
    CHECK_U64(limiter.count, LIMIT_LOG_EVENTS);
}
