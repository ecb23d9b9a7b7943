/* awtctl_info.c: questions to the daemon that move nothing: stats, ping, styles. */
#include "awtctl.h"

#include "quantile.h"
#include "socket.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

enum { INFO_TIMEOUT_MS = 10000, PING_MAX = 1000 };

/* A question that is one message, and what to do with its answer. */
typedef struct question {
    const char *name, *summary; /* for the help */
    uint16_t type;
    void (*print)(const proto_message *answer);
    void (*json)(jsonout *json, const void *answer);
} question;

static awtctl_exit ask(const question *q, int argc, char *const *argv)
{
    awtctl_connection connection = {.address = AWTCTL_ADDRESS};
    const char *json_path = NULL;
    const option options[] = {
        AWTCTL_CONNECTION_OPTIONS(connection),
        {"json", OPTION_OPTIONAL_TEXT, "FILE", &json_path, 0, 0, "JSON instead, to FILE or stdout"},
    };
    const option_program program = {q->name, q->summary, NULL, options, sizeof options / sizeof options[0]};
    size_t operands;
    awtctl_exit code;
    if (!awtctl_options(&program, argc, argv, NULL, 0, &operands, &code)) {
        return code;
    }
    awtclient *client = awtctl_connect(&connection, INFO_TIMEOUT_MS);
    if (!client) {
        return AWTCTL_FAILED;
    }
    awtclient_error error;
    proto_message request = {.type = q->type}, answer;
    if (!awtclient_call(client, &request, &answer, &error)) {
        code = awtctl_failed("%s", error.text);
    } else if (!json_path) {
        q->print(&answer);
    } else if (!awtctl_write_json(json_path, q->json, &answer)) {
        code = AWTCTL_FAILED;
    }
    awtclient_close(client);
    return code;
}

/* ---- stats ----------------------------------------------------------------------------------------------------- */

static void stats_print(const proto_message *answer)
{
    const struct proto_stats_reply *s = &answer->as.stats_reply;
    char version[65];
    proto_str_copy(s->version, version, sizeof version);
    printf("%-16s %s, up %.1f s\n", "daemon", version, (double)s->uptime_us * 1e-6);
    printf("%-16s %u and %u for input and output\n", "workers", s->workers, s->io_threads);
    printf("%-16s %u, %u of them idle\n%-16s %u\n", "connections", s->connections, s->idle_connections, "forests",
           s->forests);
    printf("%-16s %" PRIu64 " encoded, %" PRIu64 " sent, %" PRIu64 " bytes\n", "frames", s->frames_encoded,
           s->frames_sent, s->bytes_sent);
    printf("%-16s %" PRIu64 "\n", "errors sent", s->errors_sent);
    printf("%-16s %" PRIu64 ", mean %.1f us\n", "steps", s->steps,
           s->steps > 0 ? (double)s->step_us / (double)s->steps : 0.0);
    printf("%-16s mean %.1f us\n", "encoding",
           s->frames_encoded > 0 ? (double)s->encode_us / (double)s->frames_encoded : 0.0);
    printf("%-16s %.1f MB\n", "memory", (double)s->memory * 1e-6);
}

static void stats_json(jsonout *json, const void *answer)
{
    const struct proto_stats_reply *s = &((const proto_message *)answer)->as.stats_reply;
    char version[65];
    proto_str_copy(s->version, version, sizeof version);
    jsonout_object(json, NULL);
    jsonout_text(json, "version", version);
    jsonout_unsigned(json, "uptime_us", s->uptime_us);
    jsonout_unsigned(json, "workers", s->workers);
    jsonout_unsigned(json, "io_threads", s->io_threads);
    jsonout_unsigned(json, "connections", s->connections);
    jsonout_unsigned(json, "idle_connections", s->idle_connections);
    jsonout_unsigned(json, "forests", s->forests);
    jsonout_unsigned(json, "frames_encoded", s->frames_encoded);
    jsonout_unsigned(json, "frames_sent", s->frames_sent);
    jsonout_unsigned(json, "bytes_sent", s->bytes_sent);
    jsonout_unsigned(json, "errors_sent", s->errors_sent);
    jsonout_unsigned(json, "steps", s->steps);
    jsonout_unsigned(json, "step_us", s->step_us);
    jsonout_unsigned(json, "encode_us", s->encode_us);
    jsonout_unsigned(json, "memory", s->memory);
    jsonout_close(json);
}

awtctl_exit awtctl_stats(int argc, char *const *argv)
{
    static const question q = {"awtctl stats", "Shows the daemon's counts and times.", PROTO_STATS, stats_print,
                               stats_json};
    return ask(&q, argc, argv);
}

/* ---- styles ---------------------------------------------------------------------------------------------------- */

static const char *text_of(proto_str from, char *to, size_t size)
{
    proto_str_copy(from, to, size);
    return to;
}

static void styles_print(const proto_message *answer)
{
    const struct proto_list_styles_reply *reply = &answer->as.list_styles_reply;
    char name[33], unit[17], text[161];
    printf("%-12s %6s %6s %6s  %s\n", "style", "levels", "nodes", "points", "");
    for (uint16_t i = 0; i < reply->styles.count; i++) {
        const struct proto_style_info *s = &reply->styles.items[i];
        printf("%-12s %6u %6u %6u  %s\n", text_of(s->name, name, sizeof name), s->levels, s->finest_nodes,
               s->points_per_strand, text_of(s->text, text, sizeof text));
    }
    printf("\n%-18s %8s %8s %8s %-6s\n", "parameter", "default", "least", "greatest", "unit");
    for (uint16_t i = 0; i < reply->params.count; i++) {
        const struct proto_param_info *p = &reply->params.items[i];
        printf("%-18s %8g %8g %8g %-6s %s\n", text_of(p->name, name, sizeof name), (double)p->value, (double)p->least,
               (double)p->greatest, text_of(p->unit, unit, sizeof unit), text_of(p->text, text, sizeof text));
    }
}

static void styles_json(jsonout *json, const void *answer)
{
    const struct proto_list_styles_reply *reply = &((const proto_message *)answer)->as.list_styles_reply;
    char text[161];
    jsonout_object(json, NULL);
    jsonout_array(json, "styles");
    for (uint16_t i = 0; i < reply->styles.count; i++) {
        const struct proto_style_info *s = &reply->styles.items[i];
        jsonout_object(json, NULL);
        jsonout_text(json, "name", text_of(s->name, text, sizeof text));
        jsonout_text(json, "text", text_of(s->text, text, sizeof text));
        jsonout_unsigned(json, "levels", s->levels);
        jsonout_unsigned(json, "finest_nodes", s->finest_nodes);
        jsonout_unsigned(json, "points_per_strand", s->points_per_strand);
        jsonout_close(json);
    }
    jsonout_close(json);
    jsonout_array(json, "params");
    for (uint16_t i = 0; i < reply->params.count; i++) {
        const struct proto_param_info *p = &reply->params.items[i];
        jsonout_object(json, NULL);
        jsonout_text(json, "name", text_of(p->name, text, sizeof text));
        jsonout_text(json, "unit", text_of(p->unit, text, sizeof text));
        jsonout_text(json, "text", text_of(p->text, text, sizeof text));
        jsonout_float(json, "value", p->value);
        jsonout_float(json, "least", p->least);
        jsonout_float(json, "greatest", p->greatest);
        jsonout_close(json);
    }
    jsonout_close(json);
    jsonout_close(json);
}

awtctl_exit awtctl_styles(int argc, char *const *argv)
{
    static const question q = {"awtctl styles", "Lists the built-in styles and all parameters.", PROTO_LIST_STYLES,
                               styles_print, styles_json};
    return ask(&q, argc, argv);
}

/* ---- ping ------------------------------------------------------------------------------------------------------- */

typedef struct ping_result {
    size_t count;
    double round_us[PING_MAX]; /* sorted at the end; without the daemon's own time */
    double offset_us;          /* the daemon's clock less ours, by the quickest round */
} ping_result;

static bool ping_once(awtclient *client, ping_result *result)
{
    awtclient_error error;
    proto_message request = {.type = PROTO_PING}, answer;
    request.as.ping.sent_us = socket_now_us();
    if (!awtclient_call(client, &request, &answer, &error)) {
        awtctl_failed("%s", error.text);
        return false;
    }
    const struct proto_pong *pong = &answer.as.pong;
    double sent = (double)pong->sent_us, received = (double)pong->received_us, answered = (double)pong->answered_us;
    double arrived = (double)socket_now_us(), round_us = (arrived - sent) - (answered - received);
    bool quickest = true;
    for (size_t i = 0; i < result->count; i++) {
        quickest = quickest && round_us < result->round_us[i];
    }
    if (quickest) {
        result->offset_us = ((received - sent) + (answered - arrived)) / 2;
    }
    result->round_us[result->count++] = round_us;
    return true;
}

static void ping_json(jsonout *json, const void *context)
{
    const ping_result *r = context;
    jsonout_object(json, NULL);
    jsonout_unsigned(json, "count", r->count);
    jsonout_real(json, "min_us", quantile_at(r->round_us, r->count, 0));
    jsonout_real(json, "p50_us", quantile_at(r->round_us, r->count, 0.5));
    jsonout_real(json, "p99_us", quantile_at(r->round_us, r->count, 0.99));
    jsonout_real(json, "max_us", quantile_at(r->round_us, r->count, 1));
    jsonout_real(json, "clock_offset_us", r->offset_us);
    jsonout_close(json);
}

static void ping_print(const ping_result *r)
{
    double least = quantile_at(r->round_us, r->count, 0);
    printf("%zu rounds: least %.0f us, p50 %.0f us, p99 %.0f us, greatest %.0f us\n", r->count, least,
           quantile_at(r->round_us, r->count, 0.5), quantile_at(r->round_us, r->count, 0.99),
           quantile_at(r->round_us, r->count, 1));
    printf("the daemon's clock is %.6f s ahead of this one, to within %.0f us\n", r->offset_us * 1e-6, least / 2);
}

awtctl_exit awtctl_ping(int argc, char *const *argv)
{
    awtctl_connection connection = {.address = AWTCTL_ADDRESS};
    const char *json_path = NULL;
    long long count = 10;
    const option options[] = {
        AWTCTL_CONNECTION_OPTIONS(connection),
        {"count", OPTION_INTEGER, "N", &count, 1, PING_MAX, "rounds"},
        {"json", OPTION_OPTIONAL_TEXT, "FILE", &json_path, 0, 0, "JSON instead, to FILE or stdout"},
    };
    const option_program program = {"awtctl ping", "Measures the way to the daemon and back.", NULL, options,
                                    sizeof options / sizeof options[0]};
    size_t operands;
    awtctl_exit code;
    if (!awtctl_options(&program, argc, argv, NULL, 0, &operands, &code)) {
        return code;
    }
    awtclient *client = awtctl_connect(&connection, INFO_TIMEOUT_MS);
    ping_result result = {0};
    bool good = client != NULL;
    while (good && (long long)result.count < count) {
        good = ping_once(client, &result);
    }
    quantile_sort(result.round_us, result.count);
    if (good && json_path) {
        good = awtctl_write_json(json_path, ping_json, &result);
    } else if (good) {
        ping_print(&result);
    }
    awtclient_close(client);
    return good ? AWTCTL_FINE : AWTCTL_FAILED;
}
