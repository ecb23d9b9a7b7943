/* test_frames.c: hair between frames, in simulated time: no clock, no socket. */
#include "check.h"
#include "awtpace.h"
#include "framemix.h"
#include "relay/lane.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STRANDS = 3, POINTS = 4, FLOATS = STRANDS * POINTS * 3, LAST = AWTFRAMES_KEPT + 12 };

/* Hair that moves evenly: by 1 m/s along x in the head frame, on a head that moves by 2 m/s along z and turns. */
static void fill(geom_strands *strands, float *positions, float *widths, int64_t time_us)
{
    const double t = 1e-6 * (double)time_us;
    for (int i = 0; i < FLOATS; i++) {
        positions[i] = (float)(0.01 * i + (i % 3 == 0 ? t : 0));
    }
    for (int i = 0; i < POINTS; i++) {
        widths[i] = 0.001f / (float)(i + 1);
    }
    *strands = (geom_strands){.strand_count = STRANDS, .points_per_strand = POINTS, .positions = positions};
    strands->widths = widths;
    strands->time_us = time_us;
    strands->head.position[2] = 2 * t;
    strands->head.orientation[1] = sin(0.5 * t);
    strands->head.orientation[3] = cos(0.5 * t);
}

static void add(framemix *mix, int64_t time_us)
{
    float positions[FLOATS], widths[POINTS];
    geom_strands strands;
    fill(&strands, positions, widths, time_us);
    CHECK(framemix_add(mix, &strands));
}

static double distance(const awtframes_shown *shown, int64_t time_us)
{
    float positions[FLOATS], widths[POINTS];
    geom_strands truth;
    double greatest = fabs(shown->head.position[2] - 2e-6 * (double)time_us);
    fill(&truth, positions, widths, time_us);
    for (int i = 0; i < FLOATS; i++) {
        greatest = fmax(greatest, fabs((double)shown->positions[i] - (double)positions[i]));
    }
    for (int i = 0; i < 4; i++) {
        greatest = fmax(greatest, fabs(shown->head.orientation[i] - truth.head.orientation[i]));
    }
    return greatest;
}

TEST(frames_show_hair_of_any_time_between_them_and_a_little_beyond)
{
    framemix mix;
    awtframes_shown shown;
    framemix_init(&mix, 20000);
    CHECK(!framemix_show(&mix, 0, &shown));
    add(&mix, 100000);
    CHECK(framemix_show(&mix, 50000, &shown));
    CHECK_INT(shown.way, AWTFRAMES_HELD);
    CHECK_NEAR(distance(&shown, 100000), 0, 1e-6);
    add(&mix, 116667);
    add(&mix, 110000); /* late: it is not shown any more */
    add(&mix, 133333);
    CHECK(framemix_show(&mix, 120000, &shown));
    CHECK_INT(shown.way, AWTFRAMES_BETWEEN);
    CHECK_INT(shown.time_us, 120000);
    CHECK_NEAR(distance(&shown, 120000), 0, 1e-5);
    CHECK_NEAR((double)shown.previous[0], 0.1, 1e-6);
    CHECK_NEAR(shown.previous_head.position[2], 0.2, 1e-9);
    CHECK_NEAR((double)shown.greatest[0], 0.01 * (FLOATS - 3) + 0.12, 1e-5);
    int64_t last_us = 133333, went_us = 7000;
    for (int64_t time_us = 140000; time_us < 173333; time_us += 7000) { /* ever slower */
        CHECK(framemix_show(&mix, time_us, &shown));
        CHECK_INT(shown.way, AWTFRAMES_BEYOND);
        CHECK(shown.time_us > last_us && shown.time_us - last_us < went_us);
        CHECK_NEAR(distance(&shown, shown.time_us), 0, 1e-4);
        went_us = shown.time_us - last_us;
        last_us = shown.time_us;
    }
    CHECK(framemix_show(&mix, 400000, &shown));
    CHECK_INT(shown.way, AWTFRAMES_HELD);
    CHECK_INT(shown.time_us, 153333);
    CHECK_NEAR(distance(&shown, 153333), 0, 1e-4);
    CHECK(framemix_show(&mix, 140000, &shown)); /* time does not run backwards */
    CHECK_INT(shown.time_us, 153333);
    framemix_fini(&mix);
}

TEST(frames_that_come_far_ahead_do_not_push_out_what_is_shown)
{
    framemix mix;
    awtframes_shown shown;
    framemix_init(&mix, 20000);
    add(&mix, 0);
    add(&mix, 16667);
    CHECK(framemix_show(&mix, 8000, &shown));
    for (int64_t n = 2; n < LAST; n++) {
        add(&mix, n * 16667);
    }
    for (int64_t time_us = 10000; time_us <= (LAST - 1) * 16667; time_us += 7000) {
        CHECK(framemix_show(&mix, time_us, &shown));
        CHECK_INT(shown.way, AWTFRAMES_BETWEEN);
        CHECK_INT(shown.time_us, time_us);
        CHECK_NEAR(distance(&shown, time_us), 0, 1e-2); /* a straight line over up to 200 ms */
    }
    add(&mix, LAST * 16667); /* of those that were shown the oldest leave */
    CHECK_INT(framemix_newest_us(&mix), LAST * 16667);
    framemix_fini(&mix);
}

TEST(frames_take_memory_for_as_many_as_come_ahead)
{
    framemix mix;
    awtframes_shown shown;
    framemix_init(&mix, 20000);
    for (int64_t n = 0; n < 1000; n++) {
        add(&mix, n * 16667);
        for (int64_t time_us = (n - 2) * 16667; n > 2 && time_us < (n - 1) * 16667; time_us += 6944) {
            CHECK(framemix_show(&mix, time_us, &shown));
            CHECK_INT(shown.way, AWTFRAMES_BETWEEN);
        }
    }
    int taken = 0;
    for (int i = 0; i < AWTFRAMES_KEPT; i++) {
        taken += mix.frames[i].positions != NULL;
    }
    CHECK(taken >= 2 && taken <= 5);
    framemix_fini(&mix);
}

TEST(frames_do_not_mix_across_a_jump_of_the_head_or_another_shape)
{
    framemix mix;
    awtframes_shown shown;
    float positions[FLOATS], widths[POINTS];
    geom_strands strands;
    framemix_init(&mix, 20000);
    add(&mix, 0);
    fill(&strands, positions, widths, 16667);
    strands.head.position[0] = 5;
    CHECK(framemix_add(&mix, &strands));
    CHECK(framemix_show(&mix, 8000, &shown));
    CHECK_NEAR(shown.head.position[0], 0, 0);
    CHECK(framemix_show(&mix, 16667, &shown));
    CHECK_NEAR(shown.head.position[0], 5, 0);
    strands.strand_count = 2;
    strands.time_us = 33333;
    CHECK(framemix_add(&mix, &strands));
    CHECK(framemix_show(&mix, 25000, &shown));
    CHECK_INT(shown.strand_count, 2);
    CHECK(shown.previous == shown.positions); /* nothing of this shape was shown before */
    CHECK(shown.time_us >= 25000);
    framemix_fini(&mix);
}

/* 60 frames a second come after 50 ms and up to 20 ms of jitter, through the relay's own lane; 144 pictures a second.
 */
TEST(frames_at_144_hz_are_even_over_a_line_of_50_ms_and_jitter)
{
    const lane_rules rules = {.delay_us = 50000, .jitter_us = 20000, .queue = 64 * LANE_PIECE};
    lane line;
    framemix mix;
    awtpace pace = {.count = 0};
    awtframes_shown shown;
    framemix_init(&mix, 10000);
    CHECK(lane_init(&line, &rules, 7));
    int64_t sent = 0, last_us = 0, least_us = INT64_MAX, greatest_us = 0;
    double off = 0;
    uint64_t held_before = 0;
    for (int64_t tick = 0; tick < 144 * 60; tick++) {
        const int64_t now_us = tick * 1000000 / 144;
        for (; sent * 1000000 / 60 <= now_us; sent++) {
            const int64_t time_us = sent * 1000000 / 60;
            memcpy(lane_room(&line), &time_us, sizeof time_us);
            lane_put(&line, sizeof time_us, time_us);
        }
        size_t size;
        const unsigned char *bytes;
        while ((bytes = lane_due(&line, now_us, &size)) != NULL) {
            int64_t time_us;
            memcpy(&time_us, bytes, sizeof time_us);
            add(&mix, time_us);
            awtpace_arrived(&pace, now_us, time_us);
            lane_sent(&line, size);
        }
        int64_t time_us;
        if (!awtpace_time(&pace, now_us, 100000, &time_us) || !framemix_show(&mix, time_us, &shown)) {
            continue;
        }
        off = fmax(off, distance(&shown, shown.time_us));
        if (tick >= 288) { /* two seconds to find the pace */
            const int64_t step_us = shown.time_us - last_us;
            least_us = step_us < least_us ? step_us : least_us;
            greatest_us = step_us > greatest_us ? step_us : greatest_us;
            held_before = tick == 288 ? mix.counts[AWTFRAMES_HELD] : held_before;
        }
        last_us = shown.time_us;
    }
    CHECK_U64(mix.counts[AWTFRAMES_HELD] - held_before, 0);
    CHECK(mix.counts[AWTFRAMES_BETWEEN] > 60 * 144 - 288);
    CHECK(least_us >= 6500 && greatest_us <= 7400); /* 6944 and the slew */
    CHECK_NEAR(off, 0, 1e-3);
    lane_fini(&line);
    framemix_fini(&mix);
}

TEST(frames_that_are_garbage_are_told_and_do_no_harm)
{
    static unsigned char garbage[5000];
    awtframes *frames = awtframes_create(10000);
    awtframes_shown shown;
    awtclient_error error = {.code = 0};
    struct proto_frame frame = {.kind = GEOM_STRANDS, .glb = {garbage, sizeof garbage}};
    uint32_t random = 1;
    CHECK(frames != NULL && !awtframes_begin(frames));
    CHECK(!awtframes_bind(frames, garbage, sizeof garbage, &error));
    CHECK_INT(error.code, AWTCLIENT_PEER);
    for (int n = 0; n < 3 * AWTFRAMES_WAITING; n++) { /* more than wait: the oldest are left out */
        for (size_t i = 0; i < sizeof garbage; i++) {
            random = random * 1664525 + 1013904223;
            garbage[i] = (unsigned char)(random >> 24);
        }
        memcpy(garbage, "glTF\2\0\0\0", 8);
        frame.sequence = (uint64_t)n + 1;
        frame.kind = (uint8_t)(n % 3);
        frame.base = n % 4 == 3 ? (uint64_t)n : 0;
        frame.glb.length = n % 5 == 4 ? 0 : sizeof garbage;
        CHECK(awtframes_take(frames, &frame, &error));
    }
    frame.kind = GEOM_NODES;
    CHECK(!awtframes_take(frames, &frame, &error));
    int decoded = 0;
    for (; awtframes_begin(frames); decoded++) {
        CHECK(!awtframes_begin(frames)); /* one job at a time */
        awtframes_decode(frames);
        error.code = 0;
        CHECK(!awtframes_end(frames, &error));
        CHECK_INT(error.code, AWTCLIENT_PEER);
    }
    CHECK_INT(decoded, AWTFRAMES_WAITING);
    CHECK_U64(awtframes_have(frames), 0);
    CHECK(!awtframes_show(frames, 0, &shown));
    awtframes_destroy(frames);
}
