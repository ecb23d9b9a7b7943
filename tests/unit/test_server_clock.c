/* test_server_clock.c: forests that run by the daemon's clock: SET_CLOCK, frames at the rates asked for, what is
 * dropped, what wakes them, and that their recorded inputs give the same bits again. */
#include "server_fixture.h"
#include "check.h"
#include "completions.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct scene {
    service shared;
    fake_client *client;
    uint64_t forest;
    uint32_t sequence; /* of the last MOTION */
} scene;

static const resident *of(const scene *s)
{
    return registry_find(&s->shared.forests, s->forest);
}

static proto_message set_clock(uint64_t forest, uint8_t mode, float rate)
{
    proto_message message = {.type = PROTO_SET_CLOCK, .request = 50};
    message.as.set_clock.forest = forest;
    message.as.set_clock.mode = mode;
    message.as.set_clock.rate = rate;
    return message;
}

static struct proto_set_clock_reply run_clock(scene *s, uint8_t mode, float rate)
{
    proto_message message = set_clock(s->forest, mode, rate);
    CHECK(fake_send(s->client, &message));
    return fake_expect(s->client, PROTO_SET_CLOCK_REPLY)->as.set_clock_reply;
}

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

static void subscribe(scene *s, uint16_t rate, uint32_t credit)
{
    proto_message message = {.type = PROTO_SUBSCRIBE, .request = 60};
    message.as.subscribe.forest = s->forest;
    message.as.subscribe.kind = GEOM_GUIDES;
    message.as.subscribe.credit = credit;
    message.as.subscribe.greatest_rate = rate;
    CHECK(fake_send(s->client, &message));
    fake_expect(s->client, PROTO_SUBSCRIBE_REPLY);
}

static void move_to(scene *s, int64_t time_us, double x)
{
    proto_message motion = fake_motion(s->forest, ++s->sequence, time_us);
    motion.as.motion.head.position[0] = motion.as.motion.body.position[0] = x;
    CHECK(fake_send(s->client, &motion));
}

static void run_due(scene *s)
{
    while (worker_pool_run_one(s->shared.pool)) {
        completions_take(&s->shared);
    }
    session_tick(&s->client->talk);
}

/* The clock goes on, in milliseconds. */
static void pass(scene *s, int64_t us)
{
    for (const int64_t end_us = fake_now_us + us; fake_now_us < end_us;) {
        fake_now_us += end_us - fake_now_us < 1000 ? end_us - fake_now_us : 1000;
        run_due(s);
    }
}

/* Frames that have come since; *last_us: the time of the newest. */
static int take_frames(scene *s, int64_t *last_us)
{
    int count = 0;
    for (const proto_message *m; (m = fake_receive(s->client)) != NULL; count++) {
        CHECK_TEXT(proto_type_name(m->type), "FRAME");
        CHECK(m->as.frame.time_us > *last_us || *last_us == INT64_MIN);
        *last_us = m->as.frame.time_us;
    }
    return count;
}

TEST(server_clock_runs_pauses_and_goes_back_to_lock_step)
{
    scene s;
    scene_init(&s);
    const int64_t begin_us = fake_now_us;
    struct proto_set_clock_reply at = run_clock(&s, CLOCK_FREE, 2);
    CHECK_INT(at.time_us, 0);
    CHECK_INT(at.clock_us, begin_us);
    pass(&s, 400000);
    CHECK_INT(run_clock(&s, CLOCK_PAUSED, 0).time_us, 800000);
    const int64_t reached_us = of(&s)->state_us;
    CHECK(reached_us > 0 && reached_us <= 800000);
    pass(&s, 3000000);
    CHECK_INT(of(&s)->state_us, reached_us);
    CHECK_INT(run_clock(&s, CLOCK_FREE, 1).time_us, 800000);
    pass(&s, 2000000);
    CHECK_INT(run_clock(&s, CLOCK_LOCK_STEP, 0).time_us, 2800000);
    pass(&s, 2000000);
    CHECK(of(&s)->state_us <= 2800000);
    proto_message query = fake_query(s.forest, 2810000);
    CHECK(fake_send(s.client, &query));
    fake_work(&s.shared, s.client);
    CHECK_INT(fake_expect(s.client, PROTO_FRAME)->as.frame.time_us, 2810000);
    scene_fini(&s);
}

TEST(server_clock_refuses_what_is_no_clock)
{
    scene s;
    scene_init(&s);
    const struct {
        uint8_t mode;
        float rate, importance;
    } bad[] = {{3, 1, 0}, {CLOCK_FREE, 0, 0}, {CLOCK_FREE, -1, 0}, {CLOCK_FREE, 11, 0}, {CLOCK_LOCK_STEP, 0, -1}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        proto_message message = set_clock(s.forest, bad[i].mode, bad[i].rate);
        message.as.set_clock.importance = bad[i].importance;
        CHECK(fake_send(s.client, &message));
        fake_expect_error(s.client, PROTO_ERROR_BAD_VALUE);
    }
    run_clock(&s, CLOCK_FREE, 1);
    proto_message query = fake_query(s.forest, 1000000);
    CHECK(fake_send(s.client, &query));
    fake_expect_error(s.client, PROTO_ERROR_BAD_TIME);
    scene_fini(&s);
}

TEST(server_clock_waits_for_the_queries_before_it)
{
    scene s;
    scene_init(&s);
    proto_message query = fake_query(s.forest, 30000);
    CHECK(fake_send(s.client, &query));
    CHECK_INT(run_clock(&s, CLOCK_FREE, 1).time_us, 30000);
    run_due(&s);
    CHECK_INT(fake_expect(s.client, PROTO_FRAME)->as.frame.time_us, 30000);
    pass(&s, 300000);
    CHECK(of(&s)->state_us >= 200000);
    scene_fini(&s);
}

TEST(server_clock_gives_frames_at_the_rate_asked_for_and_between_steps)
{
    scene s;
    scene_init(&s);
    subscribe(&s, 60, 1000);
    run_clock(&s, CLOCK_FREE, 1);
    int64_t last_us = INT64_MIN, before_us = INT64_MIN;
    int frames = 0, between = 0;
    for (int n = 1; n <= 120; n++) { /* poses at 60 Hz, 40 ms ahead, so that the hair is never at rest */
        const int64_t time_us = n * 1000000 / 60 + 40000;
        move_to(&s, time_us, 0.1 * sin((double)time_us * 6e-6));
        pass(&s, 1000000 / 60);
        frames += take_frames(&s, &last_us);
        between += last_us % AWT_STEP_US != 0 && last_us != before_us;
        before_us = last_us;
    }
    CHECK(frames >= 118 && frames <= 122);
    CHECK(between > 60); /* the frames' own times, not those of steps */
    CHECK(of(&s)->state_us - last_us < AWT_STEP_US);
    scene_fini(&s);
}

TEST(server_clock_draws_nothing_where_nobody_looks)
{
    scene s;
    scene_init(&s);
    run_clock(&s, CLOCK_FREE, 1);
    const uint64_t encoded = s.shared.counters.frames_encoded, steps = s.shared.counters.steps;
    pass(&s, 2000000);
    CHECK_U64(s.shared.counters.frames_encoded, encoded);
    CHECK(s.shared.counters.steps - steps >= 100);
    subscribe(&s, 50, 0); /* a viewer without credit does not look */
    pass(&s, 1000000);
    CHECK_U64(s.shared.counters.frames_encoded, encoded);
    proto_message latest = fake_query(s.forest, 0);
    latest.as.query.latest = 1;
    CHECK(fake_send(s.client, &latest));
    run_due(&s);
    CHECK_INT(fake_expect(s.client, PROTO_FRAME)->as.frame.time_us, 3000000); /* of now, not of the last turn */
    scene_fini(&s);
}

TEST(server_clock_lets_a_forest_at_rest_be_and_a_motion_wakes_it)
{
    scene s;
    scene_init(&s);
    subscribe(&s, 100, UINT32_MAX);
    run_clock(&s, CLOCK_FREE, 1);
    int64_t last_us = INT64_MIN;
    while (!of(&s)->asleep && fake_now_us < 600000000) {
        pass(&s, 100000);
        take_frames(&s, &last_us);
    }
    CHECK(of(&s)->asleep);
    pass(&s, 1000000);
    CHECK(take_frames(&s, &last_us) <= 5);
    move_to(&s, last_us + 400000, 0.2);
    pass(&s, 300000);
    CHECK(take_frames(&s, &last_us) >= 20);
    scene_fini(&s);
}

TEST(server_clock_drops_time_that_the_machine_cannot_keep_up_with)
{
    scene s;
    scene_init(&s);
    subscribe(&s, 50, 1000);
    run_clock(&s, CLOCK_FREE, 1);
    pass(&s, 100000);
    int64_t last_us = INT64_MIN;
    take_frames(&s, &last_us);
    const uint64_t steps = s.shared.counters.steps;
    fake_now_us += 300000; /* no worker came */
    run_due(&s);
    CHECK(s.shared.counters.dropped_us >= 250000 && s.shared.counters.dropped_us <= 300000);
    CHECK(s.shared.counters.steps - steps <= 5);
    take_frames(&s, &last_us);
    CHECK(last_us >= 370000); /* the forest is where its clock is */
    CHECK(s.shared.counters.deadlines_missed > 0);
    scene_fini(&s);
}

TEST(server_clock_queue_of_a_paused_forest_keeps_the_newest_motions)
{
    scene s;
    scene_init(&s);
    run_clock(&s, CLOCK_PAUSED, 0);
    for (int n = 1; n <= 2 * LIMIT_FOREST_INPUTS; n++) {
        move_to(&s, n * 1000, n);
    }
    CHECK(fake_receive(s.client) == NULL);
    CHECK_INT(of(&s)->waiting_inputs, LIMIT_FOREST_INPUTS);
    CHECK(of(&s)->waiting->as.motion.time_us == (LIMIT_FOREST_INPUTS + 1) * 1000);
    scene_fini(&s);
}

/* ---- even motion ------------------------------------------------------------------------------------------------- */

/* Head poses of a smooth sway, one each 1/60 s, stamped with the forest's time at which they are sent, and arriving
 * so much later. Returns the greatest change of the head's velocity from one step to the next, m/s. */
static double sway_roughness(const int64_t *arrives_late_us, int count)
{
    scene s;
    scene_init(&s);
    run_clock(&s, CLOCK_FREE, 1);
    subscribe(&s, 100, UINT32_MAX);
    const int64_t begin_us = fake_now_us;
    double x[3] = {0}, roughness = 0;
    for (int64_t n = 0, seen_us = 0, at_us = 0; at_us < 3000000; at_us += 1000) {
        int64_t sent_us = n * 1000000 / 60;
        while (sent_us + arrives_late_us[n % count] <= at_us) {
            move_to(&s, sent_us + 1, 0.1 * (1 - cos((double)sent_us * 5e-6)));
            sent_us = ++n * 1000000 / 60;
        }
        pass(&s, begin_us + at_us + 1000 - fake_now_us);
        if (of(&s)->state_us > seen_us) {
            seen_us = of(&s)->state_us;
            x[0] = x[1], x[1] = x[2];
            x[2] = awt_forest_head(of(&s)->work.forest).position[0];
            const double change = fabs(x[2] - 2 * x[1] + x[0]) / 0.01;
            roughness = at_us > 500000 && change > roughness ? change : roughness;
        }
    }
    for (int64_t last_us = INT64_MIN; s.client->count > s.client->next;) {
        take_frames(&s, &last_us);
    }
    scene_fini(&s);
    return roughness;
}

TEST(server_clock_uneven_arrivals_give_even_motion)
{
    const int64_t even[] = {0}, uneven[] = {0, 21000, 3000, 14000, 30000, 7000, 1000};
    const double smooth = sway_roughness(even, 1), rough = sway_roughness(uneven, 7);
    CHECK(smooth > 0 && smooth < 0.1);
    CHECK(rough <= smooth * 1.05);
}

/* ---- determinism ------------------------------------------------------------------------------------------------- */

typedef struct tape {
    unsigned char *bytes;
    size_t size;
} tape;

static void tape_write(void *context, const void *bytes, size_t size)
{
    tape *t = context;
    t->bytes = realloc(t->bytes, t->size + size);
    CHECK(t->bytes != NULL);
    memcpy(t->bytes + t->size, bytes, size);
    t->size += size;
}

TEST(server_clock_recorded_inputs_give_the_same_bits_again)
{
    scene s;
    tape written = {0};
    scene_init(&s);
    subscribe(&s, 60, UINT32_MAX);
    resident *r = registry_find(&s.shared.forests, s.forest);
    awt_recorder recorder = {r->work.forest, tape_write, &written};
    CHECK_INT(awt_recorder_begin(&recorder, NULL), AWT_OK);
    r->work.recorder = &recorder;
    run_clock(&s, CLOCK_FREE, 1);
    int64_t last_us = INT64_MIN;
    for (int n = 1; n <= 60; n++) {
        move_to(&s, n * 1000000 / 60, 0.1 * sin(n * 0.2));
        pass(&s, 1000000 / 60 + n % 7 * 3000);
        if (n == 20 || n == 40) {
            fake_now_us += 200000; /* the machine was busy elsewhere */
            run_due(&s);
        }
        take_frames(&s, &last_us);
    }
    CHECK(s.shared.counters.dropped_us > 0);
    const uint64_t hash = awt_forest_hash(r->work.forest);
    awt_replay *replay = NULL;
    awt_error error = {0};
    bool more = true;
    CHECK_INT(awt_replay_create(written.bytes, written.size, &replay, &error), AWT_OK);
    while (more && awt_replay_next(replay, &more, &error) == AWT_OK) {
    }
    CHECK_TEXT(error.text, "");
    CHECK(awt_replay_steps(replay) > 50);
    CHECK_U64(awt_forest_hash(awt_replay_forest(replay)), hash);
    awt_replay_destroy(replay);
    free(written.bytes);
    scene_fini(&s);
}
