/* test_server_views.c: frames of every kind of one step: what is wanted is drawn, once, and nothing else. */
#include "server_fixture.h"
#include "check.h"

#include "geom/receive.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct scene {
    service shared;
    fake_client *client;
    uint64_t forest;
    int64_t time_us;
    uint32_t motions;
} scene;

static void scene_init(scene *s)
{
    *s = (scene){0};
    CHECK(fake_service_init(&s->shared, 0, 4, false));
    s->client = fake_client_open(&s->shared);
    s->forest = fake_make_forest(&s->shared, s->client, 1).forest;
}

static void scene_fini(scene *s)
{
    fake_client_destroy(s->client);
    service_fini(&s->shared);
}

static void ask(scene *s, bool latest, uint8_t kind)
{
    proto_message query = fake_query(s->forest, s->time_us);
    query.as.query.latest = latest;
    query.as.query.kind = kind;
    CHECK(fake_send(s->client, &query));
}

/* Moves the head where `moves`, and advances by 10 ms. */
static const struct proto_frame *advance(scene *s, uint8_t kind, bool moves)
{
    s->time_us += 10000;
    if (moves) {
        proto_message motion = fake_motion(s->forest, ++s->motions, s->time_us);
        CHECK(fake_send(s->client, &motion));
    }
    ask(s, false, kind);
    fake_work(&s->shared, s->client);
    return &fake_expect(s->client, PROTO_FRAME)->as.frame;
}

static const struct proto_frame *look(scene *s, uint8_t kind)
{
    ask(s, true, kind);
    fake_work(&s->shared, s->client);
    return &fake_expect(s->client, PROTO_FRAME)->as.frame;
}

static uint64_t subscribe(scene *s, uint8_t kind)
{
    proto_message message = {.type = PROTO_SUBSCRIBE, .request = 60};
    message.as.subscribe.forest = s->forest;
    message.as.subscribe.kind = kind;
    CHECK(fake_send(s->client, &message));
    return fake_expect(s->client, PROTO_SUBSCRIBE_REPLY)->as.subscribe_reply.subscription;
}

static geom_strands receive(const geom_binding *binding, const struct proto_frame *frame)
{
    geom_strands out = {0};
    awt_error error = {0};
    CHECK_INT(geom_receive_frame(binding, frame->glb.bytes, frame->glb.length, &out, &error), AWT_OK);
    CHECK_TEXT(error.text, "");
    CHECK_INT(out.time_us, frame->time_us);
    return out;
}

/* Greatest distance along an axis. */
static double distance(const geom_strands *a, const geom_strands *b)
{
    const size_t count = (size_t)a->strand_count * a->points_per_strand * 3;
    double greatest = 0;
    CHECK_INT(a->strand_count, b->strand_count);
    CHECK_INT(a->points_per_strand, b->points_per_strand);
    for (size_t i = 0; i < count; i++) {
        greatest = fmax(greatest, fabs((double)a->positions[i] - (double)b->positions[i]));
    }
    return greatest;
}

static bool holds(const proto_blob *blob, const char *text)
{
    const size_t length = strlen(text);
    for (size_t i = 0; i + length <= blob->length; i++) {
        if (memcmp(blob->bytes + i, text, length) == 0) {
            return true;
        }
    }
    return false;
}

static geom_binding *get_binding(scene *s)
{
    proto_message message = {.type = PROTO_BINDING, .request = 9};
    message.as.binding.forest = s->forest;
    CHECK(fake_send(s->client, &message));
    fake_work(&s->shared, s->client);
    const struct proto_binding_reply *reply = &fake_expect(s->client, PROTO_BINDING_REPLY)->as.binding_reply;
    geom_binding *binding = NULL;
    CHECK_U64(reply->forest, s->forest);
    CHECK_INT(geom_binding_read(reply->binding.bytes, reply->binding.length, &binding, NULL), AWT_OK);
    return binding;
}

TEST(server_views_of_every_kind_show_the_same_step_without_another)
{
    scene s;
    scene_init(&s);
    geom_strands shown[3];
    geom_binding *binding = get_binding(&s);
    for (int i = 0; i < 5; i++) {
        advance(&s, GEOM_RIBBON, true);
    }
    const struct proto_frame *ribbon = advance(&s, GEOM_RIBBON, true);
    const uint64_t steps = s.shared.counters.steps, encoded = s.shared.counters.frames_encoded;
    shown[0] = receive(NULL, ribbon);
    for (uint8_t kind = GEOM_STRANDS; kind <= GEOM_GUIDES; kind++) {
        const struct proto_frame *frame = look(&s, kind);
        CHECK_INT(frame->kind, kind);
        CHECK_U64(frame->sequence, ribbon->sequence);
        CHECK_INT(frame->time_us, ribbon->time_us);
        CHECK_INT(frame->steps, ribbon->steps);
        CHECK_INT(frame->clamped_points, 0);
        shown[kind] = receive(binding, frame);
        CHECK_INT(shown[kind].kind, kind);
        CHECK(distance(&shown[0], &shown[kind]) < 0.0005);
        CHECK(holds(&frame->glb, "_TURN") == (kind == GEOM_GUIDES)); /* turns beside the centres */
    }
    const struct proto_frame *nodes = look(&s, GEOM_NODES);
    geom_nodes got = {0};
    CHECK_INT(geom_read_nodes(nodes->glb.bytes, nodes->glb.length, &got, NULL), AWT_OK);
    CHECK_INT(got.count, ribbon->active_nodes);
    CHECK_U64(s.shared.counters.steps, steps);
    CHECK_U64(s.shared.counters.frames_encoded, encoded + 3);
    for (uint8_t kind = 0; kind <= GEOM_NODES; kind++) { /* all are there now: nobody works */
        ask(&s, true, kind);
        CHECK_INT(fake_expect(s.client, PROTO_FRAME)->as.frame.kind, kind);
    }
    CHECK_U64(s.shared.counters.frames_encoded, encoded + 3);
    geom_nodes_fini(&got);
    const uint32_t strands = shown[0].strand_count;
    for (uint8_t level = 1; level <= FORM_LEVEL_GREATEST; level++) {
        proto_message query = fake_query(s.forest, 0);
        query.as.query.latest = 1;
        query.as.query.kind = GEOM_STRANDS;
        query.as.query.level = level;
        CHECK(fake_send(s.client, &query));
        fake_work(&s.shared, s.client);
        const struct proto_frame *frame = &fake_expect(s.client, PROTO_FRAME)->as.frame;
        geom_strands coarser = receive(NULL, frame);
        CHECK_INT(frame->level, level);
        CHECK_INT(coarser.level, level);
        CHECK_INT(coarser.full_strand_count, shown[0].strand_count);
        CHECK(level == 1 ? coarser.strand_count < strands : coarser.strand_count > 0);
        geom_strands_fini(&coarser);
    }
    for (int i = 0; i < 3; i++) {
        geom_strands_fini(&shown[i]);
    }
    geom_binding_destroy(binding);
    scene_fini(&s);
}

TEST(server_views_are_drawn_for_who_wants_them_and_for_nobody_else)
{
    scene s;
    scene_init(&s);
    CHECK_U64(s.shared.counters.frames_encoded, 0); /* nobody has seen it yet */
    uint64_t before = 0;
    advance(&s, GEOM_NODES, true);
    CHECK_U64(s.shared.counters.frames_encoded, 1);
    const uint64_t handles[] = {subscribe(&s, GEOM_STRANDS), subscribe(&s, GEOM_GUIDES), subscribe(&s, GEOM_STRANDS)};
    before = s.shared.counters.frames_encoded;
    advance(&s, GEOM_GUIDES, true);
    CHECK_U64(s.shared.counters.frames_encoded, before + 2); /* strands and guides */
    advance(&s, GEOM_RIBBON, true);
    CHECK_U64(s.shared.counters.frames_encoded, before + 5);
    for (int i = 0; i < 3; i++) {
        proto_message end = {.type = PROTO_UNSUBSCRIBE};
        end.as.unsubscribe.subscription = handles[i];
        CHECK(fake_send(s.client, &end));
    }
    advance(&s, GEOM_RIBBON, true);
    CHECK_U64(s.shared.counters.frames_encoded, before + 6);
    scene_fini(&s);
}

/* Patches that did not move are kept; the bytes are those of who never saw the hair before. */
static const struct proto_frame *ask_attributed(scene *s, uint8_t kind, uint8_t level, uint8_t attributes)
{
    proto_message query = fake_query(s->forest, 0);
    query.as.query.latest = 1;
    query.as.query.kind = kind;
    query.as.query.level = level;
    query.as.query.attributes = attributes;
    CHECK(fake_send(s->client, &query));
    fake_work(&s->shared, s->client);
    return attributes < 2 && kind <= GEOM_STRANDS ? &fake_expect(s->client, PROTO_FRAME)->as.frame : NULL;
}

TEST(server_views_have_attributes_for_who_asks)
{
    scene s;
    scene_init(&s);
    advance(&s, GEOM_NODES, true);
    for (uint8_t kind = GEOM_RIBBON; kind <= GEOM_STRANDS; kind++) {
        for (uint8_t level = 0; level <= FORM_LEVEL_GREATEST; level++) {
            const struct proto_frame *frame = ask_attributed(&s, kind, level, 0);
            const uint32_t bytes = frame->glb.length;
            geom_strands plain = receive(NULL, frame);
            frame = ask_attributed(&s, kind, level, 1);
            geom_strands attributed = receive(NULL, frame);
            CHECK_INT(plain.attributes, 0);
            CHECK_INT(attributed.attributes, GEOM_ATTRIBUTES_ALL);
            CHECK_INT(attributed.level, level);
            CHECK(distance(&plain, &attributed) == 0);
            CHECK(frame->glb.length > bytes);
            CHECK(holds(&frame->glb, "TEXCOORD_0"));
            geom_strands_fini(&plain);
            geom_strands_fini(&attributed);
        }
    }
    const uint64_t encoded = s.shared.counters.frames_encoded;
    ask_attributed(&s, GEOM_STRANDS, 0, 1);
    CHECK_U64(s.shared.counters.frames_encoded, encoded);
    ask_attributed(&s, GEOM_GUIDES, 0, 1);
    fake_expect_error(s.client, PROTO_ERROR_NOT_SUPPORTED);
    ask_attributed(&s, GEOM_STRANDS, 0, 2);
    fake_expect_error(s.client, PROTO_ERROR_BAD_VALUE);
    scene_fini(&s);
}

TEST(server_views_with_attributes_come_whole_whatever_is_asked)
{
    scene s;
    scene_init(&s);
    proto_message message = {.type = PROTO_SUBSCRIBE, .request = 60};
    message.as.subscribe =
        (struct proto_subscribe){.forest = s.forest, .kind = GEOM_STRANDS, .credit = 9, .deltas = 1, .attributes = 1};
    CHECK(fake_send(s.client, &message));
    const uint64_t handle = fake_expect(s.client, PROTO_SUBSCRIBE_REPLY)->as.subscribe_reply.subscription;
    for (int i = 0; i < 3; i++) {
        advance(&s, GEOM_NODES, true);
        const struct proto_frame *frame = &fake_expect(s.client, PROTO_FRAME)->as.frame;
        CHECK_U64(frame->base, 0);
        geom_strands got = receive(NULL, frame);
        CHECK_INT(got.attributes, GEOM_ATTRIBUTES_ALL);
        geom_strands_fini(&got);
        proto_message credit = {.type = PROTO_CREDIT};
        credit.as.credit = (struct proto_credit){.subscription = handle, .frames = 1, .have = frame->sequence};
        CHECK(fake_send(s.client, &credit));
    }
    scene_fini(&s);
}

TEST(server_views_do_not_depend_on_what_was_drawn_before)
{
    enum { MOVING = 10, RESTING = 60 };
    for (uint8_t kind = GEOM_RIBBON; kind <= GEOM_GUIDES; kind++) {
        scene watched, unwatched;
        scene_init(&watched);
        scene_init(&unwatched);
        for (int i = 0; i < MOVING + RESTING; i++) {
            advance(&watched, kind, i < MOVING);
            advance(&unwatched, GEOM_NODES, i < MOVING);
            if (i == MOVING - 1 || i == MOVING + RESTING - 1) {
                const struct proto_frame *one = look(&watched, kind), *other = look(&unwatched, kind);
                CHECK_INT(one->glb.length, other->glb.length);
                CHECK(one->glb.length != other->glb.length ||
                      memcmp(one->glb.bytes, other->glb.bytes, one->glb.length) == 0);
            }
        }
        scene_fini(&watched);
        scene_fini(&unwatched);
    }
}

TEST(server_views_are_shown_though_the_step_beside_them_fails)
{
    scene s;
    scene_init(&s);
    advance(&s, GEOM_RIBBON, true);
    s.time_us += 10000;
    ask(&s, false, GEOM_RIBBON); /* a worker has it */
    s.time_us -= 10000;
    ask(&s, false, GEOM_RIBBON); /* waits, and is of the past */
    ask(&s, true, GEOM_STRANDS);
    fake_work(&s.shared, s.client);
    CHECK_U64(fake_expect(s.client, PROTO_FRAME)->as.frame.sequence, 3);
    fake_expect_error(s.client, PROTO_ERROR_BAD_TIME);
    const struct proto_frame *shown = &fake_expect(s.client, PROTO_FRAME)->as.frame;
    CHECK_U64(shown->sequence, 3);
    CHECK_INT(shown->kind, GEOM_STRANDS);
    CHECK_INT(s.client->talk.pending, 0);
    scene_fini(&s);
}

TEST(server_views_of_one_step_do_not_pile_up)
{
    scene s;
    scene_init(&s);
    advance(&s, GEOM_STRANDS, true);
    ask(&s, true, GEOM_RIBBON); /* a worker has it */
    ask(&s, true, GEOM_RIBBON); /* waits, and is drawn in vain */
    fake_work(&s.shared, s.client);
    for (int i = 0; i < 2; i++) {
        CHECK_U64(fake_expect(s.client, PROTO_FRAME)->as.frame.sequence, 2);
    }
    const resident *r = registry_find(&s.shared.forests, s.forest);
    int pictures = 0;
    for (const picture *p = r ? r->latest : NULL; p; p = p->earlier) {
        pictures++;
    }
    CHECK_INT(pictures, 2);
    scene_fini(&s);
}

TEST(server_binding_is_made_once_and_refuses_who_may_not)
{
    scene s;
    scene_init(&s);
    proto_message message = {.type = PROTO_BINDING, .request = 9};
    message.as.binding.forest = s.forest;
    CHECK(fake_send(s.client, &message));
    CHECK(fake_send(s.client, &message));
    CHECK_INT(s.client->talk.pending, 2);
    fake_work(&s.shared, s.client);
    const struct proto_binding_reply *first = &fake_expect(s.client, PROTO_BINDING_REPLY)->as.binding_reply;
    const struct proto_binding_reply *second = &fake_expect(s.client, PROTO_BINDING_REPLY)->as.binding_reply;
    CHECK_INT(first->binding.length, second->binding.length);
    CHECK_BYTES(first->binding.bytes, second->binding.bytes, first->binding.length);
    CHECK(fake_send(s.client, &message));
    fake_expect(s.client, PROTO_BINDING_REPLY); /* without a worker */
    CHECK_INT(s.client->talk.pending, 0);
    message.as.binding.level = 1;
    CHECK(fake_send(s.client, &message));
    fake_expect_error(s.client, PROTO_ERROR_NOT_SUPPORTED);
    message.as.binding.level = 3;
    CHECK(fake_send(s.client, &message));
    fake_expect_error(s.client, PROTO_ERROR_BAD_VALUE);
    message.as.binding.level = 0;
    fake_client *stranger = fake_client_open(&s.shared);
    CHECK(fake_send(stranger, &message));
    fake_expect_error(stranger, PROTO_ERROR_NOT_ALLOWED);
    message.as.binding.forest++;
    CHECK(fake_send(stranger, &message));
    fake_expect_error(stranger, PROTO_ERROR_NO_FOREST);
    fake_client_destroy(stranger);
    scene_fini(&s);
}

TEST(server_views_that_wait_when_the_forest_ends_are_refused)
{
    scene s;
    scene_init(&s);
    s.time_us = 10000;
    ask(&s, false, GEOM_RIBBON); /* a worker has it; the others wait */
    ask(&s, true, GEOM_NODES);
    proto_message message = {.type = PROTO_BINDING, .request = 9};
    message.as.binding.forest = s.forest;
    CHECK(fake_send(s.client, &message));
    message = (proto_message){.type = PROTO_DESTROY};
    message.as.destroy.forest = s.forest;
    CHECK(fake_send(s.client, &message));
    for (int i = 0; i < 2; i++) {
        const proto_message *told = fake_expect(s.client, PROTO_ERROR);
        CHECK_INT(told->as.error.code, PROTO_ERROR_NO_FOREST);
        CHECK_INT(told->as.error.about, i == 0 ? PROTO_BINDING : PROTO_QUERY); /* the latest first */
    }
    fake_expect(s.client, PROTO_DESTROY_REPLY);
    fake_work(&s.shared, s.client);
    fake_expect(s.client, PROTO_FRAME);
    CHECK_INT(s.client->talk.pending, 0);
    scene_fini(&s);
}
