/* session_info.c: LIST_STYLES and STATS: about the daemon. */
#include "handlers.h"
#include "base/version.h"

static void add_style(struct proto_list_styles_reply *list, const awt_style *style)
{
    list->styles.items[list->styles.count++] =
        (struct proto_style_info){.name = proto_str_of(style->name),
                                  .text = proto_str_of(style->description),
                                  .levels = (uint8_t)style->levels,
                                  .finest_nodes = style->finest_wisps * style->sections,
                                  .points_per_strand = (uint16_t)style->points_per_strand};
}

static void add_param(struct proto_list_styles_reply *list, const awt_param_info *param)
{
    list->params.items[list->params.count++] = (struct proto_param_info){.name = proto_str_of(param->name),
                                                                         .unit = proto_str_of(param->unit),
                                                                         .text = proto_str_of(param->text),
                                                                         .value = param->value,
                                                                         .least = param->least,
                                                                         .greatest = param->greatest};
}

void session_list_styles(session *s, const proto_message *message)
{
    proto_message reply = {.type = PROTO_LIST_STYLES_REPLY, .request = message->request};
    struct proto_list_styles_reply *list = &reply.as.list_styles_reply;
    const size_t style_room = sizeof list->styles.items / sizeof list->styles.items[0];
    const size_t param_room = sizeof list->params.items / sizeof list->params.items[0];
    for (size_t i = 0; i < awt_style_count() && i < style_room; i++) {
        add_style(list, awt_style_at(i));
    }
    for (size_t i = 0; i < awt_param_count() && i < param_room; i++) {
        add_param(list, awt_param_at(i));
    }
    session_send(s, &reply);
}

void session_stats(session *s, const proto_message *message)
{
    const service *shared = s->shared;
    const service_counters *counters = &shared->counters;
    proto_message reply = {.type = PROTO_STATS_REPLY, .request = message->request};
    reply.as.stats_reply = (struct proto_stats_reply){
        .version = proto_str_of("awtd " AWTD_VERSION),
        .uptime_us = (uint64_t)(shared->options.clock_us() - shared->started_us),
        .workers = worker_pool_count(shared->pool),
        .connections = counters->sessions,
        .forests = registry_ready_count(&shared->forests),
        .frames_encoded = counters->frames_encoded,
        .frames_sent = counters->frames_sent,
        .bytes_sent = counters->bytes_sent,
        .errors_sent = counters->errors_sent,
        .steps = counters->steps,
        .step_us = counters->step_us,
        .encode_us = counters->encode_us,
        .memory = registry_bytes(&shared->forests),
        .last_write_us = s->last_write_us,
        .io_threads = shared->options.io_threads,
        .idle_connections = counters->idle,
    };
    session_send(s, &reply);
}
