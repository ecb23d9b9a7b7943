/* test_server_many.c: STEP_MANY: several forests by one deadline. */
#include "server_fixture.h"
#include "check.h"
#include "completions.h"

enum { FORESTS = 3 };

typedef struct scene {
    service shared;
    fake_client *client;
    uint64_t forests[FORESTS];
} scene;

static void scene_init(scene *s)
{
    CHECK(fake_service_init(&s->shared, 0, FORESTS, false));
    s->client = fake_client_open(&s->shared);
    for (int i = 0; i < FORESTS; i++) {
        s->forests[i] = fake_make_forest(&s->shared, s->client, (uint64_t)i).forest;
    }
}

static void scene_fini(scene *s)
{
    CHECK_INT(s->client->talk.pending, 0);
    fake_client_destroy(s->client);
    service_fini(&s->shared);
}

static void step_many(scene *s, uint64_t request, int64_t time_us)
{
    proto_message message = {.type = PROTO_STEP_MANY, .request = request};
    message.as.step_many.deadline_us = 20000;
    message.as.step_many.forests.count = FORESTS;
    for (int i = 0; i < FORESTS; i++) {
        message.as.step_many.forests.items[i] = (struct proto_step_request){s->forests[i], time_us};
    }
    CHECK(fake_send(s->client, &message));
}

static bool work_once(scene *s)
{
    const bool worked = worker_pool_run_one(s->shared.pool);
    completions_take(&s->shared);
    return worked;
}

static void expect(scene *s, int forest, int64_t time_us, uint64_t request, bool stale)
{
    const proto_message *frame = fake_expect(s->client, PROTO_FRAME);
    CHECK_U64(frame->request, request);
    CHECK_U64(frame->as.frame.forest, s->forests[forest]);
    CHECK_INT(frame->as.frame.time_us, time_us);
    CHECK_INT(frame->as.frame.flags, stale);
}

TEST(server_step_many_answers_once_for_each_forest)
{
    scene s;
    scene_init(&s);
    step_many(&s, 70, 10000);
    CHECK_INT(s.client->talk.pending, FORESTS);
    while (work_once(&s)) {
    }
    for (int i = 0; i < FORESTS; i++) {
        expect(&s, i, 10000, 70, false);
    }
    CHECK_INT(session_due_us(&s.client->talk), INT64_MAX);
    step_many(&s, 71, 5000); /* before the forests' time */
    while (work_once(&s)) {
    }
    for (int i = 0; i < FORESTS; i++) {
        const proto_message *refused = fake_expect(s.client, PROTO_ERROR);
        CHECK_INT(refused->as.error.code, PROTO_ERROR_BAD_TIME);
        CHECK_INT(refused->as.error.about, PROTO_STEP_MANY);
        CHECK_U64(refused->request, 71);
    }
    scene_fini(&s);
}

TEST(server_step_many_gives_what_there_is_at_the_deadline_and_the_step_goes_on)
{
    scene s;
    scene_init(&s);
    step_many(&s, 70, 10000);
    while (work_once(&s)) {
    }
    for (int i = 0; i < FORESTS; i++) {
        expect(&s, i, 10000, 70, false);
    }
    step_many(&s, 71, 20000);
    CHECK(work_once(&s));
    expect(&s, 0, 20000, 71, false);
    CHECK_INT(session_due_us(&s.client->talk), fake_now_us + 20000);
    fake_now_us += 20000;
    session_tick(&s.client->talk);
    expect(&s, 2, 10000, 71, true);
    expect(&s, 1, 10000, 71, true);
    CHECK_INT(s.client->talk.pending, 0);
    while (work_once(&s)) {
    }
    CHECK(fake_receive(s.client) == NULL); /* each is answered once */
    step_many(&s, 72, 30000);
    while (work_once(&s)) {
    }
    for (int i = 0; i < FORESTS; i++) {
        expect(&s, i, 30000, 72, false);
    }
    scene_fini(&s);
}

TEST(server_step_many_says_which_forests_it_cannot_step)
{
    scene s;
    scene_init(&s);
    proto_message clock = {.type = PROTO_SET_CLOCK, .as.set_clock = {.forest = s.forests[1], .mode = CLOCK_PAUSED}};
    CHECK(fake_send(s.client, &clock));
    fake_expect(s.client, PROTO_SET_CLOCK_REPLY);
    s.forests[2] = 4711;
    step_many(&s, 70, 10000);
    fake_expect_error(s.client, PROTO_ERROR_BAD_TIME);
    fake_expect_error(s.client, PROTO_ERROR_NO_FOREST);
    proto_message destroy = {.type = PROTO_DESTROY, .request = 80, .as.destroy.forest = s.forests[0]};
    CHECK(work_once(&s));
    expect(&s, 0, 10000, 70, false);
    fake_now_us += 20000;
    session_tick(&s.client->talk);
    CHECK(fake_receive(s.client) == NULL);
    CHECK(fake_send(s.client, &destroy));
    fake_expect(s.client, PROTO_DESTROY_REPLY);
    proto_message none = {.type = PROTO_STEP_MANY};
    CHECK(fake_send(s.client, &none));
    fake_expect_error(s.client, PROTO_ERROR_BAD_VALUE);
    scene_fini(&s);
}

TEST(server_step_many_without_a_frame_of_that_kind_is_busy_at_the_deadline)
{
    scene s;
    scene_init(&s);
    step_many(&s, 70, 10000);
    fake_now_us += 20000;
    session_tick(&s.client->talk);
    for (int i = 0; i < FORESTS; i++) {
        fake_expect_error(s.client, PROTO_ERROR_BUSY);
    }
    while (work_once(&s)) {
    }
    CHECK(fake_receive(s.client) == NULL);
    scene_fini(&s);
}
