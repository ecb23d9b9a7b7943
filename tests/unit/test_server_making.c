/* test_server_making.c: PROGRESS: who hears how far a forest has come that is being made, and when. */
#include "server_fixture.h"
#include "check.h"
#include "making.h"

#include <stdlib.h>

static proto_message create_telling(uint64_t seed, uint64_t request)
{
    proto_message message = fake_create(seed);
    message.request = request;
    message.as.create.progress = 1;
    return message;
}

static void check_progress(fake_client *client, uint64_t request, int stage)
{
    const proto_message *message = fake_expect(client, PROTO_PROGRESS);
    CHECK_U64(message->request, request);
    CHECK_INT(message->as.progress.stage, stage);
}

TEST(server_tells_of_a_forest_that_is_being_made_at_its_pace)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared), *other = fake_client_open(&shared);
    CHECK(making_due_us(&shared) == INT64_MAX);
    proto_message create = create_telling(1, 50), quiet = fake_create(2);
    CHECK(fake_send(client, &create) && fake_send(other, &quiet));
    CHECK(making_due_us(&shared) <= fake_now_us);
    making_tell(&shared, fake_now_us);
    check_progress(client, 50, FOREST_WAITS);
    CHECK(making_due_us(&shared) == fake_now_us + LIMIT_PROGRESS_US);
    making_tell(&shared, fake_now_us + LIMIT_PROGRESS_US - 1); /* not due */
    making_tell(&shared, fake_now_us + LIMIT_PROGRESS_US);
    check_progress(client, 50, FOREST_WAITS);
    CHECK(!fake_receive(client) && !fake_receive(other)); /* who did not ask hears nothing */
    fake_work(&shared, client);
    fake_expect(client, PROTO_CREATE_REPLY);
    fake_expect(other, PROTO_CREATE_REPLY);
    CHECK(making_due_us(&shared) == INT64_MAX);
    making_tell(&shared, fake_now_us + 10 * LIMIT_PROGRESS_US);
    CHECK(!fake_receive(client));
    fake_client_destroy(client);
    fake_client_destroy(other);
    service_fini(&shared);
}

TEST(server_tells_nobody_who_does_not_listen)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared), *other = fake_client_open(&shared);
    proto_message create = create_telling(1, 50);
    CHECK(fake_send(client, &create) && fake_send(other, &create));
    fake_client_destroy(other); /* gone before its forest is made */
    client->congested = true;   /* earlier messages have not gone out: nothing is queued behind them */
    making_tell(&shared, fake_now_us);
    CHECK(!fake_receive(client));
    client->congested = false;
    making_tell(&shared, fake_now_us + LIMIT_PROGRESS_US);
    check_progress(client, 50, FOREST_WAITS);
    fake_work(&shared, client);
    CHECK(making_due_us(&shared) == INT64_MAX);
    create = create_telling(1, 51);
    create.as.create.finest_wisps = 1; /* fewer than the top ones: refused by the worker */
    CHECK(fake_send(client, &create));
    fake_expect(client, PROTO_CREATE_REPLY);
    fake_work(&shared, client);
    fake_expect_error(client, PROTO_ERROR_BAD_VALUE);
    CHECK(making_due_us(&shared) == INT64_MAX);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_worker_notes_what_it_is_at)
{
    forest_work work = {0};
    float share = 1;
    CHECK_INT(forest_work_stage(&work, &share), FOREST_WAITS);
    CHECK_NEAR(share, 0, 0);
    atomic_store(&work.note, (unsigned)FOREST_WISPS << 16 | 65535u);
    CHECK_INT(forest_work_stage(&work, &share), FOREST_WISPS);
    CHECK_NEAR(share, 1, 0);
}
