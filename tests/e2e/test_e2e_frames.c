/* test_e2e_frames.c: what a client decodes is what core computes for the same inputs; and the same bits whoever works.
 */
#include "check.h"
#include "e2e/daemon.h"
#include "unit/fixture.h"

#include "base/hash.h"
#include "geom/read.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { STRANDS = 1000, FRAMES = 150, COMPARED_EVERY = 10 };
static const double zero[3] = {0, 0, 0};

static int64_t frame_time(int n)
{
    return INT64_C(1000000) + (int64_t)n * 1000000 / 60;
}

static proto_pose wire_pose(const awt_pose *pose)
{
    proto_pose wire;
    memcpy(wire.position, pose->position, sizeof wire.position);
    memcpy(wire.orientation, pose->orientation, sizeof wire.orientation);
    return wire;
}

/* CREATE of a style with seed 1 at the clip's start. 0 after a failed check. */
static uint64_t create_style(awtclient *client, const char *style, proto_message *answer)
{
    awt_motion start = fixture_motion(fixture_clip("jump"), frame_time(0), zero, zero);
    proto_message request = {.type = PROTO_CREATE};
    request.as.create.style = request.as.create.name = proto_str_of(style);
    request.as.create.seed = 1;
    request.as.create.strands = STRANDS;
    request.as.create.time_us = start.time_us;
    request.as.create.head = wire_pose(&start.head);
    request.as.create.body = wire_pose(&start.body);
    awtclient_error error = {0};
    bool made = awtclient_call(client, &request, answer, &error);
    CHECK_TEXT(error.text, "");
    return made ? answer->as.create_reply.forest : 0;
}

/* MOTION and QUERY of frame n. */
static bool play_frame(awtclient *client, uint64_t forest, int n, proto_message *frame)
{
    awt_motion m = fixture_motion(fixture_clip("jump"), frame_time(n), zero, zero);
    proto_message pose = {.type = PROTO_MOTION}, query = {.type = PROTO_QUERY};
    pose.as.motion.forest = query.as.query.forest = forest;
    pose.as.motion.sequence = (uint32_t)n;
    pose.as.motion.time_us = query.as.query.time_us = m.time_us;
    pose.as.motion.head = wire_pose(&m.head);
    pose.as.motion.body = wire_pose(&m.body);
    awtclient_error error = {0};
    bool played = awtclient_send(client, &pose, &error) && awtclient_call(client, &query, frame, &error);
    CHECK_TEXT(error.text, "");
    return played;
}

/* The same head of hair in core alone. */
static awt_forest *local_forest(const char *style)
{
    const awt_groom *groom = fixture_groom(style, STRANDS);
    awt_forest_def def = awt_forest_def_default(groom);
    def.params = awt_style_find(style)->params;
    def.start = fixture_motion(fixture_clip("jump"), frame_time(0), zero, zero);
    awt_forest *forest = NULL;
    CHECK_INT(awt_forest_create(groom, &def, &forest, NULL), AWT_OK);
    return forest;
}

/* Greatest distance along an axis between a frame's centre lines and the forest's strands. */
static double frame_error(const proto_message *frame, const awt_forest *forest)
{
    const awt_groom *groom = awt_forest_groom(forest);
    awt_groom_info info;
    awt_groom_get_info(groom, &info);
    geom_strands seen;
    awt_error error = {0};
    if (geom_read_frame(frame->as.frame.glb.bytes, frame->as.frame.glb.length, &seen, &error) != AWT_OK) {
        CHECK_TEXT(error.text, "");
        return INFINITY;
    }
    CHECK_INT(seen.strand_count, info.strand_count);
    CHECK_INT(seen.points_per_strand, info.points_per_strand);
    CHECK_INT(seen.time_us, awt_forest_time(forest));
    awt_pose head = awt_forest_head(forest);
    for (int axis = 0; axis < 3; axis++) {
        CHECK_NEAR(seen.head.position[axis], head.position[axis], 1e-12);
    }
    size_t count = 3 * (size_t)info.strand_count * info.points_per_strand;
    float *centres = malloc((size_t)info.finest_nodes * 3 * sizeof(float)),
          *frames = malloc((size_t)info.finest_nodes * 4 * sizeof(float));
    float *scratch = malloc(awt_groom_strand_scratch(groom) * sizeof(float)), *points = malloc(count * sizeof(float));
    awt_forest_guides(forest, centres, frames);
    awt_groom_strands(groom, centres, frames, scratch, points);
    double worst = 0;
    for (size_t k = 0; k < count; k++) {
        double error_m = fabs((double)seen.positions[k] - (double)points[k]);
        worst = error_m > worst ? error_m : worst;
    }
    free(centres), free(frames), free(scratch), free(points);
    geom_strands_fini(&seen);
    return worst;
}

static double quantisation_step(const proto_message *created)
{
    const struct proto_create_reply *r = &created->as.create_reply;
    double x = (double)r->box_max_x - (double)r->box_min_x, y = (double)r->box_max_y - (double)r->box_min_y;
    double z = (double)r->box_max_z - (double)r->box_min_z;
    double largest = x > y ? (x > z ? x : z) : (y > z ? y : z);
    return largest / 16383.0;
}

TEST(e2e_decoded_frames_are_what_core_computes_for_the_same_inputs)
{
    daemon_process daemon;
    CHECK(daemon_start(&daemon, 2, NULL));
    for (size_t s = 0; s < awt_style_count(); s++) {
        const char *style = awt_style_at(s)->name;
        awtclient *client = daemon_client(&daemon);
        proto_message answer;
        uint64_t handle = client ? create_style(client, style, &answer) : 0;
        awt_forest *forest = handle ? local_forest(style) : NULL;
        if (forest) {
            double step = quantisation_step(&answer);
            uint32_t splits = 0;
            for (int n = 1; n <= check_rounds(FRAMES); n++) {
                awt_step_stats stats;
                fixture_advance(forest, fixture_clip("jump"), frame_time(n), zero, zero, &stats);
                proto_message frame;
                if (!play_frame(client, handle, n, &frame)) {
                    break;
                }
                splits += frame.as.frame.splits;
                CHECK_INT(frame.as.frame.active_nodes, stats.active_nodes);
                CHECK_INT(frame.as.frame.splits, stats.splits);
                CHECK_INT(frame.as.frame.clamped_points, 0);
                if (n % COMPARED_EVERY == 0) {
                    CHECK(frame_error(&frame, forest) <= step);
                }
            }
            CHECK(splits > 0);
            awt_forest_destroy(forest);
        }
        awtclient_close(client);
    }
    CHECK_INT(daemon_stop(&daemon), 0);
}

/* ---- the same bits ------------------------------------------------------------------------------------------ */

typedef struct player {
    const daemon_process *daemon;
    const char *style;
    uint64_t hash; /* of every frame's GLB */
} player;

static void *play(void *context)
{
    player *p = context;
    awtclient *client = daemon_client(p->daemon);
    proto_message message;
    uint64_t handle = client ? create_style(client, p->style, &message) : 0;
    p->hash = HASH_SEED;
    for (int n = 1; handle && n <= FRAMES / 2 && play_frame(client, handle, n, &message); n++) {
        const proto_blob *glb = &message.as.frame.glb;
        p->hash = hash_words(hash_u64(p->hash, glb->length), glb->bytes, glb->length / 4);
    }
    awtclient_close(client);
    return NULL;
}

static void play_both(int workers, uint64_t hashes[2])
{
    daemon_process daemon;
    CHECK(daemon_start(&daemon, workers, NULL));
    player players[2] = {{&daemon, "long", 0}, {&daemon, "short-curly", 0}};
    pthread_t threads[2];
    for (int k = 0; k < 2; k++) {
        CHECK_INT(pthread_create(&threads[k], NULL, play, &players[k]), 0);
    }
    for (int k = 0; k < 2; k++) {
        pthread_join(threads[k], NULL);
        hashes[k] = players[k].hash;
    }
    CHECK_INT(daemon_stop(&daemon), 0);
}

TEST(e2e_two_clients_at_once_get_the_same_bytes_from_one_worker_and_from_two)
{
    uint64_t one[2], two[2];
    fixture_clip("jump"); /* made before the threads share it */
    play_both(1, one);
    play_both(2, two);
    CHECK_U64(two[0], one[0]);
    CHECK_U64(two[1], one[1]);
    CHECK(one[0] != one[1]);
}

TEST(e2e_a_subscriber_gets_the_frames_its_credit_allows_and_counts_the_rest)
{
    daemon_process daemon;
    CHECK(daemon_start(&daemon, 1, NULL));
    awtclient *driver = daemon_client(&daemon), *viewer = daemon_client(&daemon);
    proto_message answer, message = {.type = PROTO_ATTACH};
    awtclient_error error = {0};
    uint64_t handle = create_style(driver, "short", &answer);
    message.as.attach.forest = handle;
    memcpy(message.as.attach.token, answer.as.create_reply.view_token, sizeof message.as.attach.token);
    CHECK(awtclient_call(viewer, &message, &answer, &error));
    CHECK_INT(answer.as.attach_reply.may_drive, 0);
    message = (proto_message){.type = PROTO_SUBSCRIBE};
    message.as.subscribe.forest = handle;
    message.as.subscribe.credit = 2;
    CHECK(awtclient_call(viewer, &message, &answer, &error));
    uint64_t subscription = answer.as.subscribe_reply.subscription, subscribed = message.request;
    for (int n = 1; n <= 6; n++) {
        proto_message frame;
        CHECK(play_frame(driver, handle, n, &frame));
    }
    /* two frames by credit; then one credit more: the latest, with what was left out counted */
    uint64_t last = 0, received = 0, skipped = 0;
    for (int n = 0; n < 3; n++) {
        if (n == 2) {
            message = (proto_message){.type = PROTO_CREDIT};
            message.as.credit.subscription = subscription;
            message.as.credit.frames = 1;
            message.as.credit.have = last;
            CHECK(awtclient_send(viewer, &message, &error));
        }
        proto_message frame;
        if (!awtclient_receive(viewer, &frame, &error)) {
            CHECK_TEXT(error.text, "");
            break;
        }
        CHECK_INT(frame.type, PROTO_FRAME);
        CHECK_U64(frame.request, subscribed);
        CHECK(frame.as.frame.sequence > last);
        last = frame.as.frame.sequence;
        skipped += frame.as.frame.skipped;
        received++;
    }
    CHECK_INT(received, 3);
    CHECK(skipped > 0);
    /* a viewer may look, not drive */
    message = (proto_message){.type = PROTO_DESTROY};
    message.as.destroy.forest = handle;
    CHECK(!awtclient_call(viewer, &message, &answer, &error));
    CHECK_INT(error.code, PROTO_ERROR_NOT_ALLOWED);
    awtclient_close(driver);
    awtclient_close(viewer);
    CHECK_INT(daemon_stop(&daemon), 0);
}
