/* completions.c: see completions.h. */
#include "completions.h"
#include "clock.h"
#include "convert.h"
#include "load_watch.h"
#include "log.h"
#include "metrics.h"
#include "published.h"
#include "session.h"
#include "turns.h"

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

/* Why a forest that was to be made cannot be shown. */
static const awt_error *fault_of(const forest_work *w)
{
    return w->error.status != AWT_OK ? &w->error : &w->draw_error;
}

/* A forest that nobody will ever hear of is not kept. False: it is doomed. */
static bool accept_created(service *shared, resident *r, session *asker)
{
    char quoted[LOG_QUOTED];
    log_quote(r->name, strlen(r->name), quoted);
    if (!r->work.drawn) {
        const awt_error *fault = fault_of(&r->work);
        char why[LOG_QUOTED];
        log_write(LOG_INFO, "forest not made", "name=%s why=%s", quoted,
                  log_quote(fault->text, strlen(fault->text), why));
        if (asker) {
            session_error_awt(asker, PROTO_CREATE, r->creator.request, fault);
        }
    } else if (!asker || asker->state == SESSION_CLOSING) {
        log_write(LOG_INFO, "forest not kept", "name=%s why=\"its maker is gone\"", quoted);
    } else if (session_attach(asker, PROTO_CREATE, r->creator.request, r, true)) {
        log_write(LOG_INFO, "forest created", "peer=%s name=%s strands=%lu nodes=%lu build_us=%lu", asker->peer, quoted,
                  (unsigned long)r->work.info.strand_count, (unsigned long)r->work.info.finest_nodes,
                  (unsigned long)r->work.build_us);
        metrics_count(METRIC_FORESTS_MADE, 1);
        return true;
    }
    forest_inputs_free(registry_destroy(&shared->forests, r));
    return false;
}

/* What was drawn is the resident's from now on. False: nothing new is to be seen. */
static bool take_picture(service *shared, resident *r)
{
    picture *drawn = r->work.drawn;
    r->work.drawn = NULL;
    if (!drawn) {
        return false;
    }
    shared->counters.frames_encoded += drawn->view_count;
    metrics_count(METRIC_FRAMES_ENCODED, drawn->view_count);
    return published_take(r, drawn);
}

/* A forest from the state directory has no maker: it waits for those who have its tokens. */
static void take_restored(service *shared, resident *r)
{
    char quoted[LOG_QUOTED], why[LOG_QUOTED];
    log_quote(r->name, strlen(r->name), quoted);
    shared->forests.restoring--;
    if (r->work.drawn) {
        r->ready = true;
        take_picture(shared, r);
        turns_set_clock(&shared->forests, r, (clock_mode)r->work.saving.mode, r->work.saving.rate);
        log_write(LOG_INFO, "forest restored", "forest=%016llx name=%s time_us=%lld", (unsigned long long)r->handle,
                  quoted, (long long)r->latest->figures.time_us);
        return;
    }
    const awt_error *fault = fault_of(&r->work);
    log_write(LOG_ERROR, "forest not restored", "forest=%016llx name=%s why=%s", (unsigned long long)r->handle, quoted,
              log_quote(fault->text, strlen(fault->text), why));
    keeper_set_aside(shared->forests.keeper, r->handle);
    forest_inputs_free(registry_destroy(&shared->forests, r));
}

static void take_created(service *shared, resident *r)
{
    session *asker = session_find(shared, r->creator);
    if (asker) {
        asker->pending--;
        session_prompt(asker);
    }
    shared->forests.telling -= r->tells;
    r->tells = false;
    r->info = r->work.info;
    r->params = r->work.making->params;
    r->motion_us = r->work.making->start.time_us;
    if (r->restored) {
        take_restored(shared, r);
    } else if (accept_created(shared, r, asker)) {
        r->ready = true;
        take_picture(shared, r);
        reply_created(asker, r);
    }
    recipe_destroy(r->work.making);
    r->work.making = NULL;
}

/* ---- QUERY and BINDING ------------------------------------------------------------------------------------------- */

/* Tells the senders of motions that the forest would not take. */
static const forest_input *report_refused(service *shared, const forest_input *inputs)
{
    const forest_input *input = inputs;
    for (; input && input->kind != FOREST_QUERY; input = input->next) {
        session *sender = input->error.status == AWT_OK ? NULL : session_find(shared, input->from);
        if (sender) {
            session_error_awt(sender, forest_input_message(input->kind), input->from.request, &input->error);
        }
    }
    return input;
}

/* Answers with the view asked for, or with `error` where it is missing. */
static void answer(service *shared, const forest_input *asked, picture *shown, const view *v, const awt_error *error)
{
    session *asker = session_find(shared, asked->from);
    if (!asker || (asked->kind == FOREST_QUERY && asked->as.query.promised &&
                   !promises_keep(&asker->promised, asked->from.request, asked->as.query.promised))) {
        return; /* gone, or it has been answered by its deadline */
    }
    asker->pending--;
    session_prompt(asker);
    if (v) {
        session_picture(asker, shown, v, asked->from.request);
    } else {
        const bool many = asked->kind == FOREST_QUERY && asked->as.query.promised != 0;
        session_error_awt(asker, many ? PROTO_STEP_MANY : forest_input_message(asked->kind), asked->from.request,
                          error);
    }
}

/* The step's QUERY, then all who only look. */
static void answer_all(service *shared, resident *r)
{
    const forest_input *query = r->work.inputs ? report_refused(shared, r->work.inputs) : NULL;
    if (query) {
        const view *v = r->work.stepped ? picture_view(r->latest, (view_name){.form = query->as.query.form}) : NULL;
        answer(shared, query, r->latest, v, r->work.stepped ? &r->work.draw_error : &r->work.error);
    }
    for (const forest_input *look = r->work.looks; look; look = look->next) {
        const int form = look->kind == FOREST_BINDING ? PICTURE_BINDING
                         : look->kind == FOREST_STATE ? PICTURE_STATE
                                                      : look->as.query.form;
        picture *shown = form == PICTURE_BINDING ? r->binding : form == PICTURE_STATE ? r->work.state : r->latest;
        answer(shared, look, shown, picture_view(shown, (view_name){.form = form}), &r->work.draw_error);
    }
    picture_release(r->work.state);
    r->work.state = NULL;
    forest_inputs_free(r->work.inputs);
    forest_inputs_free(r->work.looks);
    r->work.inputs = r->work.looks = NULL;
}

/* Has those send it that were `silent` since then, or those that were not. Who reads gives back its credit; who does
 * not lets the socket fill, which makes every byte for it dearer: so it comes last. */
static void stream_to(const resident *r, bool silent, int64_t since_us)
{
    for (subscription *sub = r->subscriptions; sub; sub = sub->next_of_forest) {
        if ((sub->session->heard_us < since_us) == silent) {
            session_stream(sub->session);
        }
    }
}

static void take_drawn(service *shared, resident *r)
{
    const bool drawn = take_picture(shared, r);
    if (r->work.binding) {
        r->binding = r->work.binding;
        r->work.binding = NULL;
    }
    answer_all(shared, r);
    if (drawn) {
        subscriptions_offer(r, r->latest);
        const int64_t since_us = shared->options.clock_us() - LIMIT_SILENT_US;
        stream_to(r, false, since_us);
        stream_to(r, true, since_us);
    }
}

/* ---- both -------------------------------------------------------------------------------------------------------- */

static void count(service_counters *c, const forest_work *done)
{
    const bool missed = done->job.class == JOB_STEP && done->job.ended_us > done->job.deadline_us;
    c->steps += done->steps;
    c->step_us += done->step_us;
    c->encode_us += done->encode_us;
    c->deadlines_missed += missed;
    c->dropped_us += (uint64_t)done->dropped_us;
    metrics_count(METRIC_DEADLINES_MISSED, missed);
    metrics_count(METRIC_DROPPED_US, (uint64_t)done->dropped_us);
    if (done->job.class == JOB_STEP) {
        metrics_observe(METRIC_LATENESS, clock_between_us(done->job.deadline_us, done->job.ended_us));
    }
}

bool completions_take(service *shared)
{
    job *done = worker_pool_take_done(shared->pool);
    bool any = done != NULL;
    while (done) {
        job *next = done->next;
        resident *r = registry_take_back(done);
        count(&shared->counters, &r->work);
        load_watch_count(shared, r);
        if (r->work.making) {
            take_created(shared, r);
        } else {
            take_drawn(shared, r);
        }
        registry_continue(&shared->forests, r);
        done = next;
    }
    return any;
}
