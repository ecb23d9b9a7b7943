/* viewers_fixture.c: see viewers_fixture.h. */
#include "viewers_fixture.h"
#include "check.h"
#include "completions.h"

#include <stdlib.h>
#include <string.h>

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

static const geom_strands *find_kept(const viewer *w, uint64_t sequence)
{
    for (int i = 0; i < LIMIT_DELTA_BASES; i++) {
        if (w->kept[i].sequence == sequence) {
            return &w->kept[i].strands;
        }
    }
    return NULL;
}

static void decode(viewers *v, viewer *w, const struct proto_frame *frame)
{
    awt_error error = {0};
    const geom_strands *base = frame->base ? find_kept(w, frame->base) : NULL;
    CHECK(frame->base == 0 || base);
    if (frame->base == 0) {
        geom_strands_fini(&w->shown);
        w->shown = (geom_strands){0};
        CHECK_INT(geom_read_frame(frame->glb.bytes, frame->glb.length, &w->shown, &error), AWT_OK);
        w->whole++;
    } else if (base) {
        CHECK_INT(geom_read_delta(v->reader, frame->glb.bytes, frame->glb.length, base, frame->base, &w->shown, &error),
                  AWT_OK);
        w->deltas++;
    }
    CHECK_TEXT(error.text, "");
    w->fresh = true;
    const geom_strands *truth = &v->truth[frame->sequence % VIEWERS_FRAMES];
    if (truth->positions && w->shown.positions && frame->level == 0) {
        const size_t size = (size_t)truth->strand_count * truth->points_per_strand * 3 * sizeof(float);
        CHECK_INT(truth->time_us, w->shown.time_us);
        CHECK(memcmp(truth->positions, w->shown.positions, size) == 0);
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
    if (frame->kind == GEOM_STRANDS) {
        decode(l->all, w, frame);
    } else {
        w->other++;
    }
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

void viewers_init(viewers *v, uint32_t count, const struct proto_subscribe *asked)
{
    *v = (viewers){.count = count,
                   .link_count = (count + LIMIT_SESSION_SUBSCRIPTIONS - 1) / LIMIT_SESSION_SUBSCRIPTIONS};
    v->each = calloc(count, sizeof *v->each);
    v->links = calloc(v->link_count, sizeof *v->links);
    CHECK(v->each && v->links && fake_service_init(&v->shared, 0, 4, false));
    CHECK_INT(geom_delta_reader_create(&v->reader, NULL), AWT_OK);
    v->driver = fake_client_open(&v->shared);
    proto_message create = fake_create(1);
    create.as.create.strands = 400; /* so that a fifth of them are more than the finest wisps */
    CHECK(fake_send(v->driver, &create));
    fake_work(&v->shared, v->driver);
    const struct proto_create_reply made = fake_expect(v->driver, PROTO_CREATE_REPLY)->as.create_reply;
    v->forest = made.forest;
    for (uint32_t i = 0; i < count; i++) {
        viewers_link *l = &v->links[i / LIMIT_SESSION_SUBSCRIPTIONS];
        if (!l->client) {
            link_init(v, l, &made);
        }
        proto_message message = {.type = PROTO_SUBSCRIBE, .request = i + 1};
        message.as.subscribe = *asked;
        message.as.subscribe.forest = v->forest;
        message.as.subscribe.credit = 1;
        CHECK(fake_send(l->client, &message));
        CHECK(v->each[i].handle != 0);
    }
}

void viewers_fini(viewers *v)
{
    for (uint32_t i = 0; i < v->link_count; i++) {
        fake_client_destroy(v->links[i].client);
    }
    for (uint32_t i = 0; i < v->count; i++) {
        geom_strands_fini(&v->each[i].shown);
        for (int k = 0; k < LIMIT_DELTA_BASES; k++) {
            geom_strands_fini(&v->each[i].kept[k].strands);
        }
    }
    for (int i = 0; i < VIEWERS_FRAMES; i++) {
        geom_strands_fini(&v->truth[i]);
    }
    fake_client_destroy(v->driver);
    service_fini(&v->shared);
    geom_delta_reader_destroy(v->reader);
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
    const view *whole = drawn ? picture_view(drawn, (view_name){.form = form_find(GEOM_STRANDS, 0)}) : NULL;
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
    const size_t positions = (size_t)w->shown.strand_count * w->shown.points_per_strand * 3;
    geom_strands *place = &w->kept[w->oldest].strands;
    const bool fits = place->positions && place->strand_count == w->shown.strand_count;
    if (!fits) {
        geom_strands_fini(place);
    }
    float *points = fits ? place->positions : malloc(positions * sizeof(float));
    float *widths = fits ? place->widths : malloc(w->shown.points_per_strand * sizeof(float));
    CHECK(points && widths);
    memcpy(points, w->shown.positions, positions * sizeof(float));
    memcpy(widths, w->shown.widths, w->shown.points_per_strand * sizeof(float));
    *place = w->shown;
    place->positions = points;
    place->widths = widths;
    w->kept[w->oldest].sequence = w->last;
    w->oldest = (w->oldest + 1) % LIMIT_DELTA_BASES;
    w->fresh = false;
    w->had = w->last;
    viewers_credit(v, number, 1, w->last);
}
