/* session_forest.c: CREATE, ATTACH, DETACH, DESTROY, LIST: the life of forests. (CREATE is answered in completions.c,
 * when a worker has made the hair.) */
#include "handlers.h"
#include "log.h"

#include <stdio.h>
#include <string.h>

void session_create(session *s, const proto_message *message)
{
    const struct proto_create *create = &message->as.create;
    awt_error error = {0};
    recipe *making = NULL;
    if (!session_may_drive(s, message)) {
        return;
    }
    const bool from_upload = create->source == RECIPE_FROM_UPLOAD, own_hierarchy = from_upload && create->own_hierarchy;
    upload *file = from_upload ? session_complete_upload(s, create->upload) : NULL;
    upload *hierarchy = own_hierarchy ? session_complete_upload(s, create->hierarchy) : NULL;
    if (create->source > RECIPE_FROM_UPLOAD) {
        session_error(s, message->type, message->request, PROTO_ERROR_BAD_VALUE,
                      "source is %u; 0 is a built-in style, 1 an upload", (unsigned)create->source);
        return;
    }
    if ((from_upload && !file) || (own_hierarchy && !hierarchy)) {
        session_error(s, message->type, message->request, PROTO_ERROR_NO_UPLOAD, "there is no complete upload %lu",
                      (unsigned long)(from_upload && !file ? create->upload : create->hierarchy));
        return;
    }
    if (recipe_create(create, file, hierarchy, &making, &error) != AWT_OK) {
        session_error_awt(s, message->type, message->request, &error);
    } else if (session_make(s, message, making) && create->progress) {
        service_ring_door(s->shared);
    }
}

void session_attach_forest(session *s, const proto_message *message)
{
    const struct proto_attach *attach = &message->as.attach;
    resident *r = registry_find(&s->shared->forests, attach->forest);
    if (!r) {
        session_error(s, message->type, message->request, PROTO_ERROR_NO_FOREST, NULL);
        return;
    }
    /* both are always compared, so that time does not tell which one was nearer */
    const bool may_drive = auth_equal(attach->token, r->drive_token, sizeof r->drive_token);
    const bool may_view = auth_equal(attach->token, r->view_token, sizeof r->view_token);
    const bool drive = may_drive && !s->who->is.caps.views_only;
    if (!may_drive && !may_view) {
        log_write(LOG_WARN, "wrong forest token", "peer=%s", s->peer);
        session_error(s, message->type, message->request, PROTO_ERROR_WRONG_TOKEN, NULL);
        return;
    }
    if (!session_attach(s, message->type, message->request, r, drive)) {
        return;
    }
    proto_message reply = {.type = PROTO_ATTACH_REPLY, .request = message->request};
    reply.as.attach_reply.may_drive = drive;
    reply.as.attach_reply.time_us = r->latest->figures.time_us;
    reply.as.attach_reply.strands = r->info.strand_count;
    reply.as.attach_reply.points_per_strand = (uint16_t)r->info.points_per_strand;
    session_send(s, &reply);
}

void session_detach_forest(session *s, const proto_message *message)
{
    session_detach(s, message->as.detach.forest);
}

/* Tells everyone who watches that there is nothing more to come. */
static void end_subscriptions(resident *r)
{
    while (r->subscriptions) {
        subscription *sub = r->subscriptions;
        session_error(sub->session, PROTO_SUBSCRIBE, sub->request, PROTO_ERROR_NO_FOREST, "the forest was destroyed");
        subscription_end(sub);
    }
}

/* Answers the queries that will not get their turn. */
static void refuse_waiting(service *shared, forest_input *waiting)
{
    for (const forest_input *input = waiting; input; input = input->next) {
        session *asker = input->kind >= FOREST_QUERY ? session_find(shared, input->from) : NULL;
        const uint64_t promised = input->kind == FOREST_QUERY ? input->as.query.promised : 0;
        if (asker && (!promised || promises_keep(&asker->promised, input->from.request, promised))) {
            asker->pending--;
            session_error(asker, forest_input_message(input->kind), input->from.request, PROTO_ERROR_NO_FOREST,
                          "the forest was destroyed before this query had its turn");
        }
    }
    forest_inputs_free(waiting);
}

/* With the memory that it came to take, as a whole and by form; nothing of it is given back while it lives. */
static void log_destroyed(const session *s, const resident *r)
{
    char quoted[LOG_QUOTED], forms[FORM_COUNT * 48] = "";
    size_t used = 0;
    for (int i = 0; i < FORM_COUNT; i++) {
        if (r->form_bytes[i] > 0 && used < sizeof forms) {
            used += (size_t)snprintf(forms + used, sizeof forms - used, " %s=%llu", form_name(i),
                                     (unsigned long long)r->form_bytes[i]);
        }
    }
    log_write(LOG_INFO, "forest destroyed", "peer=%s name=%s bytes=%llu%s", s->peer,
              log_quote(r->name, strlen(r->name), quoted), (unsigned long long)r->bytes, forms);
}

void session_destroy(session *s, const proto_message *message)
{
    resident *r = session_resident(s, message, message->as.destroy.forest, true);
    if (!r) {
        return;
    }
    log_destroyed(s, r);
    end_subscriptions(r);
    session_detach(s, r->handle);
    refuse_waiting(s->shared, registry_destroy(&s->shared->forests, r));
    session_send(s, &(proto_message){.type = PROTO_DESTROY_REPLY, .request = message->request});
}

static struct proto_forest_info forest_line(const resident *r)
{
    return (struct proto_forest_info){.forest = r->handle,
                                      .name = proto_str_of(r->name),
                                      .time_us = r->latest->figures.time_us,
                                      .strands = r->info.strand_count,
                                      .finest_nodes = r->info.finest_nodes,
                                      .active_nodes = r->latest->figures.active_nodes,
                                      .subscribers = r->subscription_count};
}

void session_list(session *s, const proto_message *message)
{
    proto_message reply = {.type = PROTO_LIST_REPLY, .request = message->request};
    struct proto_list_reply *list = &reply.as.list_reply;
    const size_t room = sizeof list->forests.items / sizeof list->forests.items[0];
    for (const resident *r = s->shared->forests.first; r; r = r->next) {
        if (!r->ready || r->doomed) {
            continue;
        }
        if (list->forests.count < room) {
            list->forests.items[list->forests.count++] = forest_line(r);
        }
        list->total++;
    }
    session_send(s, &reply);
}
