/* completions.c: see completions.h. */
#include "completions.h"
#include "convert.h"
#include "log.h"
#include "session.h"

#include <string.h>

/* ---- CREATE ------------------------------------------------------------------------------------------------------ */

static void fill_groom(struct proto_create_reply *c, const awt_groom_info *info)
{
    c->strands = info->strand_count;
    c->points_per_strand = (uint16_t)info->points_per_strand;
    c->levels = (uint8_t)info->levels;
    c->sections = (uint16_t)info->sections;
    c->top_wisps = info->wisp_count[0];
    c->finest_wisps = info->wisp_count[info->levels - 1];
    c->coarse_nodes = info->coarse_nodes;
    c->finest_nodes = info->finest_nodes;
    _Static_assert(sizeof c->wisp_levels.items / sizeof c->wisp_levels.items[0] == AWT_MAX_LEVELS,
                   "every level of the library has its place");
    c->wisp_levels.count = (uint16_t)info->levels;
    for (uint32_t level = 0; level < info->levels; level++) {
        c->wisp_levels.items[level] = (struct proto_wisp_level){.wisps = info->wisp_count[level],
                                                                .mean_radius_m = (float)info->mean_radius_m[level]};
    }
    c->mass_kg = info->mass_kg;
    c->longest_strand_m = info->longest_strand_m;
    c->median_strand_m = info->median_strand_m;
    c->box_min_x = info->box_min[0];
    c->box_min_y = info->box_min[1];
    c->box_min_z = info->box_min[2];
    c->box_max_x = info->box_max[0];
    c->box_max_y = info->box_max[1];
    c->box_max_z = info->box_max[2];
}

/* What was taken where the client left it open. */
static void fill_taken(struct proto_create_reply *c, const recipe *made)
{
    const awt_placement *p = &made->placement;
    c->guessed = (uint8_t)((p->guessed_scale ? 1 : 0) | (p->guessed_up ? 2 : 0) | (p->guessed_head ? 4 : 0));
    c->scale = p->scale;
    c->up = (uint8_t)p->up;
    c->head_x = p->head_centre[0];
    c->head_y = p->head_centre[1];
    c->head_z = p->head_centre[2];
    c->head_radius = p->head_radius;
    c->head_radius_m = p->head_radius_m;
    c->turned_degrees = p->turned_degrees;
    c->colliders.count = (uint16_t)made->collider_count;
    for (uint32_t i = 0; i < made->collider_count; i++) {
        c->colliders.items[i] = convert_collider_back(&made->colliders[i]);
    }
}

static void reply_created(session *s, const resident *r)
{
    proto_message reply = {.type = PROTO_CREATE_REPLY, .request = r->creator.request};
    struct proto_create_reply *c = &reply.as.create_reply;
    c->forest = r->handle;
    memcpy(c->drive_token, r->drive_token, sizeof c->drive_token);
    memcpy(c->view_token, r->view_token, sizeof c->view_token);
    c->skipped_strands = r->work.skipped_strands;
    c->build_us = r->work.build_us;
    c->rebuilt_max_m = (float)r->work.rebuilt.max_m;
    c->rebuilt_mean_m = (float)r->work.rebuilt.mean_m;
    fill_groom(c, &r->info);
    fill_taken(c, r->work.making);
    session_send(s, &reply);
}

/* A forest that nobody will ever hear of is not kept. False: it is doomed. */
static bool accept_created(service *shared, resident *r, session *asker)
{
    char quoted[LOG_QUOTED];
    log_quote(r->name, strlen(r->name), quoted);
    if (!r->work.frame) {
        char why[LOG_QUOTED];
        log_write(LOG_INFO, "forest not made", "name=%s why=%s", quoted,
                  log_quote(r->work.error.text, strlen(r->work.error.text), why));
        if (asker) {
            session_error_awt(asker, PROTO_CREATE, r->creator.request, &r->work.error);
        }
    } else if (!asker || asker->state == SESSION_CLOSING) {
        log_write(LOG_INFO, "forest not kept", "name=%s why=\"its maker is gone\"", quoted);
    } else if (!session_attach(asker, r->handle, true)) {
        session_error(asker, PROTO_CREATE, r->creator.request, PROTO_ERROR_LIMIT,
                      "a connection has %d forests open at most; DETACH from one", LIMIT_SESSION_FORESTS);
    } else {
        log_write(LOG_INFO, "forest created", "peer=%s name=%s strands=%lu nodes=%lu build_us=%lu", asker->peer, quoted,
                  (unsigned long)r->work.info.strand_count, (unsigned long)r->work.info.finest_nodes,
                  (unsigned long)r->work.build_us);
        return true;
    }
    forest_inputs_free(registry_destroy(&shared->forests, r));
    return false;
}

/* The latest frame is the resident's from now on. */
static void take_frame(service *shared, resident *r)
{
    published_release(r->latest);
    r->latest = r->work.frame;
    r->work.frame = NULL;
    r->sequence = r->latest->frame.sequence;
    shared->counters.frames_encoded++;
}

static void take_created(service *shared, resident *r)
{
    session *asker = session_find(shared, r->creator);
    if (asker) {
        asker->pending--;
    }
    shared->forests.telling -= r->tells;
    r->tells = false;
    r->info = r->work.info;
    r->params = r->work.making->params;
    if (accept_created(shared, r, asker)) {
        r->ready = true;
        take_frame(shared, r);
        reply_created(asker, r);
    }
    recipe_destroy(r->work.making);
    r->work.making = NULL;
}

/* ---- QUERY ------------------------------------------------------------------------------------------------------- */

/* Tells the senders of motions that the forest would not take. */
static const forest_input *report_refused(service *shared, const forest_input *inputs)
{
    const forest_input *input = inputs;
    for (; input->kind != FOREST_QUERY; input = input->next) {
        session *sender = input->error.status == AWT_OK ? NULL : session_find(shared, input->from);
        if (sender) {
            session_error_awt(sender, input->kind == FOREST_MOTION ? PROTO_MOTION : PROTO_SET_PARAMS,
                              input->from.request, &input->error);
        }
    }
    return input;
}

static void take_advanced(service *shared, resident *r)
{
    const forest_input *query = report_refused(shared, r->work.inputs);
    session *asker = session_find(shared, query->from);
    if (asker) {
        asker->pending--;
    }
    if (r->work.frame) {
        take_frame(shared, r);
        if (asker) {
            session_frame(asker, r->latest, query->from.request);
        }
        subscriptions_offer(r, r->latest);
        for (subscription *sub = r->subscriptions; sub; sub = sub->next_of_forest) {
            session_stream(sub->session);
        }
    } else if (asker) {
        session_error_awt(asker, PROTO_QUERY, query->from.request, &r->work.error);
    }
    forest_inputs_free(r->work.inputs);
    r->work.inputs = NULL;
}

/* ---- both -------------------------------------------------------------------------------------------------------- */

bool completions_take(service *shared)
{
    job *done = worker_pool_take_done(shared->pool);
    bool any = done != NULL;
    while (done) {
        job *next = done->next;
        resident *r = registry_take_back(done);
        shared->counters.steps += r->work.steps;
        shared->counters.step_us += r->work.step_us;
        shared->counters.encode_us += r->work.encode_us;
        if (r->work.making) {
            take_created(shared, r);
        } else {
            take_advanced(shared, r);
        }
        registry_continue(&shared->forests, r);
        done = next;
    }
    return any;
}
