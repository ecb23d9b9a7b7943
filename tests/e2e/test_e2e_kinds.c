/* test_e2e_kinds.c: every kind of frame through the daemon, by the client library and by awtctl: what a viewer makes of
 * each is the hair that the driver sees. */
#include "check.h"
#include "e2e/daemon.h"
#include "framering.h"
#include "geom/encode.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { KINDS = 4, STEPS = 40 };

typedef struct watched {
    uint64_t request, subscription;
    framering *ring;
    uint32_t frames, deltas;
    uint64_t bytes;
} watched;

typedef struct viewing {
    awtclient *client;
    geom_binding *binding;
    double step_m; /* of the strands' quantisation */
    watched kinds[KINDS];
} viewing;

static uint64_t create(awtclient *client, struct proto_create_reply *made)
{
    awtclient_error error = {0};
    proto_message request = {.type = PROTO_CREATE}, answer;
    request.as.create.style = proto_str_of("long-curly");
    request.as.create.seed = 1;
    request.as.create.strands = 1000;
    request.as.create.head.orientation[3] = request.as.create.body.orientation[3] = 1;
    bool created = awtclient_call(client, &request, &answer, &error);
    CHECK_TEXT(error.text, "");
    *made = answer.as.create_reply;
    return created ? made->forest : 0;
}

static void view_begin(viewing *v, const struct proto_create_reply *made)
{
    awtclient_error error = {0};
    proto_message request = {.type = PROTO_ATTACH}, answer;
    request.as.attach.forest = made->forest;
    memcpy(request.as.attach.token, made->view_token, sizeof request.as.attach.token);
    CHECK(awtclient_call(v->client, &request, &answer, &error));
    request = (proto_message){.type = PROTO_BINDING};
    request.as.binding.forest = made->forest;
    CHECK(awtclient_call(v->client, &request, &answer, &error));
    const proto_blob *bytes = &answer.as.binding_reply.binding;
    CHECK_INT(geom_binding_read(bytes->bytes, bytes->length, &v->binding, NULL), AWT_OK);
    v->step_m = (double)(made->box_max_x - made->box_min_x) / ((1 << GEOM_STRANDS_BITS) - 1);
    for (uint8_t kind = 0; kind < KINDS; kind++) {
        request = (proto_message){.type = PROTO_SUBSCRIBE};
        request.as.subscribe = (struct proto_subscribe){.forest = made->forest, .kind = kind, .credit = 1, .deltas = 1};
        CHECK(awtclient_call(v->client, &request, &answer, &error));
        v->kinds[kind] = (watched){.request = request.request,
                                   .subscription = answer.as.subscribe_reply.subscription,
                                   .ring = framering_create()};
    }
    CHECK_TEXT(error.text, "");
}

static void view_end(viewing *v)
{
    for (int kind = 0; kind < KINDS; kind++) {
        framering_destroy(v->kinds[kind].ring);
    }
    geom_binding_destroy(v->binding);
    awtclient_close(v->client);
}

/* Moves the head along a bend, and takes the whole strands of the time. */
static bool drive(awtclient *driver, uint64_t forest, int step, geom_strands *truth, struct proto_frame *frame)
{
    awtclient_error error = {0};
    proto_message motion = {.type = PROTO_MOTION}, query = {.type = PROTO_QUERY}, answer;
    struct proto_motion *m = &motion.as.motion;
    m->forest = query.as.query.forest = forest;
    m->sequence = (uint32_t)step;
    m->time_us = query.as.query.time_us = (int64_t)step * 16667;
    m->head.position[0] = 0.002 * step * step;
    m->head.orientation[3] = m->body.orientation[3] = 1;
    query.as.query.kind = GEOM_STRANDS;
    bool good = awtclient_send(driver, &motion, &error) && awtclient_call(driver, &query, &answer, &error);
    CHECK_TEXT(error.text, "");
    if (good) {
        *frame = answer.as.frame;
        CHECK_INT(geom_read_frame(frame->glb.bytes, frame->glb.length, truth, NULL), AWT_OK);
    }
    return good;
}

/* Greatest distance along an axis; infinite where the shapes differ. */
static double distance(const geom_strands *a, const geom_strands *b)
{
    double greatest = 0;
    if (a->strand_count != b->strand_count || a->points_per_strand != b->points_per_strand) {
        return INFINITY;
    }
    for (size_t i = 0; i < (size_t)a->strand_count * a->points_per_strand * 3; i++) {
        greatest = fmax(greatest, fabs((double)a->positions[i] - (double)b->positions[i]));
    }
    return greatest;
}

/* Guides: the bound of GEOMETRY.md, and the rounding of the strands that they are compared with. */
static double bound_m(uint8_t kind, double step_m)
{
    return kind == GEOM_STRANDS ? 0 : kind == GEOM_GUIDES ? 0.0002 + step_m / 2 : 0.0005;
}

static void check_frame(viewing *v, watched *w, const struct proto_frame *frame, const geom_strands *truth,
                        const struct proto_frame *driven)
{
    awt_error error = {0};
    CHECK_U64(frame->sequence, driven->sequence);
    CHECK_INT(frame->time_us, driven->time_us);
    w->frames++;
    w->deltas += frame->base != 0;
    w->bytes += frame->glb.length;
    if (frame->kind == GEOM_NODES) {
        geom_nodes nodes = {0};
        CHECK_INT(geom_read_nodes(frame->glb.bytes, frame->glb.length, &nodes, &error), AWT_OK);
        CHECK_INT(nodes.count, driven->active_nodes);
        geom_nodes_fini(&nodes);
        return;
    }
    const geom_strands *seen = NULL;
    CHECK_INT(framering_take(w->ring, frame, v->binding, &seen, &error), AWT_OK);
    CHECK_TEXT(error.text, "");
    const double off_m = seen ? distance(seen, truth) : INFINITY;
    CHECK(off_m <= bound_m(frame->kind, v->step_m));
}

/* One frame of each kind, in whatever order they come, and credit for the next. */
static void watch(viewing *v, const geom_strands *truth, const struct proto_frame *driven)
{
    awtclient_error error = {0};
    for (int n = 0; n < KINDS; n++) {
        proto_message message;
        if (!awtclient_receive(v->client, &message, &error)) {
            CHECK_TEXT(error.text, "");
            return;
        }
        CHECK_TEXT(proto_type_name(message.type), "FRAME");
        const int kind = message.as.frame.kind < KINDS ? message.as.frame.kind : 0;
        watched *w = &v->kinds[kind];
        CHECK_U64(message.request, w->request);
        check_frame(v, w, &message.as.frame, truth, driven);
    }
    for (int kind = 0; kind < KINDS; kind++) {
        proto_message credit = {.type = PROTO_CREDIT};
        credit.as.credit.subscription = v->kinds[kind].subscription;
        credit.as.credit.frames = 1;
        credit.as.credit.have = framering_newest(v->kinds[kind].ring);
        CHECK(awtclient_send(v->client, &credit, &error));
    }
    /* the answer says that the credits before it have been taken */
    proto_message ping = {.type = PROTO_PING}, answer;
    CHECK(awtclient_call(v->client, &ping, &answer, &error));
}

TEST(e2e_every_kind_shows_a_viewer_the_hair_that_the_driver_sees)
{
    daemon_process daemon;
    CHECK(daemon_start(&daemon, 2, NULL));
    awtclient *driver = daemon_client(&daemon);
    viewing v = {.client = daemon_client(&daemon)};
    struct proto_create_reply made = {0};
    const uint64_t forest = driver && v.client ? create(driver, &made) : 0;
    if (forest) {
        view_begin(&v, &made);
    }
    for (int step = 1; forest && step <= STEPS; step++) {
        geom_strands truth = {0};
        struct proto_frame driven;
        if (!drive(driver, forest, step, &truth, &driven)) {
            break;
        }
        watch(&v, &truth, &driven);
        geom_strands_fini(&truth);
    }
    for (int kind = 0; kind < KINDS; kind++) {
        CHECK_INT(v.kinds[kind].frames, STEPS);
        CHECK_INT(v.kinds[kind].deltas, kind == GEOM_STRANDS || kind == GEOM_GUIDES ? STEPS - 1 : 0);
    }
    CHECK(v.kinds[GEOM_GUIDES].bytes < v.kinds[GEOM_STRANDS].bytes);
    CHECK(v.kinds[GEOM_STRANDS].bytes < v.kinds[GEOM_RIBBON].bytes / 4);
    view_end(&v);
    awtclient_close(driver);
    CHECK_INT(daemon_stop(&daemon), 0);
}

TEST(e2e_awtctl_plays_and_checks_every_kind)
{
    static const char *const kinds[] = {"ribbon",
                                        "strands",
                                        "guides",
                                        "nodes",
                                        "strands --deltas",
                                        "guides --deltas",
                                        "ribbon --attributes --level fifth",
                                        "strands --attributes",
                                        "strands --budget 8000 --motion run"};
    daemon_process daemon;
    CHECK(daemon_start(&daemon, 1, NULL));
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
        char command[1024], line[256];
        bool deltas = false, compared = false;
        snprintf(command, sizeof command,
                 "%s/awtctl play --connect %s --token-file %s --style short --strands 500 --frames 90 --check --quiet "
                 "--kind %s",
                 check_build_directory(), daemon.address, daemon.token_file, kinds[k]);
        FILE *report = popen(command, "r");
        CHECK(report != NULL);
        while (report && fgets(line, sizeof line, report)) {
            deltas = deltas || strstr(line, "89 of the frames were deltas");
            compared = compared || strstr(line, "against the first of 90 decoded frames");
        }
        CHECK_INT(report ? pclose(report) : -1, 0);
        CHECK(deltas == (k == 4 || k == 5));
        CHECK(compared == (k != GEOM_NODES));
    }
    CHECK_INT(daemon_stop(&daemon), 0);
}
