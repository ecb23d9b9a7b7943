/* engine_loop.c: a game's loop with hair from awtd, whole, to be copied from.
 *
 * Each tick of the loop does four things, none of which waits for the daemon: it tells the daemon where the head will
 * be (drive), takes what has come (listen), has it decoded (decode; a game gives that to its job system), and shows
 * hair of now, mixed from the frames that are there (show). What is sent is ahead of the game by `lead`: as long as a
 * frame needed lately from its request until it could be shown. Where the head will be by then is predicted from its
 * velocity (engine_head.h); the difference of what is shown from the true motion is what that costs, and is printed
 * (engine_measure.h).
 *
 * Hair is made before the game begins, and again where a restarted daemon has lost it; a lost connection comes back by
 * itself (awtsession.h), and the hair stands meanwhile.
 *
 * Simulated time is the game's own, one second a second. It stands at 0 while the game loads. */
#include "awtclock.h"
#include "awtframes.h"
#include "awtsession.h"
#include "engine_head.h"
#include "engine_measure.h"

#include "base/options.h"
#include "base/version.h"

#include <poll.h>
#include <stdio.h>
#include <time.h>

enum {
    LOOP_STREAM_RATE = 60, /* simulated steps, and frames, a second */
    LOOP_SENT = 64,        /* requests remembered */
    LOOP_NEEDED = 256,     /* and how long so many needed */
    LOOP_ASKING = 15,      /* requests under way; more would only make a late daemon later */
    LOOP_CREDIT = 2,       /* at first */
    LOOP_KIND = 2,         /* guides, with deltas: the fewest bytes; strands are made of them where they are decoded */
    LOOP_NODES = 3         /* what a request answers: the fewest bytes */
};
#define LOOP_STEP_US (1000000 / LOOP_STREAM_RATE)
#define LOOP_EXTRAPOLATE_US 20000
#define LOOP_TARGET_AGE_US 250000
#define LOOP_MARGIN_US 3000
#define LOOP_LEAST_NEEDED_US 20000
#define LOOP_PATIENCE_MS 60000
#define LOOP_LOADING_US 60000000

typedef struct loop_plan {
    const char *address, *token_file, *style, *json;
    long long rate, strands;
    double seconds;
} loop_plan;

typedef struct loop_sent {
    int64_t time_us, sent_us; /* simulated time asked for; the machine's clock then */
} loop_sent;

typedef struct loop {
    const loop_plan *plan;
    awtsession *session;
    awtframes *frames;
    awtclock clock;
    bool playing;                                     /* time goes */
    int64_t began_us;                                 /* the machine's clock when simulated time was 0 */
    uint64_t forest, subscribe_request, subscription; /* 0: not there yet */
    uint32_t under_way;                               /* credit that the daemon has */
    /* driving */
    uint32_t sequence, asking;
    int64_t next_send_us, first_us, asked_us, lead_us; /* first asked for; last asked for */
    loop_sent sent[LOOP_SENT];
    int64_t needed_us[LOOP_NEEDED]; /* from request to frame, lately */
    uint32_t needed_count;
    engine_measure measure;
} loop;

static int64_t now_us(const loop *l)
{
    return l->playing ? awtclient_now_us() - l->began_us : 0;
}

static bool failed(const char *why)
{
    fprintf(stderr, "engine_loop: %s\n", why);
    return false;
}

/* What is refused because too much waits to be sent, or nobody is there, is left out: the next motion says more. */
static bool send(loop *l, proto_message *message)
{
    awtclient_error error;
    return awtsession_queue(l->session, message, &error) || error.code == AWTCLIENT_FULL || failed(error.text);
}

/* ---- hair ----------------------------------------------------------------------------------------------------- */

static bool make_hair(loop *l)
{
    proto_message create = {.type = PROTO_CREATE};
    const int64_t time_us = now_us(l) > 0 ? now_us(l) + l->lead_us : 0;
    create.as.create.style = proto_str_of(l->plan->style);
    create.as.create.seed = 1;
    create.as.create.strands = (uint32_t)l->plan->strands;
    create.as.create.time_us = time_us;
    create.as.create.head = engine_predicted_head(now_us(l), time_us);
    create.as.create.body.orientation[3] = 1;
    l->asked_us = time_us;
    return send(l, &create);
}

/* What strands are made with; it stays the same as long as the hair. */
static bool ask_binding(loop *l)
{
    proto_message binding = {.type = PROTO_BINDING};
    binding.as.binding.forest = l->forest;
    return send(l, &binding);
}

static bool subscribe(loop *l)
{
    proto_message subscribe = {.type = PROTO_SUBSCRIBE}, ping = {.type = PROTO_PING};
    subscribe.as.subscribe =
        (struct proto_subscribe){.forest = l->forest, .kind = LOOP_KIND, .credit = LOOP_CREDIT, .deltas = 1};
    ping.as.ping.sent_us = awtclient_now_us();
    l->under_way = LOOP_CREDIT;
    const bool good = send(l, &ping) && send(l, &subscribe);
    l->subscribe_request = subscribe.request;
    return good;
}

/* The connection is there, for the first time or again. */
static bool opened(loop *l)
{
    uint32_t count;
    const awtsession_forest *forests = awtsession_forests(l->session, &count);
    l->subscription = 0;
    l->asking = 0;
    l->forest = count > 0 && forests[count - 1].open ? forests[count - 1].forest : 0;
    return l->forest != 0 ? ask_binding(l) : make_hair(l);
}

/* ---- a tick --------------------------------------------------------------------------------------------------- */

/* How far ahead to ask, so that the frame is there when its time is shown: by what the slowest of late needed, but not
 * so far that those which come quickly are too many to be kept until then. It shrinks slowly, so as not to swing. */
static void choose_lead(loop *l)
{
    int64_t most_us = LOOP_LEAST_NEEDED_US, least_us = LOOP_TARGET_AGE_US;
    for (uint32_t i = 0; i < LOOP_NEEDED && i < l->needed_count; i++) {
        most_us = l->needed_us[i] > most_us ? l->needed_us[i] : most_us;
        least_us = l->needed_us[i] < least_us ? l->needed_us[i] : least_us;
    }
    const int64_t greatest_us = least_us + (AWTFRAMES_KEPT - 2) * LOOP_STEP_US;
    most_us += LOOP_STEP_US + LOOP_MARGIN_US;
    most_us = most_us < greatest_us ? most_us : greatest_us;
    most_us = most_us < LOOP_TARGET_AGE_US ? most_us : LOOP_TARGET_AGE_US;
    l->lead_us = most_us > l->lead_us ? most_us : l->lead_us - (l->lead_us - most_us) / 64;
}

/* Sends where the head will be at `at_us`, and asks for the hair of then. */
static bool ask_for(loop *l, int64_t time_us, int64_t at_us)
{
    proto_message motion = {.type = PROTO_MOTION}, query = {.type = PROTO_QUERY}, ping = {.type = PROTO_PING};
    motion.as.motion = (struct proto_motion){.forest = l->forest, .sequence = ++l->sequence, .time_us = at_us};
    motion.as.motion.head = engine_predicted_head(time_us, at_us);
    motion.as.motion.body.orientation[3] = 1;
    query.as.query = (struct proto_query){.forest = l->forest, .time_us = at_us, .kind = LOOP_NODES};
    l->asked_us = at_us;
    l->first_us = l->first_us != 0 ? l->first_us : at_us;
    if (l->asking >= LOOP_ASKING) { /* the poses are worth sending all the same: the hair will follow them all */
        return send(l, &motion);
    }
    l->asking++;
    l->sent[l->sequence % LOOP_SENT] = (loop_sent){at_us, awtclient_now_us()};
    ping.as.ping.sent_us = awtclient_now_us();
    return send(l, &motion) && send(l, &query) && (l->sequence % LOOP_STREAM_RATE != 0 || send(l, &ping));
}

static bool drive(loop *l, int64_t time_us)
{
    if (time_us < l->next_send_us || l->subscription == 0) {
        return true;
    }
    do { /* steps that a late tick has missed are left out */
        l->next_send_us += LOOP_STEP_US;
    } while (l->next_send_us <= time_us);
    choose_lead(l);
    const int64_t at_us = time_us + l->lead_us;
    return at_us <= l->asked_us || ask_for(l, time_us, at_us);
}

static bool take(loop *l, const proto_message *message)
{
    awtclient_error error = {.text = ""};
    if (message->type == PROTO_FRAME && message->request == l->subscribe_request) {
        engine_measure_frame(&l->measure, &message->as.frame, &l->clock);
        l->under_way -= l->under_way > 0;
        return awtframes_take(l->frames, &message->as.frame, &error) || failed(error.text);
    }
    l->asking -= l->asking > 0 && (message->type == PROTO_FRAME || message->type == PROTO_ERROR);
    switch (message->type) {
    case PROTO_CREATE_REPLY:
        l->forest = message->as.create_reply.forest;
        return ask_binding(l);
    case PROTO_BINDING_REPLY:
        return (awtframes_bind(l->frames, message->as.binding_reply.binding.bytes,
                               message->as.binding_reply.binding.length, &error) ||
                failed(error.text)) &&
               subscribe(l);
    case PROTO_SUBSCRIBE_REPLY:
        l->subscription = message->as.subscribe_reply.subscription;
        return true;
    case PROTO_PONG:
        awtclock_add(&l->clock, message->as.pong.sent_us, message->as.pong.received_us, message->as.pong.answered_us,
                     awtlink_received_us(awtsession_link(l->session)));
        return true;
    case PROTO_ERROR:
        proto_str_copy(message->as.error.text, error.text, sizeof error.text);
        l->measure.busy++;
        return message->as.error.retry == 1 || failed(error.text);
    default:
        return true;
    }
}

static bool listen(loop *l)
{
    static proto_message message;
    awtclient_error error;
    for (;;) {
        switch (awtsession_next(l->session, &message, &error)) {
        case AWTSESSION_NOTHING:
            return true;
        case AWTSESSION_LOST:
            l->measure.losses++;
            l->subscription = 0;
            fprintf(stderr, "engine_loop: %s; trying again\n", error.text);
            break;
        case AWTSESSION_OPENED:
            if (!opened(l)) {
                return false;
            }
            break;
        case AWTSESSION_MESSAGE:
            if (!take(l, &message)) {
                return false;
            }
        }
    }
}

/* How long the newest frame needed from its request until now. */
static void note_needed(loop *l)
{
    const int64_t newest_us = awtframes_newest_us(l->frames);
    for (int i = 0; i < LOOP_SENT; i++) {
        if (l->sent[i].time_us == newest_us) {
            l->needed_us[l->needed_count++ % LOOP_NEEDED] = awtclient_now_us() - l->sent[i].sent_us;
        }
    }
}

/* What has been decoded may be built upon, and makes room on the way for more. */
static bool give_credit(loop *l)
{
    const uint32_t window = awtclock_credit(&l->clock, LOOP_STREAM_RATE, LOOP_TARGET_AGE_US);
    if (l->under_way >= window || l->subscription == 0) {
        return true;
    }
    proto_message credit = {.type = PROTO_CREDIT};
    credit.as.credit = (struct proto_credit){
        .subscription = l->subscription, .frames = window - l->under_way, .have = awtframes_have(l->frames)};
    l->under_way = window;
    return send(l, &credit);
}

/* A game gives awtframes_decode to its job system, and calls awtframes_end in the tick after it is done. */
static bool decode(loop *l)
{
    awtclient_error error;
    bool any = false;
    while (awtframes_begin(l->frames)) {
        awtframes_decode(l->frames);
        if (!awtframes_end(l->frames, &error)) {
            l->measure.undecoded++; /* the daemon's next frame is against one that was acknowledged, or whole */
            continue;
        }
        note_needed(l);
        any = true;
    }
    return !any || give_credit(l);
}

/* Here a game hands shown.positions to its renderer (awtwrite.h), under the head's true pose. */
static void show(loop *l, int64_t time_us)
{
    awtframes_shown shown;
    const proto_pose truth = engine_true_head(time_us);
    if (awtframes_show(l->frames, time_us, &shown)) {
        engine_measure_shown(&l->measure, &shown, time_us, &truth);
    }
}

/* ---- the loop ------------------------------------------------------------------------------------------------- */

/* Waits for the daemon, but not beyond `until_us` of the machine's clock, and takes what came. poll knows whole
 * milliseconds only: the last of them is slept without it. */
static bool wait_for(loop *l, int64_t until_us)
{
    awtclient_error error;
    const int64_t due_us = awtsession_deadline_us(l->session), end_us = until_us < due_us ? until_us : due_us;
    const int64_t left_us = awtsession_pending(l->session) ? 0 : end_us - awtclient_now_us();
    const unsigned wanted = awtsession_wanted(l->session);
    struct pollfd entry = {.fd = awtsession_descriptor(l->session)};
    entry.events = (short)((wanted & AWTLINK_READ ? POLLIN : 0) | (wanted & AWTLINK_WRITE ? POLLOUT : 0));
    if (poll(&entry, 1, left_us > 0 ? (int)(left_us / 1000) : 0) == 0 && left_us > 0 && left_us < 1000) {
        nanosleep(&(struct timespec){.tv_nsec = (long)left_us * 1000}, NULL);
    }
    return (awtsession_pump(l->session, awtclient_now_us(), &error) || failed(error.text)) && listen(l) && decode(l);
}

/* A tick, due at a time of the machine's clock: until then what is left belongs to the daemon. */
static bool tick(loop *l, int64_t due_us)
{
    do {
        if (!wait_for(l, due_us)) {
            return false;
        }
    } while (awtclient_now_us() < due_us);
    return drive(l, now_us(l));
}

static int64_t due_us(const loop *l, uint64_t number)
{
    return l->began_us + (int64_t)(number * 1000000 / (uint64_t)l->plan->rate);
}

/* The loading screen: until there is hair, and until its frames have come up with the game's time. The number of the
 * tick that is the first to be shown; 0: it failed. */
static uint64_t load(loop *l)
{
    const int64_t until_us = awtclient_now_us() + LOOP_LOADING_US;
    while ((l->subscription == 0 || l->clock.count == 0) && awtclient_now_us() < until_us) {
        if (!wait_for(l, until_us)) {
            return 0;
        }
    }
    l->began_us = awtclient_now_us();
    l->playing = true;
    l->lead_us = LOOP_LEAST_NEEDED_US + 2 * awtclock_round_us(&l->clock);
    for (uint64_t number = 1; awtclient_now_us() < until_us; number++) {
        if (!tick(l, due_us(l, number))) {
            return 0;
        }
        const int64_t newest_us = awtframes_newest_us(l->frames);
        if (l->first_us != 0 && now_us(l) >= l->first_us && newest_us >= now_us(l)) {
            return number + 1;
        }
    }
    failed("no hair within a minute");
    return 0;
}

static bool play(loop *l)
{
    const uint64_t first = load(l);
    const uint64_t last = first + (uint64_t)(l->plan->seconds * (double)l->plan->rate);
    l->measure.tick_us = 1000000 / l->plan->rate;
    for (uint64_t number = first; first != 0 && number < last; number++) {
        if (!tick(l, due_us(l, number))) {
            return false;
        }
        engine_measure_tick(&l->measure, due_us(l, number), awtclient_now_us());
        show(l, now_us(l));
    }
    l->measure.lead_us = l->lead_us;
    return first != 0;
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
    const awtsession_options where = {
        .link = {.address = plan.address, .token_file = plan.token_file, .name = "engine_loop " AWTD_VERSION},
        .patience_ms = LOOP_PATIENCE_MS};
    awtclient_error error = {.text = "not enough memory"};
    l.plan = &plan;
    l.frames = awtframes_create(LOOP_EXTRAPOLATE_US);
    l.session = l.frames ? awtsession_open(&where, awtclient_now_us(), &error) : NULL;
    const bool good =
        (l.session || failed(error.text)) && play(&l) && engine_measure_tell(&l.measure, l.frames, &l.clock, plan.json);
    awtsession_close(l.session);
    awtframes_destroy(l.frames);
    return good ? 0 : 1;
}
