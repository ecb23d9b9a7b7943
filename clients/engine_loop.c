/* engine_loop.c: a game's loop with hair from awtd, whole, to be copied from.
 *
 * Each tick of the loop does four things, none of which waits for the daemon: it tells the daemon where the head will
 * be (drive), takes what has come (listen), has it decoded (decode; a game gives that to its job system), and shows
 * hair of now, mixed from the frames that are there (show). What is sent is ahead of the game by `lead`: as long as a
 * frame needed lately from its request until it could be shown. Where the head will be by then is predicted from its
 * velocity; the difference of what is shown from the true motion is what that costs, and is printed.
 *
 * Simulated time is the loop's own: 0 at its beginning, one second a second. */
#include "awtclock.h"
#include "awtframes.h"
#include "awtlink.h"
#include "jsonout.h"

#include "base/options.h"
#include "base/version.h"

#include <inttypes.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>

enum {
    LOOP_STREAM_RATE = 60, /* simulated steps, and frames, a second */
    LOOP_SENT = 64,        /* requests remembered */
    LOOP_ASKING = 15,      /* requests under way; more would only make a late daemon later */
    LOOP_KIND = 1,         /* strands, with deltas */
    LOOP_NODES = 3         /* what a request answers: the fewest bytes */
};
#define LOOP_EXTRAPOLATE_US 20000
#define LOOP_TARGET_AGE_US 250000
#define LOOP_MARGIN_US 3000
#define LOOP_LEAST_LEAD_US 20000

typedef struct loop_plan {
    const char *address, *token_file, *style, *json;
    long long rate, strands;
    double seconds;
} loop_plan;

typedef struct loop_sent {
    int64_t time_us, sent_us; /* asked for, and when, both simulated */
} loop_sent;

typedef struct loop {
    const loop_plan *plan;
    awtlink *link;
    awtframes *frames;
    awtclock clock;
    int64_t began_us; /* the machine's clock when simulated time was 0 */
    uint64_t forest, subscribe_request, subscription;
    uint32_t under_way; /* credit that the daemon has */
    /* driving */
    uint32_t sequence, asking;
    int64_t next_send_us, asked_us, lead_us;
    loop_sent sent[LOOP_SENT];
    int64_t needed_us[LOOP_SENT]; /* from request to frame, lately */
    uint32_t needed_count;
    /* what is told at the end */
    uint64_t ticks, shown, backwards, received, undecoded, busy;
    uint64_t stall, longest_stall; /* ticks that stood still, in a row */
    int64_t last_shown_us;
    double off_sum_m, off_greatest_m, age_sum_us, age_greatest_us, bytes;
} loop;

static int64_t now_us(const loop *l)
{
    return awtclient_now_us() - l->began_us;
}

/* ---- the head ------------------------------------------------------------------------------------------------- */

/* Where the head truly is: it sways and nods. */
static proto_pose true_head(int64_t time_us)
{
    const double t = 1e-6 * (double)time_us, nod = 0.3 * sin(2.1 * t);
    proto_pose pose = {.position = {0.15 * sin(1.7 * t), 0.03 * sin(3.1 * t), 0.05 * sin(1.1 * t)}};
    pose.orientation[0] = sin(nod / 2);
    pose.orientation[3] = cos(nod / 2);
    return pose;
}

/* Where a game at `time_us`, which knows the motion until then, expects the head at `at_us`. */
static proto_pose predicted_head(int64_t time_us, int64_t at_us)
{
    const int64_t before_us = time_us - 1000000 / LOOP_STREAM_RATE;
    const double share = (double)(at_us - time_us) / (double)(time_us - before_us);
    const proto_pose now = true_head(time_us), before = true_head(before_us);
    proto_pose out = now;
    double square = 0;
    for (int i = 0; i < 3; i++) {
        out.position[i] += share * (now.position[i] - before.position[i]);
    }
    for (int i = 0; i < 4; i++) {
        out.orientation[i] += share * (now.orientation[i] - before.orientation[i]);
        square += out.orientation[i] * out.orientation[i];
    }
    for (int i = 0; i < 4; i++) {
        out.orientation[i] /= sqrt(square);
    }
    return out;
}

/* ---- connecting ------------------------------------------------------------------------------------------------- */

static bool failed(const char *what, const awtclient_error *error)
{
    fprintf(stderr, "engine_loop: %s%s\n", what, error->text);
    return false;
}

/* Pumps, and waits for the link before it, but not beyond `until_us` of the machine's clock. */
static bool turn(loop *l, int64_t until_us)
{
    awtclient_error error;
    const unsigned wanted = awtlink_wanted(l->link);
    const int64_t left_us = until_us - awtclient_now_us();
    struct pollfd entry = {.fd = awtlink_descriptor(l->link)};
    entry.events = (short)((wanted & AWTLINK_READ ? POLLIN : 0) | (wanted & AWTLINK_WRITE ? POLLOUT : 0));
    poll(&entry, 1, awtlink_pending(l->link) || left_us <= 0 ? 0 : (int)((left_us + 999) / 1000));
    return awtlink_pump(l->link, awtclient_now_us(), &error) || failed("", &error);
}

/* Before the loop begins there is time to wait for an answer. */
static bool ask(loop *l, proto_message *request, proto_message *answer)
{
    const int64_t until_us = awtclient_now_us() + 60000000;
    awtclient_error error = {.text = "no answer within a minute"};
    if (!awtlink_queue(l->link, request, &error)) {
        return failed("", &error);
    }
    while (awtclient_now_us() < until_us) {
        while (awtlink_next(l->link, answer, &error)) {
            if (answer->request == request->request && answer->type == PROTO_ERROR) {
                proto_str_copy(answer->as.error.text, error.text, sizeof error.text);
                return failed("", &error);
            }
            if (answer->request == request->request) {
                return true;
            }
        }
        if (!turn(l, until_us)) {
            return false;
        }
    }
    return failed("", &error);
}

static bool open_link(loop *l)
{
    awtclient_error error;
    const awtclient_options options = {
        .address = l->plan->address, .token_file = l->plan->token_file, .name = "engine_loop " AWTD_VERSION};
    l->link = awtlink_open(&options, awtclient_now_us(), &error);
    if (!l->link) {
        return failed("", &error);
    }
    while (!awtlink_ready(l->link)) {
        if (!turn(l, awtlink_deadline_us(l->link))) {
            return false;
        }
    }
    return true;
}

static bool make_hair(loop *l)
{
    static proto_message request, answer;
    request = (proto_message){.type = PROTO_CREATE};
    request.as.create.style = proto_str_of(l->plan->style);
    request.as.create.seed = 1;
    request.as.create.strands = (uint32_t)l->plan->strands;
    request.as.create.head = true_head(0);
    request.as.create.body.orientation[3] = 1;
    if (!ask(l, &request, &answer)) {
        return false;
    }
    l->forest = answer.as.create_reply.forest;
    request = (proto_message){.type = PROTO_SUBSCRIBE};
    request.as.subscribe = (struct proto_subscribe){.forest = l->forest, .kind = LOOP_KIND, .credit = 2, .deltas = 1};
    l->under_way = 2;
    if (!ask(l, &request, &answer)) {
        return false;
    }
    l->subscribe_request = request.request;
    l->subscription = answer.as.subscribe_reply.subscription;
    return true;
}

/* ---- a tick ----------------------------------------------------------------------------------------------------- */

/* What is refused because too much waits to be sent is left out: the next motion says more. */
static bool send(loop *l, proto_message *message)
{
    awtclient_error error;
    return awtlink_queue(l->link, message, &error) || error.code == AWTCLIENT_FULL || failed("", &error);
}

/* How far ahead to ask, so that the frame is there when its time is shown. It shrinks slowly, so as not to swing. */
static void choose_lead(loop *l)
{
    int64_t most_us = LOOP_LEAST_LEAD_US;
    for (uint32_t i = 0; i < LOOP_SENT && i < l->needed_count; i++) {
        most_us = l->needed_us[i] > most_us ? l->needed_us[i] : most_us;
    }
    most_us += 1000000 / LOOP_STREAM_RATE + LOOP_MARGIN_US;
    most_us = most_us < LOOP_TARGET_AGE_US ? most_us : LOOP_TARGET_AGE_US;
    l->lead_us = most_us > l->lead_us ? most_us : l->lead_us - (l->lead_us - most_us) / 64;
}

static bool drive(loop *l, int64_t time_us)
{
    if (time_us < l->next_send_us) {
        return true;
    }
    l->next_send_us += 1000000 / LOOP_STREAM_RATE;
    choose_lead(l);
    const int64_t at_us = time_us + l->lead_us;
    if (at_us <= l->asked_us) {
        return true;
    }
    proto_message motion = {.type = PROTO_MOTION}, query = {.type = PROTO_QUERY}, ping = {.type = PROTO_PING};
    motion.as.motion = (struct proto_motion){.forest = l->forest, .sequence = ++l->sequence, .time_us = at_us};
    motion.as.motion.head = predicted_head(time_us, at_us);
    motion.as.motion.body.orientation[3] = 1;
    query.as.query = (struct proto_query){.forest = l->forest, .time_us = at_us, .kind = LOOP_NODES};
    l->asked_us = at_us;
    if (l->asking >= LOOP_ASKING) { /* the poses are worth sending all the same: the hair will follow them all */
        return send(l, &motion);
    }
    l->asking++;
    l->sent[l->sequence % LOOP_SENT] = (loop_sent){at_us, time_us};
    ping.as.ping.sent_us = awtclient_now_us();
    return send(l, &motion) && send(l, &query) && (l->sequence % LOOP_STREAM_RATE != 1 || send(l, &ping));
}

static void note_frame(loop *l, const struct proto_frame *frame)
{
    const double age_us = (double)awtclock_age_us(&l->clock, frame->age_us);
    l->received++;
    l->under_way -= l->under_way > 0;
    l->bytes += (double)frame->glb.length;
    l->age_sum_us += age_us;
    l->age_greatest_us = fmax(l->age_greatest_us, age_us);
}

static bool take(loop *l, const proto_message *message)
{
    awtclient_error error = {.text = ""};
    if (message->type == PROTO_FRAME && message->request == l->subscribe_request) {
        note_frame(l, &message->as.frame);
        return awtframes_take(l->frames, &message->as.frame, &error) || failed("", &error);
    }
    l->asking -= l->asking > 0 && (message->type == PROTO_FRAME || message->type == PROTO_ERROR);
    if (message->type == PROTO_PONG) {
        const struct proto_pong *pong = &message->as.pong;
        awtclock_add(&l->clock, pong->sent_us, pong->received_us, pong->answered_us, awtlink_received_us(l->link));
    }
    if (message->type == PROTO_ERROR && message->as.error.retry != 1) {
        proto_str_copy(message->as.error.text, error.text, sizeof error.text);
        return failed("", &error);
    }
    l->busy += message->type == PROTO_ERROR;
    return true;
}

static bool listen(loop *l)
{
    static proto_message message;
    awtclient_error error;
    while (awtlink_next(l->link, &message, &error)) {
        if (!take(l, &message)) {
            return false;
        }
    }
    return error.code == 0 || failed("", &error);
}

/* How long the frame of that time needed from its request until now. */
static void note_needed(loop *l, int64_t time_us)
{
    const int64_t newest_us = awtframes_newest_us(l->frames);
    for (int i = 0; i < LOOP_SENT; i++) {
        if (l->sent[i].time_us == newest_us) {
            l->needed_us[l->needed_count++ % LOOP_SENT] = time_us - l->sent[i].sent_us;
        }
    }
}

/* What has been decoded may be built upon, and makes room on the way for more. */
static bool give_credit(loop *l)
{
    const uint32_t window = awtclock_credit(&l->clock, LOOP_STREAM_RATE, LOOP_TARGET_AGE_US);
    if (l->under_way >= window) {
        return true;
    }
    proto_message credit = {.type = PROTO_CREDIT};
    credit.as.credit = (struct proto_credit){
        .subscription = l->subscription, .frames = window - l->under_way, .have = awtframes_have(l->frames)};
    l->under_way = window;
    return send(l, &credit);
}

/* A game gives awtframes_decode to its job system, and calls awtframes_end in the tick after it is done. */
static bool decode(loop *l, int64_t time_us)
{
    awtclient_error error;
    bool any = false;
    while (awtframes_begin(l->frames)) {
        awtframes_decode(l->frames);
        if (!awtframes_end(l->frames, &error)) {
            l->undecoded++; /* the daemon's next frame is against one that was acknowledged, or whole */
            continue;
        }
        note_needed(l, time_us);
        any = true;
    }
    return !any || give_credit(l);
}

static void compare(loop *l, const awtframes_shown *shown, int64_t time_us)
{
    const proto_pose truth = true_head(time_us);
    double square = 0;
    for (int i = 0; i < 3; i++) {
        const double off = shown->head.position[i] - truth.position[i];
        square += off * off;
    }
    l->off_sum_m += sqrt(square);
    l->off_greatest_m = fmax(l->off_greatest_m, sqrt(square));
}

/* Here a game hands shown.positions to its renderer (awtwrite.h), under the head's true pose. */
static void show(loop *l, int64_t time_us)
{
    awtframes_shown shown;
    if (!awtframes_show(l->frames, time_us, &shown)) {
        return;
    }
    l->backwards += l->shown > 0 && shown.time_us < l->last_shown_us;
    l->stall = shown.way == AWTFRAMES_HELD && time_us > l->last_shown_us + LOOP_EXTRAPOLATE_US ? l->stall + 1 : 0;
    l->longest_stall = l->stall > l->longest_stall ? l->stall : l->longest_stall;
    l->last_shown_us = shown.time_us;
    l->shown++;
    compare(l, &shown, time_us);
}

static bool run(loop *l)
{
    const uint64_t ticks = (uint64_t)(l->plan->seconds * (double)l->plan->rate);
    l->began_us = awtclient_now_us();
    l->lead_us = LOOP_LEAST_LEAD_US;
    for (; l->ticks < ticks; l->ticks++) {
        const int64_t due_us = l->began_us + (int64_t)(l->ticks * 1000000 / (uint64_t)l->plan->rate);
        do { /* what is left of the tick belongs to the link */
            if (!turn(l, due_us) || !listen(l) || !decode(l, now_us(l))) {
                return false;
            }
        } while (awtclient_now_us() < due_us);
        const int64_t time_us = now_us(l);
        if (!drive(l, time_us)) {
            return false;
        }
        show(l, time_us);
    }
    return true;
}

/* ---- what is told ----------------------------------------------------------------------------------------------- */

static void write_json(const loop *l, FILE *file)
{
    uint64_t ways[3];
    jsonout j = jsonout_begin(file);
    awtframes_counts(l->frames, ways);
    jsonout_object(&j, NULL);
    jsonout_unsigned(&j, "ticks", l->ticks);
    jsonout_unsigned(&j, "shown", l->shown);
    jsonout_unsigned(&j, "between", ways[AWTFRAMES_BETWEEN]);
    jsonout_unsigned(&j, "beyond", ways[AWTFRAMES_BEYOND]);
    jsonout_unsigned(&j, "held", ways[AWTFRAMES_HELD]);
    jsonout_unsigned(&j, "longest_stall_ticks", l->longest_stall);
    jsonout_unsigned(&j, "backwards", l->backwards);
    jsonout_unsigned(&j, "frames", l->received);
    jsonout_unsigned(&j, "undecoded", l->undecoded);
    jsonout_unsigned(&j, "busy", l->busy);
    jsonout_real(&j, "bytes", l->bytes);
    jsonout_real(&j, "off_mean_m", l->shown > 0 ? l->off_sum_m / (double)l->shown : NAN);
    jsonout_real(&j, "off_greatest_m", l->off_greatest_m);
    jsonout_real(&j, "age_mean_us", l->received > 0 ? l->age_sum_us / (double)l->received : NAN);
    jsonout_real(&j, "age_greatest_us", l->age_greatest_us);
    jsonout_integer(&j, "round_us", awtclock_round_us(&l->clock));
    jsonout_integer(&j, "lead_us", l->lead_us);
    jsonout_close(&j);
    jsonout_done(&j);
}

static void write_text(const loop *l)
{
    uint64_t ways[3];
    awtframes_counts(l->frames, ways);
    printf("%" PRIu64 " ticks at %lld a second: %" PRIu64 " shown between frames, %" PRIu64 " beyond, %" PRIu64
           " held; longest stall %" PRIu64 " ticks\n",
           l->ticks, l->plan->rate, ways[AWTFRAMES_BETWEEN], ways[AWTFRAMES_BEYOND], ways[AWTFRAMES_HELD],
           l->longest_stall);
    printf("%" PRIu64 " frames, %.1f KB each; age %.1f ms, at most %.1f; round %.1f ms; asked for %.1f ms ahead\n",
           l->received, l->received > 0 ? l->bytes / 1000 / (double)l->received : 0,
           l->received > 0 ? l->age_sum_us / 1000 / (double)l->received : 0, l->age_greatest_us / 1000,
           (double)awtclock_round_us(&l->clock) / 1000, (double)l->lead_us / 1000);
    printf("the head shown was off the true one by %.2f mm, at most %.2f: the prediction's error\n",
           l->shown > 0 ? l->off_sum_m * 1000 / (double)l->shown : 0, l->off_greatest_m * 1000);
}

static bool tell(const loop *l)
{
    const char *path = l->plan->json;
    if (!path) {
        write_text(l);
        return true;
    }
    FILE *file = strcmp(path, "-") == 0 ? stdout : fopen(path, "w");
    if (!file) {
        fprintf(stderr, "engine_loop: %s cannot be written\n", path);
        return false;
    }
    write_json(l, file);
    return (file == stdout ? fflush(file) : fclose(file)) == 0;
}

int main(int argc, char **argv)
{
    loop_plan plan = {.address = "127.0.0.1:4680", .style = "long-curly", .rate = 60, .strands = 1000, .seconds = 10};
    const option options[] = {
        {"connect", OPTION_TEXT, "HOST:PORT", &plan.address, 0, 0, "where awtd is"},
        {"token-file", OPTION_TEXT, "FILE", &plan.token_file, 0, 0, "its token, where it is not found by itself"},
        {"style", OPTION_TEXT, "NAME", &plan.style, 0, 0, "of hair"},
        {"strands", OPTION_INTEGER, "N", &plan.strands, 1, 200000, "of the hair"},
        {"rate", OPTION_INTEGER, "HZ", &plan.rate, 1, 1000, "ticks of the loop a second"},
        {"seconds", OPTION_REAL, "S", &plan.seconds, 0.1, 86400, "how long"},
        {"json", OPTION_OPTIONAL_TEXT, "FILE", &plan.json, 0, 0, "what was measured, as JSON"},
    };
    const option_program program = {"engine_loop", "a game's loop with hair from awtd, measured", NULL, options,
                                    sizeof options / sizeof options[0]};
    size_t operands;
    int code;
    if (!options_begin(&program, argc - 1, argv + 1, NULL, 0, &operands, &code)) {
        return code;
    }
    static loop l;
    l.plan = &plan;
    l.frames = awtframes_create(LOOP_EXTRAPOLATE_US);
    const bool good = l.frames && open_link(&l) && make_hair(&l) && run(&l) && tell(&l);
    awtlink_close(l.link);
    awtframes_destroy(l.frames);
    return good ? 0 : 1;
}
