/* viewers_fixture.c: see viewers_fixture.h. */
#include "viewers_fixture.h"
#include "check.h"
#include "completions.h"

#include "geom/encode.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How far strands evaluated from guides may be from the server's. */
#define VIEWERS_GUIDES_M 0.0002

typedef struct viewers_link {
    viewers *all;
    fake_client *client;
    uint32_t first; /* viewer; its requests carry the viewer's number plus 1 */
} viewers_link;

/* ---- what comes -------------------------------------------------------------------------------------------------- */

static void link_message(void *context, const proto_message *message)
{
    viewers_link *l = context;
    if (message->type == PROTO_SUBSCRIBE_REPLY) {
        l->all->each[message->request - 1].handle = message->as.subscribe_reply.subscription;
    } else if (message->type == PROTO_ERROR) {
        l->all->error = message->as.error.code;
    }
}

/* Greatest distance along an axis. */
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

static void decode(viewers *v, viewer *w, const struct proto_frame *frame)
{
    awt_error error = {0};
    const geom_strands *shown = NULL;
    CHECK_INT(framering_take(w->ring, frame, v->binding, &shown, &error), AWT_OK);
    CHECK_TEXT(error.text, "");
    w->whole += frame->base == 0;
    w->deltas += frame->base != 0;
    w->fresh = true;
    const geom_strands *truth = &v->truth[frame->sequence % VIEWERS_FRAMES];
    if (truth->positions && shown && frame->level == 0) {
        const double bound_m = frame->kind == GEOM_GUIDES ? VIEWERS_GUIDES_M + v->truth_step_m / 2 : 0;
        CHECK_INT(truth->time_us, shown->time_us);
        CHECK(distance(truth, shown) <= bound_m);
    }
}

static void link_picture(void *context, picture *shown, const view *which, const delivery *to)
{
    viewers_link *l = context;
    viewer *w = &l->all->each[to->request - 1];
    proto_message message;
    picture_message(shown, which, to, &message);
    const struct proto_frame *frame = &message.as.frame;
    CHECK(frame->sequence > w->last);
    w->last = frame->sequence;
    w->frame = *frame;
    w->frame.glb.bytes = NULL;
    w->bytes += frame->glb.length;
    w->largest = frame->glb.length > w->largest ? frame->glb.length : w->largest;
    decode(l->all, w, frame);
    picture_release(shown);
}

static bool link_drained(void *context)
{
    (void)context;
    return true;
}

/* ---- life -------------------------------------------------------------------------------------------------------- */

static void link_init(viewers *v, viewers_link *l, const struct proto_create_reply *made)
{
    proto_message attach = {.type = PROTO_ATTACH};
    attach.as.attach.forest = v->forest;
    memcpy(attach.as.attach.token, made->view_token, sizeof attach.as.attach.token);
    l->all = v;
    l->client = fake_client_open(&v->shared);
    CHECK(fake_send(l->client, &attach));
    fake_expect(l->client, PROTO_ATTACH_REPLY);
    l->client->talk.sink =
        (session_sink){.context = l, .message = link_message, .picture = link_picture, .drained = link_drained};
}

static geom_binding *get_binding(viewers *v)
{
    proto_message message = {.type = PROTO_BINDING, .request = 1};
    geom_binding *binding = NULL;
    message.as.binding.forest = v->forest;
    CHECK(fake_send(v->driver, &message));
    fake_work(&v->shared, v->driver);
    const proto_blob *bytes = &fake_expect(v->driver, PROTO_BINDING_REPLY)->as.binding_reply.binding;
    CHECK_INT(geom_binding_read(bytes->bytes, bytes->length, &binding, NULL), AWT_OK);
    return binding;
}

void viewers_init(viewers *v, uint32_t count, const struct proto_subscribe *asked)
{
    *v = (viewers){.count = count,
                   .link_count = (count + LIMIT_SESSION_SUBSCRIPTIONS - 1) / LIMIT_SESSION_SUBSCRIPTIONS};
    v->each = calloc(count, sizeof *v->each);
    v->links = calloc(v->link_count, sizeof *v->links);
    CHECK(v->each && v->links && fake_service_init(&v->shared, 0, 4, false));
    v->driver = fake_client_open(&v->shared);
    proto_message create = fake_create(1);
    create.as.create.strands = 400; /* so that a fifth of them are more than the finest wisps */
    CHECK(fake_send(v->driver, &create));
    fake_work(&v->shared, v->driver);
    const struct proto_create_reply made = fake_expect(v->driver, PROTO_CREATE_REPLY)->as.create_reply;
    v->forest = made.forest;
    v->truth_step_m = (double)(made.box_max_x - made.box_min_x) / ((1 << GEOM_STRANDS_BITS) - 1);
    if (asked->kind == GEOM_GUIDES) {
        v->binding = get_binding(v);
    }
    for (uint32_t i = 0; i < count; i++) {
        viewers_link *l = &v->links[i / LIMIT_SESSION_SUBSCRIPTIONS];
        if (!l->client) {
            link_init(v, l, &made);
        }
        proto_message message = {.type = PROTO_SUBSCRIBE, .request = i + 1};
        message.as.subscribe = *asked;
        message.as.subscribe.forest = v->forest;
        message.as.subscribe.credit = 1;
        v->each[i].ring = framering_create();
        CHECK(fake_send(l->client, &message));
        CHECK(v->each[i].ring && v->each[i].handle != 0);
    }
}

void viewers_fini(viewers *v)
{
    for (uint32_t i = 0; i < v->link_count; i++) {
        fake_client_destroy(v->links[i].client);
    }
    for (uint32_t i = 0; i < v->count; i++) {
        framering_destroy(v->each[i].ring);
    }
    for (int i = 0; i < VIEWERS_FRAMES; i++) {
        geom_strands_fini(&v->truth[i]);
    }
    fake_client_destroy(v->driver);
    service_fini(&v->shared);
    geom_binding_destroy(v->binding);
    free(v->each);
    free(v->links);
}

/* ---- what is done ------------------------------------------------------------------------------------------------ */

void viewers_advance(viewers *v, bool moves)
{
    v->time_us += 10000;
    if (moves) {
        proto_message motion = fake_motion(v->forest, ++v->sequence, v->time_us);
        CHECK(fake_send(v->driver, &motion));
    }
    proto_message query = fake_query(v->forest, v->time_us);
    query.as.query.kind = GEOM_STRANDS;
    CHECK(fake_send(v->driver, &query));
    CHECK(worker_pool_run_one(v->shared.pool));
    /* the truth first, so that what viewers get can be compared with it: the picture is the job's until it is taken */
    const resident *r = registry_find(&v->shared.forests, v->forest);
    const picture *drawn = r->work.drawn;
    const view *whole = drawn ? picture_view(drawn, (view_name){.form = form_find(GEOM_STRANDS, 0, 0)}) : NULL;
    CHECK(whole != NULL);
    if (whole) {
        geom_strands *truth = &v->truth[drawn->figures.sequence % VIEWERS_FRAMES];
        geom_strands_fini(truth);
        *truth = (geom_strands){0};
        CHECK_INT(geom_read_frame(whole->glb.bytes, whole->glb.size, truth, NULL), AWT_OK);
    }
    completions_take(&v->shared);
    fake_work(&v->shared, v->driver); /* what is drawn again */
    fake_expect(v->driver, PROTO_FRAME);
}

void viewers_credit(viewers *v, uint32_t number, uint32_t frames, uint64_t have)
{
    proto_message message = {.type = PROTO_CREDIT, .request = number + 1};
    message.as.credit.subscription = v->each[number].handle;
    message.as.credit.frames = frames;
    message.as.credit.have = have;
    CHECK(fake_send(v->links[number / LIMIT_SESSION_SUBSCRIPTIONS].client, &message));
}

void viewers_acknowledge(viewers *v, uint32_t number)
{
    viewer *w = &v->each[number];
    if (!w->fresh) {
        return;
    }
    w->fresh = false;
    w->had = w->last;
    viewers_credit(v, number, 1, w->last);
}
