/* test_server_forest.c: the life of forests in the daemon: who may do what, order, limits, ends. */
#include "server_fixture.h"
#include "check.h"
#include "completions.h"
#include "base/hash.h"

#include <string.h>

static proto_message attach(uint64_t forest, const uint8_t token[16])
{
    proto_message message = {.type = PROTO_ATTACH, .request = 30};
    message.as.attach.forest = forest;
    memcpy(message.as.attach.token, token, 16);
    return message;
}

static proto_message destroy(uint64_t forest)
{
    proto_message message = {.type = PROTO_DESTROY, .request = 31};
    message.as.destroy.forest = forest;
    return message;
}

static void send_bad(fake_client *client, proto_message message, int code)
{
    fake_send(client, &message);
    fake_expect_error(client, code);
}

static void send(fake_client *client, proto_message message)
{
    CHECK(fake_send(client, &message));
}

TEST(server_forest_is_made_moved_and_drawn)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    struct proto_create_reply made = fake_make_forest(&shared, client, 1);
    CHECK_INT(made.strands, 200);
    CHECK_INT(made.points_per_strand, 8);
    CHECK(made.colliders.count > 0);
    CHECK(memcmp(made.drive_token, made.view_token, sizeof made.drive_token) != 0);

    proto_message latest = fake_query(made.forest, 0);
    latest.as.query.latest = 1;
    send(client, latest);
    fake_work(&shared, client);
    CHECK_U64(fake_expect(client, PROTO_FRAME)->as.frame.sequence, 1); /* at rest, without any QUERY before */

    send(client, fake_motion(made.forest, 1, 16667));
    CHECK(fake_receive(client) == NULL);
    send(client, fake_query(made.forest, 16667));
    CHECK(fake_receive(client) == NULL);
    fake_work(&shared, client);
    const proto_message *reply = fake_expect(client, PROTO_FRAME);
    const struct proto_frame *frame = &reply->as.frame;
    CHECK_U64(reply->request, 4);
    CHECK_U64(frame->forest, made.forest);
    CHECK_U64(frame->sequence, 2);
    CHECK_INT(frame->time_us, 16667);
    CHECK_INT(frame->steps, 2);
    CHECK_INT(frame->clamped_points, 0);
    CHECK(frame->glb.length > 20 && memcmp(frame->glb.bytes, "glTF", 4) == 0);
    CHECK_U64(shared.counters.frames_encoded, 2);

    send(client, fake_query(made.forest, 16666));
    fake_work(&shared, client);
    fake_expect_error(client, PROTO_ERROR_BAD_TIME);
    CHECK_INT(client->talk.pending, 0);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_create_takes_what_it_was_told)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    proto_message create = fake_create(1);
    create.as.create.time_us = 5000000;
    create.as.create.head.position[1] = 1.7;
    create.as.create.body.position[1] = 1.7;
    create.as.create.params.count = 1;
    create.as.create.params.items[0] = (struct proto_param){proto_str_of("drag"), 3};
    create.as.create.own_colliders = 1;
    create.as.create.colliders.count = 1;
    create.as.create.colliders.items[0] = (struct proto_collider){.id = 9, .radius_a = 0.09f, .radius_b = 0.09f};
    send(client, create);
    fake_work(&shared, client);
    const struct proto_create_reply *made = &fake_expect(client, PROTO_CREATE_REPLY)->as.create_reply;
    CHECK_INT(made->colliders.count, 1);
    CHECK_INT(made->colliders.items[0].id, 9);
    CHECK(made->colliders.items[0].radius_b == 0.09f);
    CHECK_INT(made->top_wisps, 8);
    CHECK_INT(made->finest_wisps, 40);
    const resident *r = registry_find(&shared.forests, made->forest);
    CHECK_TEXT(r ? r->name : NULL, "short"); /* it was given none */
    CHECK_INT(r ? r->latest->figures.time_us : 0, 5000000);
    CHECK(r && awt_forest_head(r->work.forest).position[1] == 1.7);
    CHECK(r && awt_forest_params(r->work.forest).drag == 3);
    send_bad(client, fake_motion(made->forest, 1, 5000000), PROTO_ERROR_BAD_TIME);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_create_refuses_what_cannot_be_made)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    proto_message create = fake_create(1);
    create.as.create.style = proto_str_of("mohawk");
    send_bad(client, create, PROTO_ERROR_NO_STYLE);
    create = fake_create(1);
    create.as.create.source = 2;
    send_bad(client, create, PROTO_ERROR_BAD_VALUE);
    create = fake_create(1);
    create.as.create.params.count = 1;
    create.as.create.params.items[0] = (struct proto_param){proto_str_of("gel"), 1};
    send_bad(client, create, PROTO_ERROR_NO_PARAM);
    create.as.create.params.items[0] = (struct proto_param){proto_str_of("rest_gravity"), 2};
    send_bad(client, create, PROTO_ERROR_BAD_VALUE);
    create = fake_create(1);
    create.as.create.own_colliders = 1;
    create.as.create.colliders.count = 1;
    create.as.create.colliders.items[0].frame = 3;
    send_bad(client, create, PROTO_ERROR_BAD_VALUE);
    CHECK_INT(shared.forests.alive, 0);

    create = fake_create(1);
    create.as.create.strands = UINT32_MAX;
    send(client, create);
    fake_work(&shared, client);
    fake_expect_error(client, PROTO_ERROR_LIMIT);
    CHECK_INT(shared.forests.alive, 0);
    CHECK_INT(client->talk.pending, 0);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_forests_are_limited)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 2, false));
    fake_client *client = fake_client_open(&shared);
    struct proto_create_reply first = fake_make_forest(&shared, client, 1);
    fake_make_forest(&shared, client, 2);
    send_bad(client, fake_create(3), PROTO_ERROR_LIMIT);
    send(client, destroy(first.forest));
    fake_expect(client, PROTO_DESTROY_REPLY);
    struct proto_create_reply third = fake_make_forest(&shared, client, 3);
    CHECK(third.forest != first.forest); /* the same place, another generation */
    send_bad(client, fake_query(first.forest, 10), PROTO_ERROR_NO_FOREST);
    send_bad(client, destroy(first.forest), PROTO_ERROR_NO_FOREST);
    send_bad(client, fake_query(0, 10), PROTO_ERROR_NO_FOREST);
    send_bad(client, fake_query(UINT64_MAX, 10), PROTO_ERROR_NO_FOREST);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_forest_opens_with_its_tokens_alone)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *maker = fake_client_open(&shared), *viewer = fake_client_open(&shared);
    struct proto_create_reply made = fake_make_forest(&shared, maker, 1);
    proto_message latest = fake_query(made.forest, 0);
    latest.as.query.latest = 1;
    send_bad(viewer, latest, PROTO_ERROR_NOT_ALLOWED);

    send(viewer, attach(made.forest, made.view_token));
    CHECK_INT(fake_expect(viewer, PROTO_ATTACH_REPLY)->as.attach_reply.may_drive, 0);
    send(viewer, latest);
    fake_work(&shared, viewer);
    fake_expect(viewer, PROTO_FRAME);
    send_bad(viewer, fake_motion(made.forest, 1, 1000), PROTO_ERROR_NOT_ALLOWED);
    send_bad(viewer, fake_query(made.forest, 1000), PROTO_ERROR_NOT_ALLOWED);
    send_bad(viewer, destroy(made.forest), PROTO_ERROR_NOT_ALLOWED);

    send(viewer, attach(made.forest, made.drive_token));
    CHECK_INT(fake_expect(viewer, PROTO_ATTACH_REPLY)->as.attach_reply.may_drive, 1);
    fake_client_destroy(maker); /* forests outlive their makers */
    send(viewer, fake_query(made.forest, 1000));
    fake_work(&shared, viewer);
    fake_expect(viewer, PROTO_FRAME);

    proto_message detach = {.type = PROTO_DETACH};
    detach.as.detach.forest = made.forest;
    send(viewer, detach);
    CHECK(fake_receive(viewer) == NULL);
    send_bad(viewer, latest, PROTO_ERROR_NOT_ALLOWED);

    made.view_token[0] ^= 1;
    send_bad(viewer, attach(made.forest, made.view_token), PROTO_ERROR_WRONG_TOKEN);
    CHECK_INT(viewer->talk.state, SESSION_CLOSING);
    fake_client_destroy(viewer);
    service_fini(&shared);
}

TEST(server_forest_destroyed_while_busy_is_doomed_first)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    struct proto_create_reply made = fake_make_forest(&shared, client, 1);
    proto_message running = fake_query(made.forest, 10000), waiting = fake_query(made.forest, 20000);
    waiting.request = 5;
    send(client, running);
    send(client, waiting);
    CHECK_INT(client->talk.pending, 2);
    CHECK(worker_pool_run_one(shared.pool)); /* done, but not handed back */
    send(client, destroy(made.forest));
    CHECK_INT(shared.forests.alive, 1);
    const proto_message *refused = fake_expect(client, PROTO_ERROR);
    CHECK_INT(refused->as.error.code, PROTO_ERROR_NO_FOREST);
    CHECK_U64(refused->request, 5);
    fake_expect(client, PROTO_DESTROY_REPLY);
    send_bad(client, fake_query(made.forest, 30000), PROTO_ERROR_NO_FOREST);

    CHECK(completions_take(&shared));
    CHECK_U64(fake_expect(client, PROTO_FRAME)->request, 4); /* what had run is still answered */
    CHECK_INT(shared.forests.alive, 0);
    CHECK_INT(client->talk.pending, 0);
    CHECK(!worker_pool_run_one(shared.pool));
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_forest_is_not_there_before_it_is_made)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    struct proto_create_reply first = fake_make_forest(&shared, client, 1);
    send(client, fake_create(2));
    proto_message guess = attach(first.forest + 1, first.drive_token);
    send_bad(client, guess, PROTO_ERROR_NO_FOREST);
    send(client, (proto_message){.type = PROTO_LIST});
    CHECK_INT(fake_expect(client, PROTO_LIST_REPLY)->as.list_reply.total, 1);
    fake_work(&shared, client);
    CHECK_U64(fake_expect(client, PROTO_CREATE_REPLY)->as.create_reply.forest, first.forest + 1);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_forest_whose_maker_left_before_the_answer_is_not_kept)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared), *other = fake_client_open(&shared);
    send(client, fake_create(1));
    fake_client_destroy(client);
    CHECK_INT(shared.forests.alive, 1);
    fake_work(&shared, other);
    CHECK_INT(shared.forests.alive, 0);
    fake_client_destroy(other);
    service_fini(&shared);
}

TEST(server_query_of_a_client_that_left_still_happens)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared), *other = fake_client_open(&shared);
    struct proto_create_reply made = fake_make_forest(&shared, client, 1);
    send(client, fake_query(made.forest, 10000));
    fake_client_destroy(client);
    fake_work(&shared, other);
    send(other, (proto_message){.type = PROTO_LIST});
    const proto_message *list = fake_expect(other, PROTO_LIST_REPLY);
    CHECK_INT(list->as.list_reply.total, 1);
    CHECK_INT(list->as.list_reply.forests.items[0].time_us, 10000);
    fake_client_destroy(other);
    service_fini(&shared); /* with the forest in it */
}

static uint32_t waiting_inputs(const service *shared, uint64_t forest)
{
    const resident *r = registry_find(&shared->forests, forest);
    return r ? r->waiting_inputs : UINT32_MAX;
}

/* What SET_PARAMS is checked against, and what the simulation has taken. */
static awt_params params_of(const service *shared, uint64_t forest, bool taken)
{
    const resident *r = registry_find(&shared->forests, forest);
    return !r ? (awt_params){0} : taken ? awt_forest_params(r->work.forest) : r->params;
}

TEST(server_motions_may_be_repeated)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    struct proto_create_reply made = fake_make_forest(&shared, client, 1);
    send(client, fake_motion(made.forest, 5, 10000));
    send(client, fake_motion(made.forest, 5, 10000));
    send(client, fake_motion(made.forest, 4, 20000));
    CHECK_INT(waiting_inputs(&shared, made.forest), 1);
    send_bad(client, fake_motion(made.forest, 6, 10000), PROTO_ERROR_BAD_TIME);
    proto_message again = fake_motion(made.forest, 1, 20000);
    again.as.motion.epoch = 1;
    send(client, again);
    CHECK_INT(waiting_inputs(&shared, made.forest), 2);
    send(client, fake_motion(made.forest, 99, 30000)); /* of the old epoch */
    CHECK_INT(waiting_inputs(&shared, made.forest), 2);
    CHECK(fake_receive(client) == NULL);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_motions_that_the_forest_refuses_are_reported)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    struct proto_create_reply made = fake_make_forest(&shared, client, 1);
    proto_message motion = fake_motion(made.forest, 1, 10000);
    motion.request = 77;
    motion.as.motion.colliders.count = 1;
    motion.as.motion.colliders.items[0].id = 4711; /* no such obstacle */
    motion.as.motion.colliders.items[0].pose = motion.as.motion.head;
    send(client, motion);
    send(client, fake_query(made.forest, 10000));
    fake_work(&shared, client);
    const proto_message *refused = fake_expect(client, PROTO_ERROR);
    CHECK_INT(refused->as.error.about, PROTO_MOTION);
    CHECK_U64(refused->request, 77);
    fake_expect(client, PROTO_FRAME);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_forest_queue_is_bounded)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    struct proto_create_reply made = fake_make_forest(&shared, client, 1);
    for (uint32_t i = 1; i <= LIMIT_FOREST_INPUTS; i++) {
        send(client, fake_motion(made.forest, i, (int64_t)i * 1000));
    }
    CHECK(fake_receive(client) == NULL);
    send_bad(client, fake_motion(made.forest, 1000, 1000000), PROTO_ERROR_BUSY);
    send(client, fake_query(made.forest, LIMIT_FOREST_INPUTS * 1000)); /* takes them all */
    send(client, fake_motion(made.forest, 1000, 1000000));             /* and then there is room for the same again */
    for (int i = 0; i < LIMIT_FOREST_QUERIES; i++) {
        send(client, fake_query(made.forest, 1000000));
    }
    send_bad(client, fake_query(made.forest, 1000000), PROTO_ERROR_BUSY);
    fake_client_destroy(client);
    service_fini(&shared);
}

TEST(server_params_are_taken_all_or_none)
{
    service shared;
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    struct proto_create_reply made = fake_make_forest(&shared, client, 1);
    proto_message set = {.type = PROTO_SET_PARAMS, .request = 40};
    set.as.set_params.forest = made.forest;
    set.as.set_params.params.count = 2;
    set.as.set_params.params.items[0] = (struct proto_param){proto_str_of("wind_x"), 5};
    set.as.set_params.params.items[1] = (struct proto_param){proto_str_of("wind_q"), 5};
    send_bad(client, set, PROTO_ERROR_NO_PARAM);
    CHECK(params_of(&shared, made.forest, false).wind_x == 0);
    set.as.set_params.params.items[1] = (struct proto_param){proto_str_of("wind_z"), -5};
    send(client, set);
    fake_expect(client, PROTO_SET_PARAMS_REPLY);
    set.as.set_params.params.count = 1; /* the others stay */
    set.as.set_params.params.items[0] = (struct proto_param){proto_str_of("drag"), 2};
    send(client, set);
    fake_expect(client, PROTO_SET_PARAMS_REPLY);
    send(client, fake_query(made.forest, 10000));
    fake_work(&shared, client);
    fake_expect(client, PROTO_FRAME);
    CHECK(params_of(&shared, made.forest, true).wind_x == 5);
    CHECK(params_of(&shared, made.forest, true).wind_z == -5);
    CHECK(params_of(&shared, made.forest, true).drag == 2);
    fake_client_destroy(client);
    service_fini(&shared);
}

/* Three forests driven with pipelined motions, parameters and queries; the hash of every frame in its order. */
static uint64_t play(unsigned workers, bool hurry)
{
    enum { FORESTS = 3, FRAMES = 4 };
    service shared;
    CHECK(fake_service_init(&shared, workers, FORESTS, false));
    uint64_t hash = HASH_SEED, forests[FORESTS];
    fake_client *clients[FORESTS];
    for (uint32_t i = 0; i < FORESTS; i++) {
        clients[i] = fake_client_open(&shared);
        forests[i] = fake_make_forest(&shared, clients[i], i).forest;
    }
    for (uint32_t frame = 1; frame <= FRAMES; frame++) {
        for (uint32_t i = 0; i < FORESTS; i++) {
            send(clients[i], fake_motion(forests[i], frame, (int64_t)frame * 16667));
            send(clients[i], fake_query(forests[i], (int64_t)frame * 16667));
            while (!hurry && clients[i]->count < frame + 2) {
                fake_work(&shared, clients[i]);
            }
        }
    }
    for (uint32_t i = 0; i < FORESTS; i++) {
        clients[i]->next = 2; /* after WELCOME and CREATE_REPLY */
        for (uint32_t frame = 1; frame <= FRAMES; frame++) {
            fake_work(&shared, clients[i]);
            const struct proto_frame *f = &fake_expect(clients[i], PROTO_FRAME)->as.frame;
            CHECK_INT(f->time_us, (int64_t)frame * 16667);
            hash = hash_words(hash, f->glb.bytes, f->glb.length / 4);
        }
        fake_client_destroy(clients[i]);
    }
    service_fini(&shared);
    return hash;
}

TEST(server_frames_do_not_depend_on_workers_or_pace)
{
    uint64_t alone = play(0, false);
    CHECK_U64(play(0, true), alone); /* motions come while earlier queries still wait: each sees only those before it */
    CHECK_U64(play(1, true), alone);
    CHECK_U64(play(3, true), alone);
    CHECK_U64(play(2, false), alone);
}
