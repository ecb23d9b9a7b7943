/* test_server_session.c: how a conversation begins, what may come when, and what is refused. */
#include "server_fixture.h"
#include "check.h"

#include <string.h>

TEST(server_begins_with_hello)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, true));
    fake_client *client = fake_client_create(&shared);
    proto_message ping = {.type = PROTO_PING};
    CHECK(!fake_send(client, &ping));
    fake_expect_error(client, PROTO_ERROR_BAD_MAGIC);
    CHECK_INT(client->talk.state, SESSION_CLOSING);
    fake_client_destroy(client);

    client = fake_client_create(&shared);
    proto_message hello = fake_hello();
    hello.as.hello.magic[0] = 'X';
    fake_send(client, &hello);
    fake_expect_error(client, PROTO_ERROR_BAD_MAGIC);
    CHECK_INT(client->talk.state, SESSION_CLOSING);
    CHECK(!fake_send(client, &hello));
    CHECK(fake_receive(client) == NULL);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_chooses_a_version_from_the_range)
{
    static const struct {
        uint8_t lowest, highest;
        bool spoken;
    } ranges[] = {{0, 0, false}, {0, 1, true}, {1, 1, true}, {1, 9, true}, {2, 9, false}};
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, true));
    for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++) {
        fake_client *client = fake_client_create(&shared);
        proto_message hello = fake_hello();
        hello.as.hello.lowest_version = ranges[i].lowest;
        hello.as.hello.highest_version = ranges[i].highest;
        fake_send(client, &hello);
        if (ranges[i].spoken) {
            CHECK_INT(fake_expect(client, PROTO_WELCOME)->as.welcome.version, 1);
        } else {
            fake_expect_error(client, PROTO_ERROR_BAD_VERSION);
        }
        fake_client_destroy(client);
    }
    service_fini(&shared);
}

TEST(server_lets_the_token_in_and_proves_that_it_holds_it)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, true));
    fake_client *client = fake_client_with_token(&shared, fake_token);
    const proto_message *reply = fake_expect(client, PROTO_AUTH_REPLY);
    uint8_t nonce[AUTH_NONCE_SIZE], expected[AUTH_HASH_SIZE];
    memset(nonce, 0x5a, sizeof nonce);
    auth_server_proof(fake_token, client->talk.nonce, nonce, expected);
    CHECK_BYTES(reply->as.auth_reply.proof, expected, sizeof expected);
    CHECK_U64(reply->request, 9);
    CHECK_INT(client->talk.state, SESSION_OPEN);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_refuses_a_wrong_token)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, true));
    uint8_t wrong[AUTH_TOKEN_SIZE];
    memcpy(wrong, fake_token, sizeof wrong);
    wrong[15] ^= 1;
    fake_client *client = fake_client_with_token(&shared, wrong);
    fake_expect_error(client, PROTO_ERROR_WRONG_TOKEN);
    CHECK_INT(client->talk.state, SESSION_CLOSING);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_wants_auth_before_anything_else)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, true));
    static const uint16_t types[] = {PROTO_PING, PROTO_CREATE, PROTO_HELLO, PROTO_STATS, PROTO_WELCOME, 0x0777};
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        fake_client *client = fake_client_create(&shared);
        proto_message hello = fake_hello();
        fake_send(client, &hello);
        fake_expect(client, PROTO_WELCOME);
        CHECK(!fake_send_bytes(client, types[i], 0, NULL, 0));
        fake_expect_error(client, PROTO_ERROR_NO_TOKEN);
        CHECK_INT(client->talk.state, SESSION_CLOSING);
        fake_client_destroy(client);
    }
    service_fini(&shared);
}

TEST(server_nonces_differ)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, true));
    fake_client *a = fake_client_with_token(&shared, fake_token), *b = fake_client_with_token(&shared, fake_token);
    CHECK(memcmp(a->talk.nonce, b->talk.nonce, sizeof a->talk.nonce) != 0);
    fake_client_destroy(a);
    fake_client_destroy(b);
    service_fini(&shared);
}

TEST(server_limits_lengths_before_and_after_the_door)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_create(&shared);
    CHECK(!fake_send_bytes(client, PROTO_HELLO, 0, NULL, PROTO_MAX_GREETING + 1));
    fake_expect_error(client, PROTO_ERROR_TOO_LONG);
    fake_client_destroy(client);

    client = fake_client_open(&shared);
    CHECK(!fake_send_bytes(client, PROTO_UPLOAD, 0, NULL, PROTO_MAX_REQUEST + 1));
    fake_expect_error(client, PROTO_ERROR_TOO_LONG);
    CHECK_INT(client->talk.state, SESSION_CLOSING);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_skips_unknown_messages_and_names_required_ones)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    CHECK(!fake_send_bytes(client, 0x0777, 0, NULL, 100));
    CHECK(fake_receive(client) == NULL);
    CHECK(!fake_send_bytes(client, 0x0777, PROTO_FLAG_REQUIRED, NULL, 100));
    fake_expect_error(client, PROTO_ERROR_UNKNOWN_MESSAGE);
    CHECK_INT(client->talk.state, SESSION_OPEN);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_refuses_messages_out_of_order)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    static const uint16_t types[] = {PROTO_HELLO, PROTO_AUTH, PROTO_FRAME, PROTO_CREATE_REPLY, PROTO_GOAWAY};
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        fake_client *client = fake_client_open(&shared);
        CHECK(!fake_send_bytes(client, types[i], 0, NULL, 0));
        fake_expect_error(client, PROTO_ERROR_OUT_OF_ORDER);
        CHECK_INT(client->talk.state, SESSION_CLOSING);
        fake_client_destroy(client);
    }
    service_fini(&shared);
}

TEST(server_answers_what_does_not_decode)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    unsigned char motion[512] = {0}; /* a quaternion of length 0, and then too many bytes */
    CHECK(fake_send_bytes(client, PROTO_MOTION, 0, motion, 139));
    fake_expect_error(client, PROTO_ERROR_BAD_VALUE);
    CHECK_INT(client->talk.state, SESSION_OPEN);
    CHECK(fake_send_bytes(client, PROTO_PING, 0, motion, 9));
    fake_expect_error(client, PROTO_ERROR_BAD_FRAME);
    CHECK_INT(client->talk.state, SESSION_CLOSING);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_answers_ping_stats_and_styles)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    proto_message message = {.type = PROTO_PING, .request = 5};
    message.as.ping.sent_us = -77;
    fake_send(client, &message);
    const proto_message *pong = fake_expect(client, PROTO_PONG);
    CHECK_INT(pong->as.pong.sent_us, -77);
    CHECK_INT(pong->as.pong.received_us, fake_now_us);
    message = (proto_message){.type = PROTO_STATS};
    fake_now_us += 250;
    fake_send(client, &message);
    const proto_message *stats = fake_expect(client, PROTO_STATS_REPLY);
    CHECK_U64(stats->as.stats_reply.uptime_us, 250);
    CHECK_INT(stats->as.stats_reply.connections, 1);
    message = (proto_message){.type = PROTO_LIST_STYLES};
    fake_send(client, &message);
    const proto_message *styles = fake_expect(client, PROTO_LIST_STYLES_REPLY);
    CHECK_INT(styles->as.list_styles_reply.styles.count, awt_style_count());
    CHECK_INT(styles->as.list_styles_reply.params.count, awt_param_count());
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_takes_no_more_sessions_than_it_was_given)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *clients[FAKE_SESSIONS];
    for (size_t i = 0; i < FAKE_SESSIONS; i++) {
        clients[i] = fake_client_open(&shared);
    }
    session one_more;
    CHECK(!session_init(&one_more, &shared, &clients[0]->talk.sink, "test"));
    session_fini(&one_more);
    for (size_t i = 0; i < FAKE_SESSIONS; i++) {
        fake_client_destroy(clients[i]);
    }
    CHECK_INT(shared.counters.sessions, 0);
    service_fini(&shared);
}
