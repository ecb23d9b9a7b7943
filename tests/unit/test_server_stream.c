/* test_server_stream.c: subscriptions: credit, frames left out, rates, ends. */
#include "server_fixture.h"
#include "check.h"

#include <string.h>

static uint64_t subscribe(fake_client *client, uint64_t forest, uint32_t credit, uint16_t rate)
{
    proto_message message = {.type = PROTO_SUBSCRIBE, .request = 60};
    message.as.subscribe.forest = forest;
    message.as.subscribe.credit = credit;
    message.as.subscribe.greatest_rate = rate;
    CHECK(fake_send(client, &message));
    return fake_expect(client, PROTO_SUBSCRIBE_REPLY)->as.subscribe_reply.subscription;
}

static void credit(fake_client *client, uint64_t handle, uint32_t frames)
{
    proto_message message = {.type = PROTO_CREDIT, .request = 61};
    message.as.credit.subscription = handle;
    message.as.credit.frames = frames;
    CHECK(fake_send(client, &message));
}

/* Advances by `count` frames of 10 ms. */
static void advance(service *shared, fake_client *driver, uint64_t forest, int64_t *time_us, int count)
{
    for (int i = 0; i < count; i++) {
        proto_message query = fake_query(forest, *time_us += 10000);
        CHECK(fake_send(driver, &query));
        fake_work(shared, driver);
        fake_expect(driver, PROTO_FRAME);
    }
}

/* The next frame of the subscription. */
static void expect_frame(fake_client *viewer, uint64_t sequence, uint32_t skipped)
{
    const proto_message *frame = fake_expect(viewer, PROTO_FRAME);
    CHECK_U64(frame->request, 60);
    CHECK_U64(frame->as.frame.sequence, sequence);
    CHECK_INT(frame->as.frame.skipped, skipped);
}

typedef struct scene {
    service shared;
    fake_client *driver, *viewer;
    uint64_t forest;
    uint8_t view_token[REGISTRY_TOKEN_SIZE];
    int64_t time_us;
} scene;

static void scene_init(scene *s)
{
    *s = (scene){0};
    CHECK(fake_service_init(&s->shared, 0, 4, false));
    s->driver = fake_client_open(&s->shared);
    s->viewer = fake_client_open(&s->shared);
    struct proto_create_reply made = fake_make_forest(&s->shared, s->driver, 1);
    s->forest = made.forest;
    proto_message attach = {.type = PROTO_ATTACH};
    attach.as.attach.forest = made.forest;
    memcpy(s->view_token, made.view_token, sizeof s->view_token);
    memcpy(attach.as.attach.token, made.view_token, sizeof made.view_token);
    CHECK(fake_send(s->viewer, &attach));
    fake_expect(s->viewer, PROTO_ATTACH_REPLY);
}

static void scene_fini(scene *s)
{
    fake_client_destroy(s->driver);
    fake_client_destroy(s->viewer);
    service_fini(&s->shared);
}

TEST(server_stream_sends_as_credit_allows_and_the_newest)
{
    scene s;
    scene_init(&s);
    uint64_t handle = subscribe(s.viewer, s.forest, 2, 0);
    CHECK(fake_receive(s.viewer) == NULL); /* nothing of before */
    advance(&s.shared, s.driver, s.forest, &s.time_us, 5);
    expect_frame(s.viewer, 2, 0);
    expect_frame(s.viewer, 3, 0);
    CHECK(fake_receive(s.viewer) == NULL);
    credit(s.viewer, handle, 1);
    expect_frame(s.viewer, 6, 2);
    CHECK(fake_receive(s.viewer) == NULL);
    credit(s.viewer, handle, UINT32_MAX);
    credit(s.viewer, handle, 1); /* does not come to 0 */
    advance(&s.shared, s.driver, s.forest, &s.time_us, 1);
    expect_frame(s.viewer, 7, 0);
    scene_fini(&s);
}

TEST(server_stream_waits_for_a_slow_receiver_without_slowing_the_driver)
{
    scene s;
    scene_init(&s);
    subscribe(s.viewer, s.forest, 100, 0);
    s.viewer->congested = true;
    advance(&s.shared, s.driver, s.forest, &s.time_us, 4);
    CHECK(fake_receive(s.viewer) == NULL);
    s.viewer->congested = false;
    session_stream(&s.viewer->talk);
    expect_frame(s.viewer, 5, 3);
    scene_fini(&s);
}

TEST(server_stream_serves_who_has_said_nothing_for_a_while_after_the_others)
{
    enum { VIEWERS = 5 };
    scene s;
    scene_init(&s);
    fake_client *viewers[VIEWERS];
    uint64_t handles[VIEWERS];
    for (int i = 0; i < VIEWERS; i++) {
        viewers[i] = fake_client_open(&s.shared);
        proto_message attach = {.type = PROTO_ATTACH};
        attach.as.attach.forest = s.forest;
        memcpy(attach.as.attach.token, s.view_token, sizeof s.view_token);
        CHECK(fake_send(viewers[i], &attach));
        fake_expect(viewers[i], PROTO_ATTACH_REPLY);
        handles[i] = subscribe(viewers[i], s.forest, 100, 0);
    }
    fake_now_us += LIMIT_SILENT_US + 1;
    for (int i = 0; i < VIEWERS; i += 2) {
        credit(viewers[i], handles[i], 1); /* of 0 to 4, 1 and 3 are silent */
    }
    advance(&s.shared, s.driver, s.forest, &s.time_us, 1);
    uint64_t last_heard = 0, first_silent = UINT64_MAX;
    for (int i = 0; i < VIEWERS; i++) {
        const uint64_t turn = viewers[i]->received[viewers[i]->next].turn;
        CHECK_INT(fake_expect(viewers[i], PROTO_FRAME)->as.frame.sequence, 2);
        if (i % 2) {
            first_silent = turn < first_silent ? turn : first_silent;
        } else {
            last_heard = turn > last_heard ? turn : last_heard;
        }
        fake_client_destroy(viewers[i]);
    }
    CHECK(last_heard < first_silent);
    scene_fini(&s);
}

TEST(server_stream_says_that_a_frame_is_stale_while_the_next_step_is_late)
{
    scene s;
    scene_init(&s);
    const uint64_t handle = subscribe(s.viewer, s.forest, 1, 0);
    advance(&s.shared, s.driver, s.forest, &s.time_us, 2); /* the second one waits for credit */
    CHECK_INT(fake_expect(s.viewer, PROTO_FRAME)->as.frame.flags, 0);
    const proto_message query = fake_query(s.forest, s.time_us += 10000);
    CHECK(fake_send(s.driver, &query));
    fake_now_us += LIMIT_STEP_US;
    credit(s.viewer, handle, 1); /* the step is due just now */
    CHECK_INT(fake_expect(s.viewer, PROTO_FRAME)->as.frame.flags, 0);
    fake_work(&s.shared, s.driver);
    const proto_message after = fake_query(s.forest, s.time_us += 10000);
    CHECK(fake_send(s.driver, &after));
    fake_now_us += LIMIT_STEP_US + 1;
    credit(s.viewer, handle, 2);
    CHECK_INT(fake_expect(s.viewer, PROTO_FRAME)->as.frame.flags, 1);
    fake_work(&s.shared, s.driver); /* late as it comes, its frame is the newest there is */
    CHECK_INT(fake_expect(s.viewer, PROTO_FRAME)->as.frame.flags, 0);
    scene_fini(&s);
}

TEST(server_stream_keeps_to_the_rate_asked_for)
{
    scene s;
    scene_init(&s);
    subscribe(s.viewer, s.forest, 100, 50); /* one in 20 ms */
    advance(&s.shared, s.driver, s.forest, &s.time_us, 1);
    expect_frame(s.viewer, 2, 0);
    fake_now_us += 10000;
    advance(&s.shared, s.driver, s.forest, &s.time_us, 1);
    CHECK(fake_receive(s.viewer) == NULL);
    CHECK_INT(session_due_us(&s.viewer->talk), fake_now_us + 10000);
    fake_now_us += 10000;
    advance(&s.shared, s.driver, s.forest, &s.time_us, 1);
    expect_frame(s.viewer, 4, 1);
    CHECK(session_due_us(&s.viewer->talk) == INT64_MAX);
    scene_fini(&s);
}

TEST(server_stream_ends_with_unsubscribe_detach_and_destroy)
{
    scene s;
    scene_init(&s);
    uint64_t first = subscribe(s.viewer, s.forest, 100, 0);
    proto_message end = {.type = PROTO_UNSUBSCRIBE};
    end.as.unsubscribe.subscription = first;
    CHECK(fake_send(s.viewer, &end));
    CHECK(fake_send(s.viewer, &end));
    fake_expect_error(s.viewer, PROTO_ERROR_NO_SUBSCRIPTION);
    credit(s.viewer, first, 1);
    fake_expect_error(s.viewer, PROTO_ERROR_NO_SUBSCRIPTION);
    credit(s.viewer, 0, 1);
    fake_expect_error(s.viewer, PROTO_ERROR_NO_SUBSCRIPTION);

    CHECK(subscribe(s.viewer, s.forest, 0, 0) != first);
    advance(&s.shared, s.driver, s.forest, &s.time_us, 1); /* a frame waits for credit */
    proto_message destroy = {.type = PROTO_DESTROY};
    destroy.as.destroy.forest = s.forest;
    CHECK(fake_send(s.driver, &destroy));
    fake_expect(s.driver, PROTO_DESTROY_REPLY);
    const proto_message *told = fake_expect(s.viewer, PROTO_ERROR);
    CHECK_INT(told->as.error.code, PROTO_ERROR_NO_FOREST);
    CHECK_U64(told->request, 60);
    CHECK_INT(s.viewer->talk.state, SESSION_OPEN);
    scene_fini(&s);
}

TEST(server_stream_refuses_forms_it_does_not_make)
{
    scene s;
    scene_init(&s);
    static const struct {
        uint8_t kind, level;
        int code;
    } asked[] = {{2, 1, PROTO_ERROR_NOT_SUPPORTED},
                 {2, 2, PROTO_ERROR_NOT_SUPPORTED},
                 {3, 1, PROTO_ERROR_NOT_SUPPORTED},
                 {4, 0, PROTO_ERROR_BAD_VALUE},
                 {0, 3, PROTO_ERROR_BAD_VALUE}};
    for (size_t i = 0; i < sizeof asked / sizeof asked[0]; i++) {
        proto_message message = {.type = PROTO_SUBSCRIBE};
        message.as.subscribe.forest = s.forest;
        message.as.subscribe.kind = asked[i].kind;
        message.as.subscribe.level = asked[i].level;
        CHECK(fake_send(s.viewer, &message));
        fake_expect_error(s.viewer, asked[i].code);
        message = fake_query(s.forest, 0);
        message.as.query.latest = 1;
        message.as.query.kind = asked[i].kind;
        message.as.query.level = asked[i].level;
        CHECK(fake_send(s.viewer, &message));
        fake_expect_error(s.viewer, asked[i].code);
    }
    for (int i = 0; i < LIMIT_SESSION_SUBSCRIPTIONS; i++) {
        subscribe(s.viewer, s.forest, 1, 0);
    }
    proto_message one_more = {.type = PROTO_SUBSCRIBE};
    one_more.as.subscribe.forest = s.forest;
    CHECK(fake_send(s.viewer, &one_more));
    fake_expect_error(s.viewer, PROTO_ERROR_LIMIT);
    scene_fini(&s);
}
