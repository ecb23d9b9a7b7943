/* test_server_resume.c: what outlives a connection, for how long, and who is let go for saying nothing. */
#include "server_fixture.h"
#include "check.h"
#include "upkeep.h"

#include <string.h>

enum { GRACE_US = 5000000, FOREST_GRACE_US = 60000000, QUIET_US = 30000000 };

static void begin(service *shared)
{
    CHECK(fake_service_init(shared, 0, 4, false));
    shared->options.resume_grace_us = GRACE_US;
}

/* Time passes, and what is due is done. */
static void wait_us(service *shared, int64_t us)
{
    for (const int64_t end_us = fake_now_us + us; fake_now_us < end_us; upkeep_do(shared, fake_now_us)) {
        fake_now_us += end_us - fake_now_us < LIMIT_FOREST_LOOK_US ? end_us - fake_now_us : LIMIT_FOREST_LOOK_US;
    }
}

static proto_message resume_of(const uint8_t token[PARKING_TOKEN_SIZE])
{
    proto_message message = {.type = PROTO_RESUME, .request = 30};
    memcpy(message.as.resume.session, token, PARKING_TOKEN_SIZE);
    return message;
}

/* A client with a forest, whose connection is cut; its session's token. */
static uint64_t make_and_cut(service *shared, uint8_t token[PARKING_TOKEN_SIZE])
{
    fake_client *client = fake_client_open(shared);
    const uint64_t forest = fake_make_forest(shared, client, 1).forest;
    memcpy(token, client->talk.token, PARKING_TOKEN_SIZE);
    fake_client_destroy(client);
    return forest;
}

TEST(server_session_that_was_cut_off_is_resumed_with_its_forests)
{
    service shared;
    uint8_t token[PARKING_TOKEN_SIZE];
    begin(&shared);
    const uint64_t forest = make_and_cut(&shared, token);
    wait_us(&shared, GRACE_US - 1);
    fake_client *client = fake_client_open(&shared);
    proto_message resume = resume_of(token), query = fake_query(forest, 10000);
    CHECK(fake_send(client, &resume));
    const struct proto_resume_reply *reply = &fake_expect(client, PROTO_RESUME_REPLY)->as.resume_reply;
    CHECK_INT(reply->forests.count, 1);
    CHECK_U64(reply->forests.items[0].forest, forest);
    CHECK_INT(reply->forests.items[0].may_drive, 1);
    CHECK_INT(reply->uploads.count, 0);
    fake_send(client, &query);
    fake_work(&shared, client);
    fake_expect(client, PROTO_FRAME);
    fake_client *thief = fake_client_open(&shared); /* a token serves once */
    fake_send(thief, &resume);
    fake_expect_error(thief, PROTO_ERROR_NO_SESSION);
    fake_client_destroy(thief);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_session_is_not_resumed_after_its_grace_or_a_bye)
{
    service shared;
    uint8_t token[PARKING_TOKEN_SIZE];
    begin(&shared);
    make_and_cut(&shared, token);
    CHECK_INT(upkeep_due_us(&shared), fake_now_us + GRACE_US);
    wait_us(&shared, GRACE_US);
    CHECK_INT(shared.parked.count, 0);
    fake_client *client = fake_client_open(&shared);
    proto_message resume = resume_of(token), bye = {.type = PROTO_BYE};
    fake_send(client, &resume);
    fake_expect_error(client, PROTO_ERROR_NO_SESSION);
    fake_make_forest(&shared, client, 2);
    fake_send(client, &bye);
    fake_client_destroy(client);
    CHECK_INT(shared.parked.count, 0);
    service_fini(&shared);
}

TEST(server_session_is_resumed_while_its_old_connection_still_stands)
{
    service shared;
    begin(&shared);
    fake_client *old = fake_client_open(&shared), *new = fake_client_open(&shared);
    const uint64_t forest = fake_make_forest(&shared, old, 1).forest;
    proto_message resume = resume_of(old->talk.token), query = fake_query(forest, 10000);
    proto_message subscribe = {.type = PROTO_SUBSCRIBE, .request = 9};
    subscribe.as.subscribe = (struct proto_subscribe){.forest = forest, .credit = 9};
    fake_send(old, &subscribe);
    fake_expect(old, PROTO_SUBSCRIBE_REPLY);
    fake_send(new, &resume);
    CHECK_INT(fake_expect(new, PROTO_RESUME_REPLY)->as.resume_reply.forests.count, 1);
    fake_expect(old, PROTO_BYE);
    fake_send(new, &query);
    fake_work(&shared, new);
    fake_expect(new, PROTO_FRAME);
    CHECK(!fake_receive(old)); /* its subscription has ended */
    fake_client_destroy(old);
    CHECK_INT(shared.parked.count, 0);
    fake_client_destroy(new);
    service_fini(&shared);
}

TEST(server_resume_comes_before_anything_is_opened)
{
    service shared;
    uint8_t token[PARKING_TOKEN_SIZE];
    begin(&shared);
    make_and_cut(&shared, token);
    fake_client *client = fake_client_open(&shared);
    fake_make_forest(&shared, client, 2);
    proto_message resume = resume_of(token);
    fake_send(client, &resume);
    fake_expect_error(client, PROTO_ERROR_NOT_ALLOWED);
    CHECK_INT(shared.parked.count, 1);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_upload_goes_on_after_a_resume)
{
    static const unsigned char bytes[32] = "neither hair nor anything else";
    service shared;
    uint8_t token[PARKING_TOKEN_SIZE];
    begin(&shared);
    fake_client *client = fake_client_open(&shared);
    proto_message piece = {.type = PROTO_UPLOAD, .request = 8};
    piece.as.upload = (struct proto_upload){.upload = 3, .total = sizeof bytes, .piece = {bytes, 20}};
    fake_send(client, &piece);
    fake_expect(client, PROTO_UPLOAD_REPLY);
    memcpy(token, client->talk.token, sizeof token);
    fake_client_destroy(client);
    client = fake_client_open(&shared);
    proto_message resume = resume_of(token);
    fake_send(client, &resume);
    const struct proto_resume_reply *reply = &fake_expect(client, PROTO_RESUME_REPLY)->as.resume_reply;
    CHECK_INT(reply->uploads.count, 1);
    CHECK_INT(reply->uploads.items[0].upload, 3);
    CHECK_U64(reply->uploads.items[0].received, 20);
    CHECK_U64(reply->uploads.items[0].total, sizeof bytes);
    piece.as.upload.offset = 20;
    piece.as.upload.piece = (proto_blob){bytes + 20, 4};
    fake_send(client, &piece);
    CHECK_U64(fake_expect(client, PROTO_UPLOAD_REPLY)->as.upload_reply.received, 24);
    fake_client_destroy(client);
    service_fini(&shared);
    CHECK_U64(shared.uploads.used, 0);
}

TEST(server_keeps_no_more_parked_sessions_than_its_limit)
{
    service shared;
    uint8_t first[PARKING_TOKEN_SIZE], token[PARKING_TOKEN_SIZE];
    holdings out = {0};
    begin(&shared);
    make_and_cut(&shared, first);
    for (int i = 0; i < LIMIT_PARKED; i++) {
        holdings none = {0};
        memset(token, i & 0xff, sizeof token);
        token[0] = (uint8_t)(i >> 8);
        parking_leave(&shared.parked, token, &none, &shared.forests, fake_now_us, fake_now_us + GRACE_US);
    }
    CHECK_INT(shared.parked.count, LIMIT_PARKED);
    CHECK(!parking_take(&shared.parked, first, &out)); /* the oldest made room */
    CHECK(parking_take(&shared.parked, token, &out));
    CHECK_INT(shared.parked.count, LIMIT_PARKED - 1);
    service_fini(&shared);
}

TEST(server_forest_ends_when_nobody_has_had_it_open_for_long)
{
    service shared;
    uint8_t token[PARKING_TOKEN_SIZE];
    begin(&shared);
    shared.options.forest_grace_us = FOREST_GRACE_US;
    shared.forests_due_us = fake_now_us;
    fake_client *viewer = fake_client_open(&shared), *maker = fake_client_open(&shared);
    const struct proto_create_reply made = fake_make_forest(&shared, maker, 1);
    proto_message attach = {.type = PROTO_ATTACH, .request = 5};
    attach.as.attach.forest = made.forest;
    memcpy(attach.as.attach.token, made.view_token, sizeof made.view_token);
    fake_send(viewer, &attach);
    fake_expect(viewer, PROTO_ATTACH_REPLY);
    memcpy(token, maker->talk.token, sizeof token);
    fake_client_destroy(maker);
    wait_us(&shared, 2 * FOREST_GRACE_US);
    CHECK(registry_find(&shared.forests, made.forest) != NULL); /* it has a viewer */
    proto_message detach = {.type = PROTO_DETACH};
    detach.as.detach.forest = made.forest;
    fake_send(viewer, &detach);
    wait_us(&shared, FOREST_GRACE_US - LIMIT_FOREST_LOOK_US);
    CHECK(registry_find(&shared.forests, made.forest) != NULL);
    wait_us(&shared, 2 * LIMIT_FOREST_LOOK_US);
    CHECK(!registry_find(&shared.forests, made.forest));
    CHECK_INT(registry_ready_count(&shared.forests), 0);
    fake_client_destroy(viewer);
    service_fini(&shared);
}

TEST(server_client_that_stays_silent_is_asked_and_then_let_go)
{
    service shared;
    begin(&shared);
    shared.options.quiet_us = QUIET_US;
    fake_client *client = fake_client_open(&shared);
    CHECK_INT(session_due_us(&client->talk), fake_now_us + QUIET_US / 3);
    fake_now_us += QUIET_US / 3;
    session_tick(&client->talk);
    fake_expect(client, PROTO_PING);
    proto_message pong = {.type = PROTO_PONG};
    fake_send(client, &pong);
    fake_now_us += QUIET_US / 3 - 1;
    session_tick(&client->talk);
    CHECK(!fake_receive(client)); /* it gave a sign of life */
    fake_now_us += 1;
    session_tick(&client->talk);
    fake_expect(client, PROTO_PING);
    CHECK_INT(session_due_us(&client->talk), fake_now_us + QUIET_US - QUIET_US / 3);
    fake_now_us += QUIET_US - QUIET_US / 3;
    session_tick(&client->talk);
    fake_expect_error(client, PROTO_ERROR_TIMED_OUT);
    CHECK_INT(client->talk.state, SESSION_CLOSING);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_session_of_a_client_that_fell_silent_can_be_resumed)
{
    service shared;
    begin(&shared);
    shared.options.quiet_us = QUIET_US;
    for (int parked = 0; parked < 2; parked++) { /* while its connection is being closed, and afterwards */
        fake_client *client = fake_client_open(&shared), *again = NULL;
        const struct proto_create_reply made = fake_make_forest(&shared, client, (uint64_t)parked);
        proto_message resume = {.type = PROTO_RESUME, .request = 30};
        memcpy(resume.as.resume.session, client->talk.token, sizeof resume.as.resume.session);
        fake_now_us += QUIET_US / 3;
        session_tick(&client->talk);
        fake_now_us += QUIET_US - QUIET_US / 3;
        session_tick(&client->talk);
        CHECK_INT(client->talk.state, SESSION_CLOSING);
        if (parked) {
            fake_client_destroy(client);
        }
        again = fake_client_open(&shared);
        fake_send(again, &resume);
        const struct proto_resume_reply *reply = &fake_expect(again, PROTO_RESUME_REPLY)->as.resume_reply;
        CHECK_INT(reply->forests.count, 1);
        CHECK_U64(reply->forests.items[0].forest, made.forest);
        fake_client_destroy(again);
        if (!parked) {
            fake_client_destroy(client);
        }
    }
    service_fini(&shared);
}
