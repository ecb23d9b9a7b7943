/* test_server_deltas.c: deltas against what each viewer has acknowledged: exact, shared, and few. */
#include "viewers_fixture.h"
#include "check.h"

#include <stdio.h>

static const struct proto_subscribe strands_with_deltas = {.kind = GEOM_STRANDS, .deltas = 1};
static const struct proto_subscribe guides_with_deltas = {.kind = GEOM_GUIDES, .deltas = 1};

/* Distinct frames among the last LIMIT_DELTA_BASES that someone has acknowledged last, and whether anyone has none of
 * them. */
static uint32_t count_bases(const viewers *v, uint64_t now, bool *lacking)
{
    bool seen[LIMIT_DELTA_BASES] = {false};
    uint32_t count = 0;
    for (uint32_t i = 0; i < v->count; i++) {
        const uint64_t had = v->each[i].had, back = now - 1 - had;
        if (had == 0 || back >= LIMIT_DELTA_BASES) {
            *lacking = true;
        } else {
            count += !seen[back];
            seen[back] = true;
        }
    }
    return count;
}

static void watch_by_a_thousand(const struct proto_subscribe *asked, uint32_t whole_for_all)
{
    enum { VIEWERS = 1000, STEPS = 40 };
    viewers v;
    viewers_init(&v, VIEWERS, asked);
    uint64_t encoded = 0, possible = 0, sent = 0;
    uint32_t most = 0;
    for (uint64_t step = 1; step <= STEPS; step++) {
        bool lacking = false;
        const uint64_t before = v.shared.counters.frames_encoded;
        const uint32_t distinct = count_bases(&v, step + 1, &lacking);
        viewers_advance(&v, step < STEPS - 5);
        const uint64_t now = v.shared.counters.frames_encoded - before;
        CHECK(now <= distinct + 1 + (lacking ? whole_for_all : 0)); /* the driver asks for a whole frame */
        encoded += now;
        possible += distinct;
        most = distinct > most ? distinct : most;
        for (uint32_t i = 0; i < VIEWERS; i++) { /* each step; each third one, on three different days; each twelfth */
            if (i % 3 == 0 || (i % 3 == 1 && (step + i / 3) % 3 == 0) || (i % 3 == 2 && (step + i / 3) % 12 == 0)) {
                viewers_acknowledge(&v, i);
            }
        }
    }
    uint64_t whole = 0, deltas = 0, slow_deltas = 0;
    for (uint32_t i = 0; i < VIEWERS; i++) {
        whole += v.each[i].whole;
        deltas += v.each[i].deltas;
        slow_deltas += i % 3 == 2 ? v.each[i].deltas : 0;
        CHECK(i % 3 != 0 || v.each[i].whole == 1); /* the first one */
    }
    sent = whole + deltas;
    printf(
        "     %d viewers, %d frames: %llu sent (%llu deltas, %llu of them to the slowest), %llu encoded, bases in the "
        "ring %.1f a frame, at most %u\n",
        VIEWERS, STEPS, (unsigned long long)sent, (unsigned long long)deltas, (unsigned long long)slow_deltas,
        (unsigned long long)encoded, (double)possible / STEPS, most);
    CHECK(deltas > 10 * STEPS && whole > VIEWERS);
    CHECK(most >= 3);
    viewers_fini(&v);
}

TEST(server_a_thousand_viewers_at_three_speeds_cost_an_encode_for_each_base_in_the_ring)
{
    watch_by_a_thousand(&strands_with_deltas, 0); /* the driver's serves who has no base too */
}

TEST(server_a_thousand_viewers_of_guides_cost_an_encode_for_each_base_in_the_ring)
{
    watch_by_a_thousand(&guides_with_deltas, 1);
}

/* Whole and delta, moving and at rest; who takes no deltas sees a mesh of the same step. */
TEST(server_guides_come_as_numbers_to_who_takes_deltas_and_as_a_mesh_to_who_does_not)
{
    const struct proto_subscribe mesh = {.kind = GEOM_GUIDES};
    const struct proto_subscribe *const asked[] = {&guides_with_deltas, &mesh};
    uint64_t bytes[2], resting[2];
    for (int n = 0; n < 2; n++) {
        viewers v;
        viewers_init(&v, 1, asked[n]);
        for (uint64_t step = 1; step <= 300; step++) {
            viewers_advance(&v, step < 20);
            CHECK_U64(v.each[0].frame.base, n == 0 && step > 1 ? step : 0);
            CHECK_INT(v.each[0].frame.kind, GEOM_GUIDES);
            CHECK_INT(v.each[0].frame.clamped_points, 0);
            bytes[n] = step == 20 ? v.each[0].bytes : bytes[n];
            viewers_acknowledge(&v, 0);
        }
        resting[n] = v.each[0].frame.glb.length;
        CHECK_INT(v.error, 0);
        CHECK_INT(v.each[0].whole, n == 0 ? 1 : 300);
        viewers_fini(&v);
    }
    CHECK(bytes[0] < bytes[1] / 2);
    CHECK(resting[0] < 1000); /* all of it sleeps */
}

TEST(server_deltas_are_smaller_than_whole_frames_and_nearly_nothing_at_rest)
{
    viewers v;
    viewers_init(&v, 1, &strands_with_deltas);
    viewers_advance(&v, true);
    CHECK_U64(v.each[0].frame.base, 0);
    const uint64_t whole = v.each[0].bytes;
    for (uint64_t step = 2; step <= 300; step++) {
        viewers_acknowledge(&v, 0);
        viewers_advance(&v, step < 10);
        CHECK_U64(v.each[0].frame.base, step); /* the one before */
        CHECK(v.each[0].frame.glb.length < whole);
    }
    CHECK(v.each[0].frame.glb.length < 1000); /* all of it sleeps */
    viewers_fini(&v);
}

TEST(server_bases_are_frames_sent_acknowledged_and_not_before_the_last_named)
{
    bases b = {0};
    CHECK_U64(bases_at(&b, 1, 0), 0);
    CHECK(!bases_acknowledge(&b, 1));
    for (uint64_t sequence = 11; sequence <= 20; sequence++) {
        bases_sent(&b, sequence, sequence == 18 ? 2 : 1, 0);
    }
    CHECK(bases_acknowledge(&b, 12)); /* sent, and too long ago to be known */
    CHECK_U64(bases_at(&b, 1, 0), 0);
    CHECK(!bases_acknowledge(&b, 21));
    for (uint64_t sequence = 13; sequence <= 19; sequence += 2) {
        CHECK(bases_acknowledge(&b, sequence));
    }
    CHECK(bases_acknowledge(&b, 18));
    CHECK_U64(bases_at(&b, 1, 0), 19);
    CHECK_U64(bases_at(&b, 1, 1), 17);
    CHECK_U64(bases_at(&b, 1, 3), 13);
    CHECK_U64(bases_at(&b, 1, 4), 0);
    CHECK_U64(bases_at(&b, 2, 0), 18);
    bases_sent(&b, 25, 1, 17);
    CHECK_U64(bases_at(&b, 1, 1), 17);
    CHECK_U64(bases_at(&b, 1, 2), 0);  /* the client may have dropped 15 */
    CHECK(!bases_acknowledge(&b, 22)); /* skipped */
    CHECK(bases_acknowledge(&b, 0));
    CHECK_U64(bases_at(&b, 1, 0), 0);
}

TEST(server_deltas_whose_base_has_left_the_ring_come_whole)
{
    viewers v;
    viewers_init(&v, 2, &strands_with_deltas);
    viewers_advance(&v, true);
    viewers_acknowledge(&v, 0); /* and gets the next frame, which it says nothing of */
    viewers_acknowledge(&v, 1);
    for (int i = 0; i < LIMIT_DELTA_BASES; i++) {
        viewers_advance(&v, true);
    }
    CHECK_U64(v.each[0].last, 3); /* of its credit */
    viewers_credit(&v, 0, 1, 0x3);
    CHECK_INT(v.error, 0);
    CHECK_U64(v.each[0].last, 10);
    CHECK_U64(v.each[0].frame.base, 2); /* drawn when it had no more than that, and that was the last of the ring */
    viewers_advance(&v, true);
    viewers_credit(&v, 1, 1, 2); /* the same again: 2 has left the ring */
    CHECK_U64(v.each[1].last, 11);
    CHECK_U64(v.each[1].frame.base, 0);
    viewers_fini(&v);
}

TEST(server_deltas_are_refused_for_frames_that_never_came)
{
    viewers v;
    viewers_init(&v, 1, &strands_with_deltas);
    viewers_credit(&v, 0, 5, 1); /* before the first frame */
    CHECK_INT(v.error, PROTO_ERROR_BAD_VALUE);
    viewers_advance(&v, true);
    viewers_advance(&v, true);
    CHECK_U64(v.each[0].last, 2); /* its one credit: the refused CREDIT gave none */
    v.error = 0;
    viewers_credit(&v, 0, 1, 3); /* skipped, so never sent here */
    CHECK_INT(v.error, PROTO_ERROR_BAD_VALUE);
    v.error = 0;
    viewers_credit(&v, 0, 1, UINT64_MAX);
    CHECK_INT(v.error, PROTO_ERROR_BAD_VALUE);
    CHECK_U64(v.each[0].last, 2);
    v.error = 0;
    viewers_acknowledge(&v, 0);
    viewers_acknowledge(&v, 0);
    CHECK_U64(v.each[0].last, 3);
    viewers_credit(&v, 0, 1, 0); /* it has lost them all */
    viewers_advance(&v, true);
    CHECK_U64(v.each[0].last, 4);
    CHECK_U64(v.each[0].frame.base, 0);
    CHECK_INT(v.error, 0);
    viewers_fini(&v);
}

/* A viewer that came while a worker had the forest: the picture lacks its view, and is drawn again without a step. */
TEST(server_views_missed_by_who_came_late_are_drawn_without_a_step)
{
    viewers v;
    viewers_init(&v, 1, &strands_with_deltas);
    proto_message query = fake_query(v.forest, 10000), message = {.type = PROTO_SUBSCRIBE, .request = 60};
    CHECK(fake_send(v.driver, &query)); /* a worker has it */
    message.as.subscribe = (struct proto_subscribe){.forest = v.forest, .kind = GEOM_GUIDES, .credit = 1};
    CHECK(fake_send(v.driver, &message));
    fake_expect(v.driver, PROTO_SUBSCRIBE_REPLY);
    fake_work(&v.shared, v.driver);
    CHECK_INT(fake_expect(v.driver, PROTO_FRAME)->as.frame.kind, GEOM_RIBBON);
    const struct proto_frame *late = &fake_expect(v.driver, PROTO_FRAME)->as.frame;
    CHECK_INT(late->kind, GEOM_GUIDES);
    CHECK_U64(late->sequence, 2);
    CHECK_INT(late->time_us, 10000);
    CHECK_U64(v.shared.counters.steps, 1);
    CHECK_U64(v.shared.counters.frames_encoded, 3); /* ribbon and strands; guides */
    CHECK_U64(v.each[0].last, 2);
    viewers_fini(&v);
}

/* ---- budgets ----------------------------------------------------------------------------------------------------- */

/* Bytes of a whole frame of strands of that level, as the forest stands. */
static uint32_t whole_size(viewers *v, uint8_t level)
{
    proto_message query = fake_query(v->forest, 0);
    query.as.query.latest = 1;
    query.as.query.kind = GEOM_STRANDS;
    query.as.query.level = level;
    CHECK(fake_send(v->driver, &query));
    fake_work(&v->shared, v->driver);
    return fake_expect(v->driver, PROTO_FRAME)->as.frame.glb.length;
}

TEST(server_budgets_are_kept_by_the_richest_level_that_fits)
{
    viewers probe;
    viewers_init(&probe, 1, &strands_with_deltas);
    const uint32_t full = whole_size(&probe, 0), fifth = whole_size(&probe, 1), guides = whole_size(&probe, 2);
    viewers_fini(&probe);
    CHECK(full > fifth && fifth > guides);
    const struct {
        uint32_t budget;
        uint8_t level;
    } cases[] = {{2 * full, 0}, {(full + fifth) / 2, 1}, {(fifth + guides) / 2, 2}, {1, 2}};
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        const struct proto_subscribe asked = {.kind = GEOM_STRANDS, .deltas = 1, .budget = cases[c].budget};
        viewers v;
        viewers_init(&v, 1, &asked);
        for (uint64_t step = 1; step <= 80; step++) {
            const uint64_t before = v.shared.counters.frames_encoded;
            viewers_advance(&v, step < 20);
            const struct proto_frame *frame = &v.each[0].frame;
            CHECK_U64(v.each[0].last, step + 1);
            CHECK_INT(frame->kind, GEOM_STRANDS);
            CHECK_INT(frame->level, cases[c].level);
            CHECK(frame->glb.length <= cases[c].budget || cases[c].budget == 1);
            CHECK((frame->base != 0) == (step > 1));
            /* the driver's whole frame, and what is sent; now and then what was not drawn for long, to be measured */
            const uint64_t encoded = v.shared.counters.frames_encoded - before;
            CHECK(encoded <= 2 || (encoded <= 4 && (step == 1 || step % LIMIT_SIZE_FRAMES <= 2)));
            viewers_acknowledge(&v, 0);
        }
        CHECK_INT(v.error, 0);
        viewers_fini(&v);
    }
}
