/* test_load.c: what is lowered when there is too much to do, in which order, and when it rises again. */
#include "server_fixture.h"
#include "check.h"
#include "health.h"
#include "completions.h"

#include <math.h>

static load_forest forest(double step, double encode, float importance)
{
    return (load_forest){
        .step_share = step, .encode_share = encode, .importance = importance, .streams = true, .measures = {1, 0}};
}

TEST(load_lowers_nothing_while_there_is_room)
{
    load_forest list[] = {forest(0.2, 0.3, 1), forest(0.2, 0.2, 1)};
    const load_verdict v = load_decide(list, 2, 1);
    CHECK_NEAR(v.cost, 0.9, 1e-9);
    CHECK(!v.full);
    CHECK(list[0].measures.thin == 1 && list[1].measures.thin == 1);
}

TEST(load_lowers_rates_before_levels_and_the_unimportant_first)
{
    load_forest list[] = {forest(0.1, 0.5, 10), forest(0.1, 0.5, 1)};
    load_verdict v = load_decide(list, 2, 1);
    CHECK(list[0].importance == 1 && list[0].measures.thin == 2 && list[0].measures.coarser == 0);
    CHECK(list[1].measures.thin == 1);
    CHECK_NEAR(v.cost, 0.95, 1e-9);
    load_forest more[] = {forest(0.1, 0.5, 10), forest(0.1, 0.5, 1)};
    v = load_decide(more, 2, 0.46);
    CHECK(more[0].measures.thin == 4 && more[1].measures.thin == 4); /* all rates go down before any level does */
    CHECK_NEAR(v.cost, 0.45, 1e-9);
    load_forest most[] = {forest(0.1, 0.5, 10), forest(0.1, 0.5, 1)};
    v = load_decide(most, 2, 0.37);
    CHECK(most[0].measures.coarser == 1 && most[1].measures.coarser == 0);
    CHECK(!v.full);
}

TEST(load_is_full_when_nothing_is_left_to_lower)
{
    load_forest list[] = {forest(0.8, 0.2, 1), forest(0.6, 0, 1)};
    list[1].streams = false;
    const load_verdict v = load_decide(list, 2, 1);
    CHECK(v.full && v.cost > 1);
    CHECK(list[0].measures.coarser == LOAD_COARSER_GREATEST);
    CHECK(list[1].measures.thin == 1); /* its driver asks for every frame */
}

TEST(load_that_was_lowered_rises_only_with_some_room)
{
    load_forest list[] = {forest(0.4, 0.5, 1)};
    list[0].measures.thin = 2; /* in force */
    load_decide(list, 1, 1);
    CHECK_INT(list[0].measures.thin, 2); /* it would fit, but only just */
    list[0].encode_share = 0.4;
    load_decide(list, 1, 1);
    CHECK_INT(list[0].measures.thin, 1);
}

TEST(load_meter_does_not_take_what_it_lowered_for_what_is_cheap)
{
    load_meter plain = {0}, lowered = {0};
    const load_measures none = {1, 0}, both = {4, 1};
    for (int i = 0; i < 40; i++) {
        plain.step_us += 100000, plain.encode_us += 200000;
        lowered.step_us += 100000, lowered.encode_us += (uint64_t)(200000 * 0.3 / 4);
        load_meter_take(&plain, &none, 1000000);
        load_meter_take(&lowered, &both, 1000000);
    }
    CHECK_NEAR(plain.step_share, 0.1, 1e-3);
    CHECK_NEAR(plain.encode_share, 0.2, 1e-3);
    CHECK_NEAR(lowered.encode_share, 0.2, 1e-3);
    CHECK_U64(plain.encode_us, 0);
}

/* ---- in the daemon ----------------------------------------------------------------------------------------------- */

typedef struct scene {
    service shared;
    fake_client *client;
    resident *r;
    uint32_t sequence; /* of the last MOTION */
} scene;

static void scene_init(scene *s)
{
    *s = (scene){0};
    CHECK(fake_service_init(&s->shared, 0, 4, false));
    s->client = fake_client_open(&s->shared);
    const uint64_t forest = fake_make_forest(&s->shared, s->client, 1).forest;
    s->r = registry_find(&s->shared.forests, forest);
    proto_message clock = {.type = PROTO_SET_CLOCK, .as.set_clock = {.forest = forest, .mode = CLOCK_FREE, .rate = 1}};
    CHECK(fake_send(s->client, &clock));
    fake_expect(s->client, PROTO_SET_CLOCK_REPLY);
    proto_message subscribe = {
        .type = PROTO_SUBSCRIBE,
        .as.subscribe = {.forest = forest, .kind = 1, .greatest_rate = 50, .credit = UINT32_MAX}};
    CHECK(fake_send(s->client, &subscribe));
    fake_expect(s->client, PROTO_SUBSCRIBE_REPLY);
}

/* A second passes in which the forest moves and is said to cost so much, its encoding as far as it is not lowered.
 * Frames that came, and the level of the last. */
static int pass(scene *s, uint64_t step_us, uint64_t encode_us, uint8_t *level)
{
    static const uint64_t percent[] = {100, 30, 15};
    int frames = 0;
    for (int ms = 0; ms < 1000; ms++) {
        fake_now_us += 1000;
        s->r->meter.step_us += step_us / 1000;
        s->r->meter.encode_us += encode_us / 1000 * percent[s->r->lowered.coarser] / 100 / s->r->lowered.thin;
        if (ms % 20 == 0) {
            const int64_t time_us = sim_clock_at(&s->r->clock, fake_now_us) + 40000;
            proto_message motion = fake_motion(s->r->handle, ++s->sequence, time_us);
            motion.as.motion.head.position[0] = 0.1 * sin((double)time_us * 6e-6);
            CHECK(fake_send(s->client, &motion));
        }
        while (worker_pool_run_one(s->shared.pool)) {
            completions_take(&s->shared);
        }
        session_tick(&s->client->talk);
        for (const proto_message *m; (m = fake_receive(s->client)) != NULL; frames++) {
            *level = m->as.frame.level;
        }
        fake_forget(s->client);
    }
    return frames;
}

TEST(server_under_load_lowers_rates_then_levels_then_takes_no_more_forests)
{
    scene s;
    uint8_t level = 9;
    scene_init(&s);
    CHECK(pass(&s, 0, 0, &level) >= 45);
    CHECK_INT(level, 0);
    for (int i = 0; i < 8; i++) {
        pass(&s, 300000, 700000, &level); /* of 0.8 processors */
    }
    CHECK(s.r->lowered.thin > 1 && !s.shared.load.full);
    const int thinned = pass(&s, 300000, 700000, &level);
    CHECK(thinned >= 10 && thinned <= 30);
    for (int i = 0; i < 12; i++) {
        pass(&s, 500000, 1500000, &level);
    }
    CHECK(s.r->lowered.coarser > 0);
    CHECK_INT(level, s.r->lowered.coarser);
    for (int i = 0; i < 8; i++) {
        pass(&s, 950000, 900000, &level);
    }
    proto_message create = fake_create(2);
    CHECK(fake_send(s.client, &create));
    const proto_message *refused = fake_expect(s.client, PROTO_ERROR);
    CHECK_INT(refused->as.error.code, PROTO_ERROR_BUSY);
    CHECK(refused->as.error.retry_after_ms > 0);
    health_set_serving();
    CHECK_TEXT(health_unready(fake_now_us), "overloaded");
    CHECK(health_unready(fake_now_us + LIMIT_OVERLOADED_US) == NULL);
    for (int i = 0; i < 20; i++) {
        pass(&s, 0, 0, &level);
    }
    CHECK(health_unready(fake_now_us) == NULL);
    CHECK(!s.shared.load.full && s.r->lowered.thin == 1);
    CHECK(pass(&s, 0, 0, &level) >= 45);
    CHECK_INT(level, 0);
    fake_client_destroy(s.client);
    service_fini(&s.shared);
}
